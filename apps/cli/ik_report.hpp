#pragma once

#include <softkin/kinematics/inverse.hpp>
#include <string>
#include <vector>

#include "fk_report.hpp"
#include "ik_goals.hpp"

namespace softkin::cli {

/// "reached", "not reached", "not converged" or "interrupted".
[[nodiscard]] const char* name_of(InverseStatus status);

/// What was asked and what came of it: the report's entry "ik".
[[nodiscard]] Report::Json ik_json(const Model& model, const IkOptions& options, const std::vector<AskedGoal>& goals,
                                   const InverseResult& found);

/// Where the marker of a goal, or the unit vector between its markers, is [mm, -].
[[nodiscard]] Vec3 place_of(const Model& model, const Goal& goal, const Points& positions);

}  // namespace softkin::cli
