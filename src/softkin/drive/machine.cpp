#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/core/text.hpp>
#include <softkin/drive/machine.hpp>

namespace softkin::drive {

namespace {

constexpr double default_steps_per_revolution = 3200;  // 200 full steps of 16 microsteps

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

Tendon tendon_of(const TendonSpec& spec, const Actuator& actuator, Index index, Machine& machine) {
  Defaults take("tendon '" + spec.actuator + "'");
  Tendon tendon;
  tendon.origin = spec.origin;
  tendon.name = spec.actuator;
  tendon.actuator = index;
  tendon.axis = spec.axis;
  tendon.rest_length_mm = actuator.rest_measure;
  take(tendon.rest_length_mm, spec.rest_length_mm, "rest_length_mm");
  take(tendon.steps_per_mm, spec.steps_per_mm, "steps_per_mm");
  tendon.drum_radius_mm = spec.drum_radius_mm;
  if (spec.drum_radius_mm) {
    double steps = default_steps_per_revolution;
    take(steps, spec.steps_per_revolution, "steps_per_revolution");
    tendon.axis_mm_per_cable_mm = steps / (2 * std::numbers::pi * *spec.drum_radius_mm) / tendon.steps_per_mm;
  } else {
    take.note("drum_radius_mm", "none (a mm of the axis is a mm of cable)");
  }
  take(tendon.direction, spec.direction, "direction");
  take(tendon.slack_offset_mm, spec.slack_offset_mm, "slack_offset_mm");
  take(tendon.backlash_mm, spec.backlash_mm, "backlash_mm");
  tendon.shortest_mm = actuator.low * tendon.rest_length_mm;
  tendon.longest_mm = actuator.high * tendon.rest_length_mm;
  take(tendon.shortest_mm, tendon.longest_mm, spec.length_limits_mm, "length_limits_mm", " (the actuator's range)");
  take(tendon.max_speed_mm_per_s, spec.max_speed_mm_per_s, "max_speed_mm_per_s");
  take(tendon.max_acceleration_mm_per_s2, spec.max_acceleration_mm_per_s2, "max_acceleration_mm_per_s2");
  take.add_to(machine.defaults);
  return tendon;
}

Chamber chamber_of(const ChamberSpec& spec, Index index, Machine& machine) {
  Defaults take("chamber '" + spec.actuator + "'");
  Chamber chamber{spec.origin, spec.actuator, spec.channel.value_or(spec.actuator), index};
  if (!spec.channel) take.note("channel", "'" + chamber.channel + "'");
  take(chamber.low_kpa, chamber.high_kpa, spec.limits_kpa, "limits_kPa");
  take.add_to(machine.defaults);
  return chamber;
}

std::size_t find(const Model& model, const std::string& name, const Origin& origin, ActuatorKind kind, const char* list,
                 const char* what) {
  std::vector<std::string> names;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    names.push_back(model.actuators[a].name);
    if (names.back() != name) continue;
    if (model.actuators[a].kind != kind)
      throw InvalidInput(origin, "actuator '" + name + "' stands in '" + list + "' but is no " + what);
    return a;
  }
  throw InvalidInput(origin, "the scene has no actuator '" + name + "'" + suggest_name(name, names));
}

void check_drivable(const Actuator& actuator, bool pressure_known, const std::string& file) {
  if (actuator.kind == ActuatorKind::dea)
    throw InvalidInput(
        {file}, "actuator '" + actuator.name +
                    "' is a dielectric elastomer: drive moves steppers and schedules pressures, and sets no voltages");
  if (actuator.kind == ActuatorKind::cable && actuator.control == Control::load)
    throw InvalidInput({file},
                       "cable '" + actuator.name +
                           "' is commanded by its tension, and a stepper sets lengths: give it 'control: length' in "
                           "the scene and command ratios, such as those that fk reports as achieved");
  if (actuator.kind == ActuatorKind::pneumatic && actuator.control == Control::ratio && !pressure_known)
    throw InvalidInput({file}, "chamber '" + actuator.name +
                                   "' is commanded by its volume, and a regulator sets pressures: add a column '" +
                                   actuator.name +
                                   "_pressure_kPa', or name the report of the run that made the commands (pressures) "
                                   "or, to softkin drive, a map of the robot");
}

void check_described(const Actuator& actuator, const Machine& machine, const std::string& commands) {
  const auto is_this = [&](const auto& each) { return each.name == actuator.name; };
  if (std::any_of(machine.tendons.begin(), machine.tendons.end(), is_this) ||
      std::any_of(machine.chambers.begin(), machine.chambers.end(), is_this))
    return;
  throw InvalidInput({machine.file}, "actuator '" + actuator.name + "', which " + commands +
                                         " commands, has no entry in '" +
                                         (actuator.kind == ActuatorKind::cable ? "tendons" : "chambers") + "'");
}

constexpr std::int64_t fewest_steps = 6;  // MIN_STEPS_PER_SEGMENT of Marlin
constexpr double shortest_s = 0.1;
constexpr double no_move_mm = 1e-9;       // of cable: rounding of ratios
constexpr double slack_of_limits = 1e-9;  // relative

/// Where the motors stand, in mm of cable from home, backlash included.
class Motors {
 public:
  explicit Motors(const Machine& machine)
      : machine_(machine), wound_(machine.tendons.size(), 0.0), loose_(machine.tendons.size(), 0.0) {}

