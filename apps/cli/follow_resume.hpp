#pragma once

#include <softkin/model/equilibrium.hpp>
#include <string>
#include <vector>

#include "follow_options.hpp"
#include "follow_waypoint.hpp"

namespace softkin::cli {

/// What an interrupted run has left.
struct FollowedBefore {
  std::vector<DoneWaypoint> done;  // their steps are added to the report
  State state;                     // of the last of them
  std::string remark;              // for the user
};

/// What changes the waypoints' results beside robot and solver.
[[nodiscard]] Report::Json follow_json(const FollowOptions& options);

/// Adds to report, which has no steps yet, those of the report on disk, as far as the shapes are there as written.
///
/// throws  InvalidInput where the report on disk is of another robot, solver, tolerance or path
[[nodiscard]] FollowedBefore take_waypoints(const Model& model, const FollowOptions& options, const MarkerPath& path,
                                            Report& report);

}  // namespace softkin::cli
