#pragma once

#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/runs/records.hpp>
#include <softkin/runs/shortfall_text.hpp>
#include <softkin/runs/turns.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// "gait.csv by finger.yaml: physical", with the names of the files alone. by: the file of commands; empty: left out
[[nodiscard]] std::string plot_title(const Model& model, const std::string& scene, const std::string& by = "");

/// Commands, markers and their turns, the responses of the actuators (pressures, tensions; volume, length and area
/// where the load is commanded), contact forces on bodies, and the marker trajectories in space. Steps without finite
/// numbers are left out; those that did not converge are marked. line: whose turn is drawn, too
[[nodiscard]] Plot plot_of_steps(const Model& model, const std::vector<StepRecord>& steps, const std::string& title,
                                 const std::optional<MarkerLine>& line = {});

/// Targets and reached points in space, the error and the commands along the path (Fig. 13 and 14 of Fang et al. 2020).
/// With the measures of actuators that are commanded by loads, and the turn of the line, where there are any.
/// done: at least one.
[[nodiscard]] Plot plot_of_path(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done,
                                double tolerance_mm, const std::string& title,
                                const std::optional<MarkerLine>& line = {});

/// The error of each equilibrium that a search solved for, at least one, and the least so far. scene: its file
/// misses: of the answer
[[nodiscard]] Plot plot_of_search(const InverseResult& found, double tolerance_mm, const std::string& scene,
                                  const Misses& misses);

/// Places of the feet, commands and friction over the steps of a walk.
[[nodiscard]] Plot plot_of_walk(const Model& model, const std::vector<WalkRecord>& steps, const std::string& title);

}  // namespace softkin::runs
