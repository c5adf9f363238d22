#pragma once

#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/runs/records.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// Commands, markers, pressures and tensions of a path, and the markers' ways through space. Steps whose numbers are
/// not known are left out; those that did not converge are marked.
[[nodiscard]] Plot plot_of_steps(const Model& model, const std::vector<StepRecord>& steps, const std::string& title);

/// Targets and reached points in space, the error and the commands along the path (Fig. 13 and 14 of Fang et al. 2020).
/// done: at least one.
[[nodiscard]] Plot plot_of_path(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done,
                                double tolerance_mm, const std::string& title);

/// Places of the feet, commands and friction over the steps of a walk.
[[nodiscard]] Plot plot_of_walk(const Model& model, const std::vector<WalkRecord>& steps, const std::string& title);

}  // namespace softkin::runs
