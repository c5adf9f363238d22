#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/names.hpp>

namespace softkin {

namespace {

void require_positive(const ActuatorSpec& spec, double value, const char* what) {
  if (!(value > 0 && std::isfinite(value)))
    refuse(spec, std::string("needs ") + what + " above 0, not " + number(value));
}

void require_not_negative(const ActuatorSpec& spec, double value, const char* what) {
  if (!(value >= 0 && std::isfinite(value)))
    refuse(spec, std::string("needs ") + what + " of 0 or more, not " + number(value));
}

}  // namespace

void check_filling(const ActuatorSpec& spec, const std::optional<FillingSpec>& given, Formulation formulation) {
  if (formulation != Formulation::physical)
    refuse(spec, "is controlled by what fills it: that needs the physical formulation");
  if (!given) refuse(spec, "is controlled by what fills it: it needs to be a chamber with a filling");
  const FillingSpec& filling = *given;
  require_positive(spec, filling.exponent, "an exponent of its gas");
  require_positive(spec, filling.atmosphere_kPa, "an atmosphere");
  require_not_negative(spec, filling.compressibility, "a compressibility");
  require_not_negative(spec, filling.dead_mL, "a dead volume");
  if (filling.syringe_mL) require_positive(spec, *filling.syringe_mL, "a syringe's volume");
  const bool ordered = std::isfinite(spec.low) && spec.low <= spec.high && std::isfinite(spec.high);
  if (!ordered || !(filling.syringe_mL || spec.low > 0))
    refuse(spec, std::string("needs a range of ") +
                     (filling.syringe_mL ? "what is pushed with low <= high" : "its amount with 0 < low <= high") +
                     ", not " + interval_text(spec.low, spec.high));
  if (filling.syringe_mL && spec.high > *filling.syringe_mL)
    refuse(spec, "cannot push " + number(spec.high) + " mL out of a syringe of " + number(*filling.syringe_mL) + " mL");
}

void check_connected(const ActuatorSpec& spec, const std::vector<std::string>& connected, Formulation formulation) {
  if (connected.empty()) return;
  if (formulation != Formulation::physical)
    refuse(spec, "is of connected chambers: that needs the physical formulation");
  if (connected.size() < 2) refuse(spec, "needs two connected chambers or more");
  std::set<std::string> names;
  for (const std::string& name : connected)
    if (!names.insert(name).second) refuse(spec, "has '" + name + "' among its connected chambers twice");
}

void compile_filling(Compilation& c, const FillingSpec& spec, Actuator& actuator) {
  constexpr double mm3_per_mL = 1000, MPa_per_kPa = 1e-3;
  const double syringe = spec.syringe_mL.value_or(0), chamber = flat_at_rest(actuator) ? 0 : actuator.rest_measure;
  const Filling filling{.liquid = spec.liquid,
                        .pushed = spec.syringe_mL.has_value(),
                        .exponent = spec.exponent,
                        .compressibility = spec.compressibility,
                        .atmosphere_MPa = MPa_per_kPa * spec.atmosphere_kPa,
                        .dead_mm3 = mm3_per_mL * spec.dead_mL,
                        .syringe_mm3 = mm3_per_mL * syringe,
                        .chamber_mm3 = chamber};
  std::get<ChamberDrive>(actuator.drive).filling = filling;
  actuator.rest = filling.rest();
  const auto part = [](double mL, const char* where) { return mL > 0 ? ", " + number(mL) + " mL " + where : ""; };
  c.model.notes.push_back("Actuator '" + actuator.name + "' is sealed at rest with " +
                          number((chamber + filling.dead_mm3 + filling.syringe_mm3) / mm3_per_mL) + " mL of " +
                          (spec.liquid ? "liquid" : "gas") + " under " + number(spec.atmosphere_kPa) +
                          " kPa: " + number(chamber / mm3_per_mL) + " mL in " +
                          (connected_chambers(actuator).empty() ? "its chamber" : "its chambers") +
                          part(spec.dead_mL, "of dead volume") + part(syringe, "in its syringe") + ".");
  note_rest(c, actuator);
}

void check_atmospheres(const RobotSpec& spec) {
  const ActuatorSpec* first = nullptr;
  for (const ActuatorSpec& actuator : spec.actuators) {
    const FillingSpec* filling = filling_of(actuator);
    if (filling == nullptr) continue;
    if (first == nullptr) first = &actuator;
    const double of_first = filling_of(*first)->atmosphere_kPa;
    if (filling->atmosphere_kPa == of_first) continue;
    refuse(actuator, "is under an atmosphere of " + number(filling->atmosphere_kPa) + " kPa, actuator '" + first->name +
                         "' under one of " + number(of_first) + " kPa: give all scenes of robots the same");
  }
}

void note_rest(Compilation& c, const Actuator& actuator) {
  if (actuator.rest >= actuator.low && actuator.rest <= actuator.high) return;
  c.model.notes.push_back(
      "The range " + interval_text(actuator.low, actuator.high) + " of actuator '" + actuator.name + "' excludes its " +
      (actuator.is<GrowthDrive>() && actuator.control == Control::load
           ? "temperature of reference, " + command_text(actuator, actuator.rest)
       : actuator.control == Control::load ? "load at rest " + number(actuator.rest)
       : actuator.control == Control::filling
           ? std::string(control_name(actuator)) + " at rest, " + command_text(actuator, actuator.rest)
           : "rest ratio 1") +
      ": where none is requested, " + number(std::clamp(actuator.rest, actuator.low, actuator.high)) + " is taken.");
}

}  // namespace softkin