  /// Motors for these lengths of cable, from where they stand; they stand there afterwards.
  const std::vector<double>& go_to(const std::vector<double>& wound) {
    for (std::size_t i = 0; i < wound.size(); ++i) {
      const double change = wound[i] - wound_[i];
      if (std::abs(change) <= no_move_mm) continue;
      loose_[i] = change > 0 ? 0 : machine_.tendons[i].backlash_mm;
      wound_[i] = wound[i];
    }
    motors_.resize(wound.size());
    for (std::size_t i = 0; i < wound.size(); ++i) motors_[i] = wound_[i] - loose_[i];
    return motors_;
  }

 private:
  const Machine& machine_;
  std::vector<double> wound_, loose_, motors_;
};

Steps to_steps(const Machine& machine, const std::vector<double>& motors) {
  Steps steps;
  for (std::size_t i = 0; i < motors.size(); ++i) steps.push_back(std::llround(machine.tendons[i].steps(motors[i])));
  return steps;
}

/// Puts off moves that a board would drop.
class Merger {
 public:
  Merger(Steps start, std::vector<Move>& moves) : given_(start), emitted_(std::move(start)), moves_(moves) {}

  /// holds: the cables are to stay where they are, to the last digit.
  void add(const Steps& target, bool holds, double seconds, std::size_t line) {
    given_ = target;
    line_ = line;
    if (holds) {
      flush();
      return rest(seconds);
    }
    waiting_ += seconds;
    if (distance() >= fewest_steps) move();
  }

  void finish() {
    if (given_ == emitted_) return flush();
    if (waiting_ == 0) waiting_ = shortest_s;  // a rest had the time of this move
    move();
  }

 private:
  [[nodiscard]] std::int64_t distance() const {
    std::int64_t most = 0;
    for (std::size_t i = 0; i < given_.size(); ++i) most = std::max(most, std::abs(given_[i] - emitted_[i]));
    return most;
  }
  void move() {
    moves_.push_back({given_, waiting_, line_});
    emitted_ = given_;
    waiting_ = 0;
  }
  void flush() {
    if (waiting_ > 0) rest(waiting_);
    waiting_ = 0;
  }
  void rest(double seconds) {
    if (seconds <= 0) return;
    if (!moves_.empty() && rests_ == moves_.size()) {
      moves_.back().seconds += seconds;
      moves_.back().line = line_;
    } else {
      moves_.push_back({emitted_, seconds, line_});
    }
    rests_ = moves_.size();
  }

