#include <softkin/core/text.hpp>
#include <softkin/statics/electric_layer.hpp>
#include <softkin/statics/physical/pull_in.hpp>

namespace softkin::physical {

namespace {

/// Are voltages all that changes? Else another load may have reached its limit.
bool voltages_alone_change(const Model& model, const LoadState& from, const LoadState& here) {
  for (Index a = 0; a < std::ssize(model.actuators); ++a)
    if (from.actuation[a] != here.actuation[a] && !under_voltage(model.actuators[a])) return false;
  return true;
}

}  // namespace

std::string pull_in_text(const Model& model, const LoadState& from, const LoadState& here, const Points& positions) {
  const std::string has = voltages_alone_change(model, from, here) ? "has" : "may have";
  std::string text;
  for (Index a = 0; a < std::ssize(model.actuators); ++a) {
    const double voltage = here.actuation[a];
    if (!under_voltage(model.actuators[a]) || !(voltage > from.actuation[a])) continue;
    const ElectricLayer layer = electric_layer(model, a, positions, voltage);
    text += "; the voltage of dea '" + model.actuators[a].name + "' " + has + " its maximum there, " +
            number(voltage, 4) + " kV: beyond it the layer pulls in, and it is thinnest, " +
            number(layer.thickness_mm, 3) + " mm, at (" + number(layer.at[0], 4) + ", " + number(layer.at[1], 4) +
            ", " + number(layer.at[2], 4) + ") mm, where the field is " + number(layer.field_kV_mm, 3) + " kV/mm";
  }
  return text;
}

}  // namespace softkin::physical
