#include <algorithm>
#include <cstdio>
#include <numbers>
#include <softkin/core/text.hpp>
#include <softkin/drive/machine.hpp>

namespace softkin::drive {

namespace {

/// Takes what is given, and notes what is not.
class Defaults {
 public:
  explicit Defaults(std::string owner) : owner_(std::move(owner)) {}

  double operator()(const std::optional<double>& given, double value, const std::string& key) {
    if (!given) note(key, number(value));
    return given.value_or(value);
  }
  void note(const std::string& key, const std::string& value) {
    line_ += (line_.empty() ? owner_ + ": " : ", ") + key + " " + value;
  }
  void add_to(std::vector<std::string>& lines) const {
    if (!line_.empty()) lines.push_back(line_);
  }

 private:
  std::string owner_, line_;
};

Tendon tendon_of(const TendonSpec& spec, const Actuator& actuator, Index index, Machine& machine) {
  Defaults take("tendon '" + spec.actuator + "'");
  Tendon tendon;
  tendon.origin = spec.origin;
  tendon.name = spec.actuator;
  tendon.actuator = index;
  tendon.axis = spec.axis;
  tendon.rest_length_mm = take(spec.rest_length_mm, actuator.rest_measure, "rest_length_mm");
  tendon.steps_per_mm = take(spec.steps_per_mm, HardwareDefaults::steps_per_mm, "steps_per_mm");
  tendon.drum_radius_mm = spec.drum_radius_mm;
  if (spec.drum_radius_mm) {
    const double steps =
        take(spec.steps_per_revolution, HardwareDefaults::steps_per_revolution, "steps_per_revolution");
    tendon.axis_mm_per_cable_mm = steps / (2 * std::numbers::pi * *spec.drum_radius_mm) / tendon.steps_per_mm;
  } else {
    take.note("drum_radius_mm", "none (a mm of the axis is a mm of cable)");
  }
  if (!spec.direction) take.note("direction", "1");
  tendon.direction = spec.direction.value_or(1);
  tendon.slack_offset_mm = take(spec.slack_offset_mm, 0, "slack_offset_mm");
  tendon.backlash_mm = take(spec.backlash_mm, 0, "backlash_mm");
  tendon.shortest_mm = actuator.low * tendon.rest_length_mm;
  tendon.longest_mm = actuator.high * tendon.rest_length_mm;
  if (spec.length_limits_mm) {
    tendon.shortest_mm = (*spec.length_limits_mm)[0];
    tendon.longest_mm = (*spec.length_limits_mm)[1];
  } else {
    take.note("length_limits_mm",
              "[" + number(tendon.shortest_mm) + ", " + number(tendon.longest_mm) + "] (the actuator's range)");
  }
  tendon.max_speed_mm_per_s = take(spec.max_speed_mm_per_s, HardwareDefaults::max_speed_mm_per_s, "max_speed_mm_per_s");
  tendon.max_acceleration_mm_per_s2 =
      take(spec.max_acceleration_mm_per_s2, HardwareDefaults::max_acceleration_mm_per_s2, "max_acceleration_mm_per_s2");
  take.add_to(machine.defaults);
  return tendon;
}

Chamber chamber_of(const ChamberSpec& spec, Index index, Machine& machine) {
  Defaults take("chamber '" + spec.actuator + "'");
  Chamber chamber{spec.origin,
                  spec.actuator,
                  spec.channel.value_or(spec.actuator),
                  index,
                  HardwareDefaults::low_kpa,
                  HardwareDefaults::high_kpa};
  if (!spec.channel) take.note("channel", "'" + chamber.channel + "'");
  if (spec.limits_kpa) {
    chamber.low_kpa = (*spec.limits_kpa)[0];
    chamber.high_kpa = (*spec.limits_kpa)[1];
  } else {
    take.note("limits_kPa", "[" + number(chamber.low_kpa) + ", " + number(chamber.high_kpa) + "]");
  }
  take.add_to(machine.defaults);
  return chamber;
}

class Assembly {
 public:
  Assembly(const Model& model, const HardwareSpec& hardware, const Commands& commands)
      : model_(model), hardware_(hardware), commands_(commands) {
    machine_.file = hardware.file;
    Defaults take("board");
    if (!hardware.configure) take.note("configure", "true");
    machine_.configure = hardware.configure.value_or(true);
    machine_.approach_speed_mm_per_s =
        take(hardware.approach_speed_mm_per_s, HardwareDefaults::approach_speed_mm_per_s, "approach_speed_mm_per_s");
    take.add_to(machine_.defaults);
  }