  Steps given_, emitted_;
  std::vector<Move>& moves_;
  double waiting_ = 0;  // [s] of rows whose moves are put off
  std::size_t line_ = 0;
  std::size_t rests_ = 0;  // moves_ ends with a rest where it has so many entries
};

class Planner {
 public:
  Planner(const Machine& machine, const Commands& commands)
      : machine_(machine), commands_(commands), motors_(machine), here_(machine.tendons.size(), 0.0) {}

  Motion plan(bool return_home) {
    Motion motion;
    motion.timed = commands_.rows.front().time_s.has_value();
    const Steps home(machine_.tendons.size(), 0);
    approach(home, motion.approach);
    Merger merger(motion.approach.empty() ? home : motion.approach.back().target, motion.moves);
    for (std::size_t row = 1; row < commands_.rows.size(); ++row) add_row(row, merger);
    merger.finish();
    check_acceleration(commands_.rows.back(), speeds_, std::vector<double>(speeds_.size(), 0.0), last_seconds_ / 2,
                       "the stop after");
    for (const Move& move : motion.moves) motion.seconds += move.seconds;
    if (return_home) {
      const Steps end = to_steps(machine_, here_);
      go_free(std::vector<double>(machine_.tendons.size(), 0.0), 0, end, motion.back);
      // from home the cables are wound up: leave the backlash as it was found
      const bool loose = !motion.back.empty() && motion.back.back().target != home;
      if (loose) motion.back.push_back({home, free_seconds(std::vector<double>(home.size(), 0.0)), 0});
    }
    return motion;
  }

 private:
  [[noreturn]] void fail(const CommandRow& row, const Tendon& tendon, const std::string& message) const {
    throw InvalidInput({commands_.file, row.line}, "tendon '" + tendon.name + "': " + message);
  }

  [[nodiscard]] std::vector<double> wound(const CommandRow& row) const {
    std::vector<double> result;
    for (const Tendon& tendon : machine_.tendons) {
      const double length = row.actuation[tendon.actuator] * tendon.rest_length_mm;
      const bool low = length < tendon.shortest_mm * (1 - slack_of_limits);
      if (low || length > tendon.longest_mm * (1 + slack_of_limits))
        fail(row, tendon,
             "length " + number(length) + " mm (ratio " + number(row.actuation[tendon.actuator]) + " of " +
                 number(tendon.rest_length_mm) + " mm) is " + (low ? "below" : "above") + " its limit of " +
                 number(low ? tendon.shortest_mm : tendon.longest_mm) + " mm (" + tendon.origin.text() + ")");
      result.push_back(tendon.wound_mm(length));
    }
    return result;
  }

  /// Time that motors need to a place where nothing says when: at the approach speed, and within the accelerations.
  [[nodiscard]] double free_seconds(const std::vector<double>& motors) const {
    double seconds = 0;
    for (std::size_t i = 0; i < motors.size(); ++i) {
      const Tendon& tendon = machine_.tendons[i];
      const double distance = std::abs(motors[i] - here_[i]);
      const double speed = std::min(machine_.approach_speed_mm_per_s, tendon.max_speed_mm_per_s);
      seconds = std::max({seconds, distance / speed, std::sqrt(2 * distance / tendon.max_acceleration_mm_per_s2)});
    }
    return seconds;
  }

  void go_free(const std::vector<double>& target, std::size_t line, const Steps& from, std::vector<Move>& moves) {
    const std::vector<double> motors = motors_.go_to(target);
    const Steps steps = to_steps(machine_, motors);
    if (steps != from) moves.push_back({steps, free_seconds(motors), line});
    here_ = motors;
  }

  void approach(const Steps& home, std::vector<Move>& moves) {
    const CommandRow& first = commands_.rows.front();
    go_free(wound(first), first.line, home, moves);
    speeds_.assign(machine_.tendons.size(), 0.0);
  }

