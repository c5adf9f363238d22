#pragma once

#include <softkin/kinematics/map.hpp>
#include <softkin/runs/estimate_report.hpp>

namespace softkin::runs {

/// Estimates from every row by a kinematic map in place of the robot: microseconds each, each row by itself.
///
/// requested  as estimate_poses() has it
/// throws  InvalidInput: what estimate_poses() throws; unknowns that are no inputs of the map, or whose place is not
///         known; readings that are no outputs of it
[[nodiscard]] EstimateReport estimate_poses_by_map(const KinematicMap& map, const RequestedEstimates& requested,
                                                   const EstimateCallback& row);

}  // namespace softkin::runs
