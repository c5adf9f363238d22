#pragma once

#include <softkin/model/model.hpp>
#include <softkin/runs/records.hpp>
#include <string>

namespace softkin::cli {

using runs::ActuatorRecord;
using runs::StepRecord;

/// "1,851 vertices, 5,556 tetrahedra of order 1; physical formulation (neo-hookean), solver newton", the actuators and
/// the model's notes, a line each.
[[nodiscard]] std::string summary(const Model& model, const std::string& solver);

/// Strains, slack cables and what a step may hide, a line each.
[[nodiscard]] std::string findings_text(const Model& model, const StepRecord& step);

/// Why a step did not converge and what its shape is: "air reached 1.62 of 1.8: beyond this point no equilibrium
/// follows; the shape is the last good one".
[[nodiscard]] std::string shortfall_text(const Model& model, const StepRecord& step);

}  // namespace softkin::cli
