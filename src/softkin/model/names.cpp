#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>

namespace softkin {

const char* kind_name(const Actuator& actuator) {
  switch (actuator.kind) {
    case ActuatorKind::cable:
      return "cable";
    case ActuatorKind::dea:
      return "dea";
    case ActuatorKind::pneumatic:
      break;
  }
  return "pneumatic";
}

const char* control_name(const Actuator& actuator) {
  const bool load = actuator.control == Control::load;
  switch (actuator.kind) {
    case ActuatorKind::cable:
      return load ? "tension" : "length";
    case ActuatorKind::dea:
      return "area";
    case ActuatorKind::pneumatic:
      break;
  }
  return load ? "pressure" : "volume";
}

const char* command_name(const Actuator& actuator) {
  return actuator.control == Control::ratio ? "ratio" : control_name(actuator);
}

std::string command_unit(const Actuator& actuator) {
  if (actuator.control == Control::ratio) return "";
  return actuator.kind == ActuatorKind::cable ? "N" : "kPa";
}

std::string bracketed_unit(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return unit.empty() ? "[-]" : "[" + unit + "]";
}

std::string command_column(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return unit.empty() ? actuator.name : actuator.name + "_" + unit;
}

std::string multiplier_key(const Actuator& actuator) {
  if (actuator.kind == ActuatorKind::dea) return "";
  return actuator.kind == ActuatorKind::cable ? "tension_N" : "pressure_kPa";
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
  switch (law) {
    case Law::st_venant_kirchhoff:
      return "st-venant-kirchhoff";
    case Law::corotational:
      return "corotational";
    case Law::neo_hookean:
      return "neo-hookean";
    case Law::mooney_rivlin:
      return "mooney-rivlin";
    case Law::yeoh:
      break;
  }
  return "yeoh";
}

const char* formulation_name(Formulation formulation) {
  return formulation == Formulation::physical ? "physical" : "target-shape";
}

const char* name_of(Status status) {
  switch (status) {
    case Status::converged:
      return "converged";
    case Status::interrupted:
      return "interrupted";
    case Status::limit:
      return "limit";
    case Status::not_converged:
      break;
  }
  return "not converged";
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
