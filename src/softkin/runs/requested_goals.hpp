#pragma once

#include <softkin/runs/reports.hpp>

namespace softkin::runs {

/// Goals of inverse kinematics as a user writes them.
struct GoalTexts {
  std::vector<std::string> targets;         // MARKER=X,Y,Z
  std::vector<std::string> planes;          // MARKER=PX,PY,PZ/NX,NY,NZ
  std::vector<std::string> directions;      // FROM:TO=X,Y,Z
  std::vector<std::string> presses;         // NAME=FX,FY,FZ
  std::vector<std::string> weights;         // GOAL=W
  std::optional<double> lever_mm;           // none: the distance of a direction's markers at rest
  double tolerance_mm = 1e-3;               // of places
  std::optional<double> tolerance_force_N;  // none: a thousandth of each force
  std::string before_name;  // "--" where these are options: stands before their names in what is refused

  /// Is any goal requested?
  [[nodiscard]] bool any() const {
    return !targets.empty() || !planes.empty() || !directions.empty() || !presses.empty();
  }
};

/// The goals, targets first, then planes, directions and forces.
///
/// throws  InvalidInput naming which of them: unknown markers or obstacles, numbers that are none or not finite,
///         a weight for nothing
[[nodiscard]] std::vector<NamedGoal> requested_goals(const Model& model, const GoalTexts& texts);

}  // namespace softkin::runs