  Machine run() {
    for (std::size_t a = 0; a < model_.actuators.size(); ++a)
      if (commands_.commanded[a]) check_drivable(a);
    for (const TendonSpec& spec : hardware_.tendons) {
      const std::size_t a = find(spec.actuator, spec.origin, ActuatorKind::cable, "tendons", "cable");
      if (model_.actuators[a].control == Control::ratio)
        machine_.tendons.push_back(tendon_of(spec, model_.actuators[a], static_cast<Index>(a), machine_));
    }
    for (const ChamberSpec& spec : hardware_.chambers) {
      const std::size_t a = find(spec.actuator, spec.origin, ActuatorKind::pneumatic, "chambers", "chamber");
      if (commands_.commanded[a] || commands_.pressure_known[a])
        machine_.chambers.push_back(chamber_of(spec, static_cast<Index>(a), machine_));
    }
    for (std::size_t a = 0; a < model_.actuators.size(); ++a)
      if (commands_.commanded[a] || commands_.pressure_known[a]) check_described(a);
    return std::move(machine_);
  }

 private:
  std::size_t find(const std::string& name, const Origin& origin, ActuatorKind kind, const char* list,
                   const char* what) const {
    std::vector<std::string> names;
    for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
      names.push_back(model_.actuators[a].name);
      if (names.back() != name) continue;
      if (model_.actuators[a].kind != kind)
        throw InvalidInput(origin, "actuator '" + name + "' stands in '" + list + "' but is no " + what);
      return a;
    }
    throw InvalidInput(origin, "the scene has no actuator '" + name + "'" + suggest_name(name, names));
  }

  void check_drivable(std::size_t a) const {
    const Actuator& actuator = model_.actuators[a];
    if (actuator.kind == ActuatorKind::dea)
      throw InvalidInput({commands_.file}, "actuator '" + actuator.name +
                                               "' is a dielectric elastomer: drive moves steppers and schedules "
                                               "pressures, and sets no voltages");
    if (actuator.kind == ActuatorKind::cable && actuator.control == Control::load)
      throw InvalidInput({commands_.file}, "cable '" + actuator.name +
                                               "' is commanded by its tension, and a stepper sets lengths: give it "
                                               "'control: length' in the scene and command ratios, such as those that "
                                               "fk reports as achieved");
    if (actuator.kind == ActuatorKind::pneumatic && actuator.control == Control::ratio && !commands_.pressure_known[a])
      throw InvalidInput({commands_.file}, "chamber '" + actuator.name +
                                               "' is commanded by its volume, and a regulator sets pressures: add a "
                                               "column '" +
                                               actuator.name +
                                               "_pressure_kPa', or name the report of the run that made the commands "
                                               "(--pressures report.json)");
  }

  void check_described(std::size_t a) const {
    const Actuator& actuator = model_.actuators[a];
    const auto is_this = [&](const auto& each) { return each.name == actuator.name; };
    if (std::any_of(machine_.tendons.begin(), machine_.tendons.end(), is_this) ||
        std::any_of(machine_.chambers.begin(), machine_.chambers.end(), is_this))
      return;
    throw InvalidInput({hardware_.file}, "actuator '" + actuator.name + "', which " + commands_.file +
                                             " commands, has no entry in '" +
                                             (actuator.kind == ActuatorKind::cable ? "tendons" : "chambers") + "'");
  }

  const Model& model_;
  const HardwareSpec& hardware_;
  const Commands& commands_;
  Machine machine_;
};

}  // namespace

Machine assemble(const Model& model, const HardwareSpec& hardware, const Commands& commands) {
  return Assembly(model, hardware, commands).run();
}

}  // namespace softkin::drive
