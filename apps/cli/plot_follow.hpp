#pragma once

#include <softkin/io/svg_plot.hpp>
#include <string>
#include <vector>

#include "follow_waypoint.hpp"

namespace softkin::cli {

/// Targets and reached points in space, the error and the commands along the path (Fig. 13 and 14 of Fang et al. 2020).
/// done: at least one.
[[nodiscard]] Plot plot_of_path(const Model& model, const MarkerPath& path, const std::vector<DoneWaypoint>& done,
                                double tolerance_mm, const std::string& title);

}  // namespace softkin::cli
