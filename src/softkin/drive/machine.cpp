#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/core/text.hpp>
#include <softkin/drive/machine.hpp>
#include <softkin/model/names.hpp>

namespace softkin::drive {

namespace {

constexpr double default_steps_per_revolution = 3200;                           // 200 full steps of 16 microsteps
constexpr double default_plunger_speed = 5, default_plunger_acceleration = 50;  // [mm/s], [mm/s^2]
constexpr double mm3_per_ml = 1000;
constexpr double slack_of_depth = 1e-9;  // relative

/// Takes what is given, and notes what is not.
class Defaults {
 public:
  explicit Defaults(std::string owner) : owner_(std::move(owner)) {}

  /// value: the default.
  template <class Value>
  void operator()(Value& value, const std::optional<Value>& given, const std::string& key) {
    if (!given) note(key, number(value));
    value = given.value_or(value);
  }
  void operator()(double& low, double& high, const std::optional<std::array<double, 2>>& given, const std::string& key,
                  const std::string& remark = "") {
    if (!given) note(key, "[" + number(low) + ", " + number(high) + "]" + remark);
    const auto [least, most] = given.value_or(std::array{low, high});
    low = least;
    high = most;
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

void name_motor(const MotorSpec& spec, Index actuator, Motor& motor) {
  motor.origin = spec.origin;
  motor.name = spec.actuator;
  motor.actuator = actuator;
  motor.axis = spec.axis;
}

/// mm_per_turn: of cable or plunger in a revolution; none: no drum, no screw, whose key is named.
void gear_motor(const MotorSpec& spec, const std::optional<double>& mm_per_turn, const std::string& key,
                const std::string& what, Defaults& take, Motor& motor) {
  take(motor.steps_per_mm, spec.steps_per_mm, "steps_per_mm");
  if (mm_per_turn) {
    double steps = default_steps_per_revolution;
    take(steps, spec.steps_per_revolution, "steps_per_revolution");
    motor.axis_mm_per_mm = steps / *mm_per_turn / motor.steps_per_mm;
  } else {
    take.note(key, "none (a mm of the axis is a mm of " + what + ")");
  }
  take(motor.direction, spec.direction, "direction");
}

void limit_motor(const MotorSpec& spec, Defaults& take, Motor& motor) {
  take(motor.max_speed_mm_per_s, spec.max_speed_mm_per_s, "max_speed_mm_per_s");
  take(motor.max_acceleration_mm_per_s2, spec.max_acceleration_mm_per_s2, "max_acceleration_mm_per_s2");
}

Tendon tendon_of(const TendonSpec& spec, const Actuator& actuator, Index index, Machine& machine) {
  Defaults take("tendon '" + spec.actuator + "'");
  Tendon tendon;
  name_motor(spec, index, tendon);
  tendon.rest_length_mm = actuator.rest_measure;
  take(tendon.rest_length_mm, spec.rest_length_mm, "rest_length_mm");
  tendon.drum_radius_mm = spec.drum_radius_mm;
  const auto turn = spec.drum_radius_mm ? std::optional(2 * std::numbers::pi * *spec.drum_radius_mm) : std::nullopt;
  gear_motor(spec, turn, "drum_radius_mm", "cable", take, tendon);
  take(tendon.slack_offset_mm, spec.slack_offset_mm, "slack_offset_mm");
  take(tendon.backlash_mm, spec.backlash_mm, "backlash_mm");
  tendon.shortest_mm = actuator.low * tendon.rest_length_mm;
  tendon.longest_mm = actuator.high * tendon.rest_length_mm;
  take(tendon.shortest_mm, tendon.longest_mm, spec.length_limits_mm, "length_limits_mm", " (the actuator's range)");
  limit_motor(spec, take, tendon);
  take.add_to(machine.defaults);
  return tendon;
}

/// Volumes of the file in mL, with those of the model where it has none.
SyringeSetup air_of(const SyringeSpec& spec, const Actuator& actuator, double atmosphere_kpa, Defaults& take) {
  double chamber_ml = actuator.rest_measure / mm3_per_ml, dead_ml = 0;
  take(chamber_ml, spec.chamber_mL, "chamber_mL");
  take(dead_ml, spec.dead_volume_mL, "dead_volume_mL");
  // without a conversion to mL where the model has the volume: the last digit would differ
  const double chamber_mm3 = spec.chamber_mL ? chamber_ml * mm3_per_ml : actuator.rest_measure;
  return {chamber_mm3, dead_ml * mm3_per_ml, spec.syringe_mL * mm3_per_ml, atmosphere_kpa};
}

/// What a syringe has pushed is commanded: its own air is that of the scene.
void check_air(const SyringeSpec& spec, const Actuator& actuator, const std::optional<double>& atmosphere_kPa) {
  constexpr double same = 1e-6, kPa_per_MPa = 1000;
  const Filling& filling = *filling_of(actuator);
  const auto agree = [&](const std::optional<double>& given, double scene, const char* key, const char* unit) {
    if (!given || std::abs(*given - scene) <= same * std::max(*given, scene)) return;
    throw InvalidInput(spec.origin, "syringe '" + spec.actuator + "': " + key + " is " + number(*given) + " " + unit +
                                        ", but " + number(scene) + " " + unit + " in the scene: give both the same");
  };
  agree(spec.syringe_mL, filling.syringe_mm3 / mm3_per_ml, "syringe_mL", "mL");
  agree(spec.dead_volume_mL, filling.dead_mm3 / mm3_per_ml, "dead_volume_mL", "mL");
  agree(spec.chamber_mL, filling.chamber_mm3 / mm3_per_ml, "chamber_mL", "mL");
  agree(atmosphere_kPa, kPa_per_MPa * filling.atmosphere_MPa, "atmosphere_kPa", "kPa");
  if (spec.limits_kpa)
    throw InvalidInput(spec.origin, "syringe '" + spec.actuator + "': limits_kPa cannot be kept, as '" + spec.actuator +
                                        "' is commanded by its pushed volume, which says no pressure: leave "
                                        "limits_kPa out and give travel_limits_mm");
}

Syringe syringe_of(const SyringeSpec& spec, const Actuator& actuator, Index index,
                   const std::optional<double>& atmosphere_kPa, Machine& machine) {
  Defaults take("syringe '" + spec.actuator + "'");
  Syringe syringe;
  name_motor(spec, index, syringe);
  const Filling* filling = filling_of(actuator);
  syringe.by_pushed_mL = filling != nullptr;
  if (filling) {
    check_air(spec, actuator, atmosphere_kPa);
    syringe.air = {filling->chamber_mm3, filling->dead_mm3, filling->syringe_mm3, 1000 * filling->atmosphere_MPa};
  } else {
    syringe.air = air_of(spec, actuator, machine.atmosphere_kpa, take);
  }
  syringe.mm3_per_mm = spec.mL_per_mm * mm3_per_ml;
  syringe.lead_mm = spec.lead_mm;
  gear_motor(spec, spec.lead_mm, "lead_mm", "plunger", take, syringe);
  take(syringe.backlash_mm, spec.backlash_mm, "backlash_mm");
  const double depth_mm = syringe.air.syringe_mm3 / syringe.mm3_per_mm;
  syringe.highest_mm = depth_mm;
  take(syringe.lowest_mm, syringe.highest_mm, spec.travel_limits_mm, "travel_limits_mm", " (what the syringe holds)");
  if (syringe.highest_mm > depth_mm * (1 + slack_of_depth))
    throw InvalidInput(spec.origin, "syringe '" + spec.actuator + "': a plunger at " + number(syringe.highest_mm, 6) +
                                        " mm would have pushed out more than the " + number(spec.syringe_mL, 6) +
                                        " mL of the syringe, which end at " + number(depth_mm, 6) + " mm");
  syringe.limits_kpa = spec.limits_kpa;
  if (!spec.limits_kpa && !syringe.by_pushed_mL) take.note("limits_kPa", "none");
  syringe.max_speed_mm_per_s = default_plunger_speed;
  syringe.max_acceleration_mm_per_s2 = default_plunger_acceleration;
  limit_motor(spec, take, syringe);
  take.add_to(machine.defaults);
  return syringe;
}

Chamber chamber_of(const ChamberSpec& spec, Index index, Machine& machine) {
  Defaults take("chamber '" + spec.actuator + "'");
  Chamber chamber{spec.origin, spec.actuator, spec.channel.value_or(spec.actuator), index};
  if (!spec.channel) take.note("channel", "'" + chamber.channel + "'");
  take(chamber.low_kpa, chamber.high_kpa, spec.limits_kpa, "limits_kPa");
  take.add_to(machine.defaults);
  return chamber;
}

template <class Kind>
std::size_t find(const Model& model, const std::string& name, const Origin& origin, const char* list,
                 const char* what) {
  std::vector<std::string> names;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    names.push_back(model.actuators[a].name);
    if (names.back() != name) continue;
    if (!model.actuators[a].is<Kind>())
      throw InvalidInput(origin, "actuator '" + name + "' stands in '" + list + "' but is no " + what);
    return a;
  }
  throw InvalidInput(origin, "the scene has no actuator '" + name + "'" + suggest_name(name, names));
}

void check_drivable(const Actuator& actuator, bool pressure_known, bool on_syringe, const std::string& file) {
  if (actuator.is<DeaDrive>())
    throw InvalidInput(
        {file}, "actuator '" + actuator.name +
                    "' is a dielectric elastomer: drive moves steppers and schedules pressures, and sets no voltages");
  if (actuator.is<CableDrive>() && actuator.control == Control::load)
    throw InvalidInput({file},
                       "cable '" + actuator.name +
                           "' is commanded by its tension, and a stepper sets lengths: give it 'control: length' in "
                           "the scene and command ratios, such as those that fk reports as achieved");
  if (!actuator.is<ChamberDrive>()) return;
  if (const Filling* filling = filling_of(actuator); filling && !(on_syringe && filling->pushed))
    throw InvalidInput(
        {file}, "chamber '" + actuator.name + "' is commanded by its " + control_name(actuator) + ", and " +
                    (on_syringe ? "a plunger sets what it has pushed: give it 'source: {syringe_mL: ...}' in the scene"
                                : "a regulator sets pressures: put it on a syringe, or give it 'control: pressure'"));
  if (on_syringe && actuator.control == Control::load)
    throw InvalidInput({file},
                       "chamber '" + actuator.name +
                           "' is commanded by its pressure, and its syringe needs its volume, too: give it 'control: "
                           "volume' in the scene and command ratios, such as those that fk reports as achieved");
  if (actuator.control == Control::ratio && !pressure_known)
    throw InvalidInput(
        {file}, "chamber '" + actuator.name + "' is commanded by its volume, and " +
                    (on_syringe ? "its plunger's place depends on its pressure, too" : "a regulator sets pressures") +
                    ": add a column '" + actuator.name +
                    "_pressure_kPa', or name the report of the run that made the commands (pressures) "
                    "or, to softkin drive, a map of the robot");
}

void check_described(const Actuator& actuator, const Machine& machine, const std::string& commands) {
  const auto is_this = [&](const auto& each) { return each.name == actuator.name; };
  if (std::any_of(machine.tendons.begin(), machine.tendons.end(), is_this) ||
      std::any_of(machine.syringes.begin(), machine.syringes.end(), is_this) ||
      std::any_of(machine.chambers.begin(), machine.chambers.end(), is_this))
    return;
  throw InvalidInput({machine.file}, "actuator '" + actuator.name + "', which " + commands +
                                         " commands, has no entry in " +
                                         (actuator.is<CableDrive>() ? "'tendons'" : "'chambers' or 'syringes'"));
}

bool stands_on_syringe(const HardwareSpec& hardware, const Actuator& actuator) {
  return std::any_of(hardware.syringes.begin(), hardware.syringes.end(),
                     [&](const SyringeSpec& spec) { return spec.actuator == actuator.name; });
}

void assemble_board(const Model& model, const HardwareSpec& hardware, Machine& machine) {
  Defaults take("board");
  if (!hardware.configure) take.note("configure", "true");
  machine.configure = hardware.configure.value_or(true);
  take(machine.approach_speed_mm_per_s, hardware.approach_speed_mm_per_s, "approach_speed_mm_per_s");
  take.add_to(machine.defaults);
  const bool any_air = std::any_of(hardware.syringes.begin(), hardware.syringes.end(), [&](const SyringeSpec& spec) {
    const auto actuator = find_actuator(model, spec.actuator);
    return !actuator || !filling_of(model.actuators[*actuator]);
  });
  if (!any_air) return;
  Defaults take_air("air");
  take_air(machine.atmosphere_kpa, hardware.atmosphere_kPa, "atmosphere_kPa");
  take_air.add_to(machine.defaults);
}

}  // namespace

std::vector<const Motor*> Machine::motors() const {
  std::vector<const Motor*> all;
  for (const Tendon& tendon : tendons) all.push_back(&tendon);
  for (const Syringe& syringe : syringes) all.push_back(&syringe);
  return all;
}

Machine assemble(const Model& model, const HardwareSpec& hardware, const Commands& commands) {
  Machine machine;
  machine.file = hardware.file;
  assemble_board(model, hardware, machine);
  const auto& actuators = model.actuators;
  const auto is_driven = [&](std::size_t a) { return commands.commanded[a] || commands.pressure_known[a]; };
  for (std::size_t a = 0; a < actuators.size(); ++a)
    if (commands.commanded[a])
      check_drivable(actuators[a], commands.pressure_known[a], stands_on_syringe(hardware, actuators[a]),
                     commands.file);
  for (const TendonSpec& spec : hardware.tendons) {
    const std::size_t a = find<CableDrive>(model, spec.actuator, spec.origin, "tendons", "cable");
    if (actuators[a].control == Control::ratio) machine.tendons.push_back(tendon_of(spec, actuators[a], a, machine));
  }
  for (const SyringeSpec& spec : hardware.syringes) {
    const std::size_t a = find<ChamberDrive>(model, spec.actuator, spec.origin, "syringes", "chamber");
    if (is_driven(a)) machine.syringes.push_back(syringe_of(spec, actuators[a], a, hardware.atmosphere_kPa, machine));
  }
  for (const ChamberSpec& spec : hardware.chambers) {
    const std::size_t a = find<ChamberDrive>(model, spec.actuator, spec.origin, "chambers", "chamber");
    if (is_driven(a)) machine.chambers.push_back(chamber_of(spec, a, machine));
  }
  for (std::size_t a = 0; a < actuators.size(); ++a)
    if (is_driven(a)) check_described(actuators[a], machine, commands.file);
  return machine;
}

}  // namespace softkin::drive
