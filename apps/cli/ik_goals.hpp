#pragma once

#include <softkin/runs/reports.hpp>
#include <string>
#include <vector>

#include "ik_options.hpp"

namespace softkin::cli {

/// Throws InvalidInput naming the option: unknown markers, numbers that are none or not finite, a weight for nothing.
[[nodiscard]] std::vector<runs::NamedGoal> asked_goals(const Model& model, const IkOptions& options);

/// What looks wrong about the points beside this robot, a sentence each: 100 times its size away, or near it if they
/// were in metres.
[[nodiscard]] std::vector<std::string> doubts_about(const Model& model, const std::vector<runs::NamedGoal>& goals);

}  // namespace softkin::cli
