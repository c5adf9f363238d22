#include <softkin/core/text.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/names.hpp>

namespace softkin {

namespace {

struct Quantity {
  const char *name, *unit, *column;
};

/// What a command of a magnetic field is.
Quantity field_quantity(const MagneticDrive& field) {
  const FieldCommand command = field.command;
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
  return traits(actuator.drive).kind;
}

const char* measure_name(const Actuator& actuator) {
  return traits(actuator.drive).measure;
}

bool has_measure(const Actuator& actuator) {
  return *measure_name(actuator) != '\0';
}

bool answers_with_measure(const Actuator& actuator) {
  return has_measure(actuator) && actuator.control != Control::ratio;
}

bool answers_with_load(const Actuator& actuator) {
  return actuator.control != Control::load && !multiplier_key(actuator).empty();
}

bool shows_measure(const Actuator& actuator) {
  return answers_with_measure(actuator) && actuator.control == Control::load && !actuator.is<CableDrive>();
}

const char* control_name(const Actuator& actuator) {
  if (!drives(actuator)) return kind_name(actuator);
  if (const auto* field = actuator.as<MagneticDrive>()) return field_quantity(*field).name;
  if (actuator.control == Control::load) return traits(actuator.drive).load;
  if (const Filling* filling = filling_of(actuator)) return filling_quantity(*filling);
  return actuator.is<GrowthDrive>() ? "stretch" : measure_name(actuator);
}

const char* command_name(const Actuator& actuator) {
  return actuator.control == Control::ratio ? "ratio" : control_name(actuator);
}

std::string command_unit(const Actuator& actuator) {
  if (actuator.control == Control::ratio) return "";
  if (actuator.control == Control::filling) return "mL";
  if (const auto* field = actuator.as<MagneticDrive>()) return field_quantity(*field).unit;
  return traits(actuator.drive).unit;
}

std::string bracketed_unit(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return unit.empty() ? "[-]" : "[" + unit + "]";
}

std::string command_column(const Actuator& actuator) {
  const auto* field = actuator.as<MagneticDrive>();
  const std::string unit = field                          ? field_quantity(*field).column
                           : actuator.is<MomentCommand>() ? "Nmm"
                                                          : command_unit(actuator);
  return unit.empty() ? actuator.name : actuator.name + "_" + unit;
}

std::string multiplier_key(const Actuator& actuator) {
  const DriveTraits& of = traits(actuator.drive);
  if (!has_measure(actuator) || (actuator.is<DeaDrive>() && !under_voltage(actuator))) return "";
  return std::string(of.load) + "_" + of.unit;
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
  return law_traits(law).name;
}

std::string laws_with_bulk_part(const std::string& quote) {
  std::vector<std::string> names;
  for (const Law law : all_laws)
    if (has_bulk_part(law)) names.push_back(quote + law_name(law) + quote);
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i];
  return text;
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
  return model.markers[model.feet[foot].marker].name;
}

std::optional<Index> find_actuator(const Model& model, const std::string& name) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (model.actuators[a].name == name) return static_cast<Index>(a);
  return std::nullopt;
}

}  // namespace softkin