  void add_row(std::size_t index, Merger& merger) {
    const CommandRow& row = commands_.rows[index];
    const std::vector<double> motors = motors_.go_to(wound(row));
    const double seconds = row.time_s ? *row.time_s - *commands_.rows[index - 1].time_s : free_seconds(motors);
    std::vector<double> speeds(motors.size(), 0.0);
    if (seconds > 0)
      for (std::size_t i = 0; i < motors.size(); ++i) speeds[i] = (motors[i] - here_[i]) / seconds;
    for (std::size_t i = 0; i < motors.size(); ++i) {
      const Tendon& tendon = machine_.tendons[i];
      if (std::abs(speeds[i]) > tendon.max_speed_mm_per_s * (1 + slack_of_limits))
        fail(row, tendon,
             number(std::abs(speeds[i])) + " mm/s to reach this row is above its limit of " +
                 number(tendon.max_speed_mm_per_s) + " mm/s (" + tendon.origin.text() + ")");
    }
    check_acceleration(row, speeds_, speeds, (last_seconds_ + seconds) / 2, "the way to");
    merger.add(to_steps(machine_, motors), motors == here_, seconds, row.line);
    speeds_ = speeds;
    last_seconds_ = seconds;
    here_ = motors;
  }

  void check_acceleration(const CommandRow& row, const std::vector<double>& before, const std::vector<double>& after,
                          double seconds, const std::string& where) const {
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Tendon& tendon = machine_.tendons[i];
      const double change = std::abs(after[i] - before[i]);
      if (change <= tendon.max_acceleration_mm_per_s2 * seconds * (1 + slack_of_limits)) continue;
      fail(row, tendon,
           "a change of speed by " + number(change) + " mm/s on " + where + " this row takes " +
               number(change / seconds) + " mm/s^2, above its limit of " + number(tendon.max_acceleration_mm_per_s2) +
               " mm/s^2 (" + tendon.origin.text() + ")");
    }
  }

  const Machine& machine_;
  const Commands& commands_;
  Motors motors_;
  std::vector<double> here_;    // motors [mm of cable]
  std::vector<double> speeds_;  // of the last row's move [mm/s]
  double last_seconds_ = 0;     // of the last row's move
};

}  // namespace

Machine assemble(const Model& model, const HardwareSpec& hardware, const Commands& commands) {
  Machine machine;
  machine.file = hardware.file;
  Defaults take("board");
  if (!hardware.configure) take.note("configure", "true");
  machine.configure = hardware.configure.value_or(true);
  take(machine.approach_speed_mm_per_s, hardware.approach_speed_mm_per_s, "approach_speed_mm_per_s");
  take.add_to(machine.defaults);
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (commands.commanded[a]) check_drivable(model.actuators[a], commands.pressure_known[a], commands.file);
  for (const TendonSpec& spec : hardware.tendons) {
    const std::size_t a = find(model, spec.actuator, spec.origin, ActuatorKind::cable, "tendons", "cable");
    if (model.actuators[a].control == Control::ratio)
      machine.tendons.push_back(tendon_of(spec, model.actuators[a], static_cast<Index>(a), machine));
  }
  for (const ChamberSpec& spec : hardware.chambers) {
    const std::size_t a = find(model, spec.actuator, spec.origin, ActuatorKind::pneumatic, "chambers", "chamber");
    if (commands.commanded[a] || commands.pressure_known[a])
      machine.chambers.push_back(chamber_of(spec, static_cast<Index>(a), machine));
  }
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (commands.commanded[a] || commands.pressure_known[a])
      check_described(model.actuators[a], machine, commands.file);
  return machine;
}

Motion plan_motion(const Machine& machine, const Commands& commands, bool return_home) {
  return Planner(machine, commands).plan(return_home);
}

}  // namespace softkin::drive
