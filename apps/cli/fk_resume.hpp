#pragma once

#include <cstddef>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

#include "fk_options.hpp"
#include "fk_report.hpp"
#include "fk_steps.hpp"

namespace softkin::cli {

/// What an interrupted run has left.
struct Finished {
  std::size_t steps = 0;  // added to the report
  State state;            // of the last of them
  std::string remark;     // for the user
};

/// Keys by which a step of the report tells which shape it left.
void add_shape(Report::Json& step, const std::string& file, const Points& positions);

/// Adds to report, which has no steps yet, those of the report on disk whose shapes are there as they were written.
///
/// throws  InvalidInput where the report on disk is of another robot, solver or path
[[nodiscard]] Finished take_finished(const Model& model, const FkOptions& options, const std::vector<Step>& steps,
                                     Report& report);

}  // namespace softkin::cli
