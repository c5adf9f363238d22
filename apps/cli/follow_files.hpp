#pragma once

#include <string>
#include <vector>

#include "follow_waypoint.hpp"

namespace softkin::cli {

/// A row per waypoint done: t_s, where the path has times, and the actuators, as fk --path reads them.
[[nodiscard]] std::string commands_csv(const Model& model, const MarkerPath& path,
                                       const std::vector<DoneWaypoint>& done);

/// A row per waypoint done: target and place of every marker [mm], error [mm], whether it was reached.
[[nodiscard]] std::string errors_csv(const Model& model, const MarkerPath& path, const std::vector<DoneWaypoint>& done);

}  // namespace softkin::cli
