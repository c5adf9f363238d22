#pragma once

#include <softkin/kinematics/inverse.hpp>
#include <softkin/runs/records.hpp>
#include <string>

namespace softkin::runs {

/// How far a step that did not converge came: "air reached 1.62 of 1.8, tendon reached 2 N of 3 N".
[[nodiscard]] std::string reached_text(const Model& model, const StepRecord& step);

/// How far an answer is from its goals: the largest errors of places and directions [mm] and of forces [N].
struct Misses {
  std::optional<double> mm, N;  // none: no such goal
};

/// An error as a search has it, in the goal's own unit: of a force [N], else [mm].
[[nodiscard]] double own_error(const Goal& goal, double error_mm);

/// found: has errors, one for each goal
[[nodiscard]] Misses misses_of(const std::vector<Goal>& goals, const InverseResult& found);

/// "4.2 mm", "0.3 N", "4.2 mm and 0.3 N".
[[nodiscard]] std::string misses_text(const Misses& misses, int digits);

/// Why goals are not reached: "not reached: 4.2 mm off at the nearest point; no change ...; tendon1 is at the low end
/// of its range, 0.5 [-]". found: has errors
[[nodiscard]] std::string shortfall_text(const Model& model, const std::vector<Goal>& goals,
                                         const InverseResult& found);

/// Why a step did not converge and what its shape is: "air reached 1.62 of 1.8: beyond this point no equilibrium
/// follows; the shape is the last good one".
[[nodiscard]] std::string shortfall_text(const Model& model, const StepRecord& step);

}  // namespace softkin::runs
