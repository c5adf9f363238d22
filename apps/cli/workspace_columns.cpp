#include "workspace_columns.hpp"

#include <softkin/model/fingerprint.hpp>
#include <softkin/model/names.hpp>
#include "terminal.hpp"

namespace softkin::cli {

WorkspaceColumns workspace_columns(const Model& model) {
  WorkspaceColumns columns;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const std::string unit = command_unit(actuator), load = multiplier_key(actuator);
    columns.actuators.push_back(unit.empty() ? actuator.name : actuator.name + "_" + unit);
    if (model.formulation != Formulation::physical || load.empty()) continue;
    columns.loads.push_back(actuator.name + "_" + load);
    columns.loaded.push_back(static_cast<Index>(a));
  }
  for (const Marker& marker : model.markers)
    for (const char* axis : {"_x_mm", "_y_mm", "_z_mm"}) columns.markers.push_back(marker.name + axis);
  return columns;
}

std::string sampling_text(const Model& model, const SamplingOptions& sampling) {
  if (sampling.kind == Sampling::sobol) return "sobol";
  if (sampling.kind == Sampling::random) return "random, seed " + std::to_string(sampling.seed);
  std::string text;
  for (const Actuator& actuator : model.actuators)
    text += (text.empty() ? "grid of " : " x ") +
            std::to_string(actuator.low < actuator.high ? nearest_grid(model, sampling.samples) : 1);
  return text;
}

WorkspaceHead workspace_head(const Model& model, const SamplingOptions& sampling, const std::string& solver) {
  std::string ranges;
  for (const Actuator& actuator : model.actuators)
    ranges += (ranges.empty() ? "" : ", ") + actuator.name + " " + number(actuator.low, 17) + " to " +
              command_text(actuator, actuator.high, 17);
  return {{"softkin workspace", "format 1"},
          {"softkin", SOFTKIN_VERSION},
          {"robot", fingerprint_of(model)},
          {"solver", solver},
          {"ranges", ranges},
          {"sampling", sampling_text(model, sampling)},
          {"samples", std::to_string(sampling.samples)}};
}

}  // namespace softkin::cli
