#pragma once

#include <softkin/kinematics/map.hpp>
#include <softkin/runs/estimate_report.hpp>

namespace softkin::runs {

/// Tells of every row by a kinematic map in the place of the robot: microseconds each, each row by itself.
///
/// asked   as estimate_poses() has it
/// throws  InvalidInput: what estimate_poses() throws; unknowns that are no inputs of the map, or whose place is not
///         known; readings that are no outputs of it
[[nodiscard]] EstimateReport estimate_poses_by_map(const KinematicMap& map, const AskedEstimates& asked,
                                                   const EstimateCallback& row);

}  // namespace softkin::runs
