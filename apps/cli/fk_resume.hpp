#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
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

/// What the step after that one starts from, as if it had just been solved; nothing where its shape is not there as it
/// was written. Throws Json::exception on a step that is not one of a report.
[[nodiscard]] std::optional<State> stored_state(const Model& model, const Report::Json& step,
                                                const std::filesystem::path& shape);

/// Adds to report, which has no steps yet, those of the report on disk whose shapes are there as they were written.
///
/// throws  InvalidInput where the report on disk is of another robot, solver or path
[[nodiscard]] Finished take_finished(const Model& model, const FkOptions& options, const std::vector<Step>& steps,
                                     Report& report);

}  // namespace softkin::cli
