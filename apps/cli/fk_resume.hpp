#pragma once

#include <softkin/model/model.hpp>
#include <vector>

#include "fk_options.hpp"
#include "fk_steps.hpp"
#include "stored_report.hpp"

namespace softkin::cli {

/// Adds to report, which has no steps yet, those of the report on disk whose shapes are there as they were written.
///
/// throws  InvalidInput where the report on disk is of another robot, solver or path
[[nodiscard]] Finished take_finished(const Model& model, const FkOptions& options, const std::vector<Step>& steps,
                                     Report& report);

}  // namespace softkin::cli
