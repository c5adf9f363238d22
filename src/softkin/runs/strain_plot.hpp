#pragma once

#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/runs/records.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// The commands of a step: "air = 1.4 [-], tendon = 3 N"; of each actuator, with so many digits.
[[nodiscard]] std::string commands_title(const Model& model, const Actuation& actuation, int digits = 4);

/// How much of the body is strained how far (Fig. 6 of Fang et al. 2020): a histogram a step, of at most twelve spread
/// over the path, the last among them, with the linear ranges of the materials. Axes are alike in all panels. Steps
/// whose strains are not known are left out, and those at rest where others are not. steps: at least one
[[nodiscard]] Plot plot_of_strains(const Model& model, const std::vector<StepRecord>& steps, const std::string& title);

}  // namespace softkin::runs
