#include <softkin/core/text.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/names.hpp>

namespace softkin {

namespace {

struct Quantity {
  const char *name, *unit, *column;
};

/// What a command of a magnetic field is.
Quantity field_quantity(const Actuator& actuator) {
  const auto command = static_cast<FieldCommand>(actuator.axis);
  if (command == FieldCommand::current) return {"current", "A", "A"};
  if (places_dipole(command)) return {"position", "mm", "mm"};
  if (command >= FieldCommand::moment_x) return {"moment", "A m^2", "Am2"};
  return {"flux density", "mT", "mT"};
}

const char* filling_quantity(const Filling& filling) {
  return filling.pushed ? "pushed volume" : filling.liquid ? "amount of liquid" : "amount of gas";
}

}  // namespace

const char* kind_name(const Actuator& actuator) {
  constexpr const char* names[] = {
      "cable", "dea",  "pneumatic", "magnetic", "growth",  "motion",
      "force", "hold", "turn",      "moment",   "pressure"};  // in the order of ActuatorKind
  return names[static_cast<std::size_t>(actuator.kind)];
}

bool has_measure(const Actuator& actuator) {
  return actuator.kind == ActuatorKind::cable || actuator.kind == ActuatorKind::dea ||
         actuator.kind == ActuatorKind::pneumatic;
}

const char* measure_name(const Actuator& actuator) {
  constexpr const char* measures[] = {"length", "area", "volume"};  // in the order of ActuatorKind
  return has_measure(actuator) ? measures[static_cast<std::size_t>(actuator.kind)] : "";
}

bool answers_with_measure(const Actuator& actuator) {
  return has_measure(actuator) && actuator.control != Control::ratio;
}

bool answers_with_load(const Actuator& actuator) {
  return actuator.control != Control::load && !multiplier_key(actuator).empty();
}

bool shows_measure(const Actuator& actuator) {
  return answers_with_measure(actuator) && actuator.control == Control::load && actuator.kind != ActuatorKind::cable;
}

const char* control_name(const Actuator& actuator) {
  if (!drives(actuator)) return kind_name(actuator);
  if (actuator.kind == ActuatorKind::magnetic) return field_quantity(actuator).name;
  if (actuator.kind == ActuatorKind::growth) return actuator.control == Control::load ? "temperature" : "stretch";
  if (actuator.control == Control::ratio) return measure_name(actuator);
  if (actuator.filling) return filling_quantity(*actuator.filling);
  constexpr const char* loads[] = {"tension", "voltage", "pressure"};  // the same
  return loads[static_cast<std::size_t>(actuator.kind)];
}

const char* command_name(const Actuator& actuator) {
  return actuator.control == Control::ratio ? "ratio" : control_name(actuator);
}

std::string command_unit(const Actuator& actuator) {
  if (actuator.control == Control::ratio) return "";
  if (actuator.control == Control::filling) return "mL";
  if (actuator.kind == ActuatorKind::motion) return "mm";
  if (actuator.kind == ActuatorKind::turn) return "deg";
  if (actuator.kind == ActuatorKind::growth) return "degC";
  if (actuator.kind == ActuatorKind::dea) return "kV";
  if (actuator.kind == ActuatorKind::magnetic) return field_quantity(actuator).unit;
  if (actuator.kind == ActuatorKind::moment) return "N mm";
  return actuator.kind == ActuatorKind::pneumatic || actuator.kind == ActuatorKind::pressure ? "kPa" : "N";
}

std::string bracketed_unit(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return unit.empty() ? "[-]" : "[" + unit + "]";
}

std::string command_column(const Actuator& actuator) {
  const std::string unit = actuator.kind == ActuatorKind::magnetic ? field_quantity(actuator).column
                           : actuator.kind == ActuatorKind::moment ? "Nmm"
                                                                   : command_unit(actuator);
  return unit.empty() ? actuator.name : actuator.name + "_" + unit;
}

std::string multiplier_key(const Actuator& actuator) {
  if (!has_measure(actuator)) return "";
  if (actuator.kind == ActuatorKind::dea) return under_voltage(actuator) ? "voltage_kV" : "";
  return actuator.kind == ActuatorKind::cable ? "tension_N" : "pressure_kPa";
}

std::string multiplier_title(const Actuator& actuator) {
  const std::string key = multiplier_key(actuator);
  if (key.empty()) return "";
  return key.substr(0, key.rfind('_')) + " [" + multiplier_unit(actuator) + "]";
}

std::string multiplier_unit(const Actuator& actuator) {
  const std::string key = multiplier_key(actuator);
  return key.empty() ? "" : key.substr(key.rfind('_') + 1);
}

std::string command_text(const Actuator& actuator, double value, int digits) {
  const std::string unit = command_unit(actuator);
  return number(value, digits) + (unit.empty() ? "" : " " + unit);
}

std::string range_text(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return "its range, " + number(actuator.low) + " to " + number(actuator.high) + " " + (unit.empty() ? "[-]" : unit);
}

const char* law_name(Law law) {
  constexpr const char* names[] = {"st-venant-kirchhoff", "corotational", "neo-hookean",
                                   "mooney-rivlin",       "yeoh",         "gent"};
  return names[static_cast<std::size_t>(law)];
}

const char* formulation_name(Formulation formulation) {
  return formulation == Formulation::physical ? "physical" : "target-shape";
}

const char* weights_name(ElementWeights weights) {
  return weights == ElementWeights::printed ? "printed" : "mesh-independent";
}

const char* name_of(Status status) {
  constexpr const char* names[] = {"converged", "not converged", "interrupted", "limit"};
  return names[static_cast<std::size_t>(status)];
}

const char* curve_key(const ActuatorCurve& curve) {
  return curve.input == CurveInput::pressure ? "curve_pressure_kPa" : "curve_voltage_kV";
}

const std::string& foot_name(const Model& model, std::size_t foot) {
  return model.markers[static_cast<std::size_t>(model.feet[foot].marker)].name;
}

std::optional<Index> find_actuator(const Model& model, const std::string& name) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (model.actuators[a].name == name) return static_cast<Index>(a);
  return std::nullopt;
}

}  // namespace softkin
