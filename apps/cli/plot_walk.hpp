#pragma once

#include <softkin/io/svg_plot.hpp>

#include "walk_steps.hpp"

namespace softkin::cli {

/// Places of the feet, commands and friction over the steps of a walk.
[[nodiscard]] Plot plot_of_walk(const Model& model, const std::vector<WalkedStep>& steps, const std::string& title);

}  // namespace softkin::cli
