#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <softkin/io/svg_plot.hpp>
#include <softkin/model/model.hpp>
#include <string>

namespace softkin::cli {

/// Commands, markers, pressures and tensions of a path, and the markers' ways through space. Steps whose numbers are
/// not known are left out; those that did not converge are marked. steps: of step_json, some.
[[nodiscard]] Plot plot_of_steps(const Model& model, const nlohmann::ordered_json& steps, const std::string& title);

}  // namespace softkin::cli
