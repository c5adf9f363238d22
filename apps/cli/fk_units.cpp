#include "fk_units.hpp"

#include <softkin/io/scanner.hpp>
#include <softkin/statics/statics.hpp>

#include "curve_settings.hpp"
#include "terminal.hpp"

namespace softkin::cli {

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
  const std::string unit = unit_of_command(actuator);
  return unit.empty() ? unit : unit.substr(1);
}

std::string bracketed_unit(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return unit.empty() ? "[-]" : "[" + unit + "]";
}

std::string multiplier_key(const Actuator& actuator) {
  if (actuator.kind == ActuatorKind::dea) return "";
  return actuator.kind == ActuatorKind::cable ? "tension_N" : "pressure_kPa";
}

std::string command_text(const Actuator& actuator, double value, int digits) {
  return number(value, digits) + unit_of_command(actuator);
}

std::string range_text(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return "its range, " + number(actuator.low) + " to " + number(actuator.high) + " " + (unit.empty() ? "[-]" : unit);
}

bool parse_command(const Actuator& actuator, const std::string& text, double& value) {
  if (const auto setting = parse_curve_setting(actuator, text)) {
    value = ratio_of(actuator, *setting);
    return true;
  }
  const std::string unit = command_unit(actuator);
  std::string digits = text;
  if (!unit.empty() && text.ends_with(unit)) {
    digits.resize(text.size() - unit.size());
    if (digits.ends_with(' ')) digits.pop_back();
  }
  return parse_real(digits, value);
}

std::string expected_command(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  if (unit.empty()) return "the ratio to rest must be a finite number without unit" + curve_hint(actuator);
  return std::string("the ") + command_name(actuator) + " must be a finite number in " + unit + ", such as 5 or 5" +
         unit;
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

}  // namespace softkin::cli
