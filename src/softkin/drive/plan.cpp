#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/core/text.hpp>
#include <softkin/drive/plan.hpp>

namespace softkin::drive {

namespace {

constexpr std::size_t longest_command = 78;  // of 96, less number, checksum and end
constexpr std::size_t moves_ahead = 64;      // that a board plans, at most

std::string coordinate(double value) {
  std::string text = decimal(value, 5);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string significant(double value) {
  return number(value, 7);
}

class Writer {
 public:
  Writer(const Machine& machine, const Motion& motion) : machine_(machine), motion_(motion) {}

  GcodeProgram write() {
    for (const Tendon& tendon : machine_.tendons) program_.axes += tendon.axis;
    here_.assign(machine_.tendons.size(), 0);
    program_.start.assign(here_.size(), 0.0);
    write_setup();
    for (const Move& move : motion_.approach) add(move);
    if (!motion_.approach.empty() && !motion_.moves.empty()) add_line("M400", drain(), 0);
    for (const Move& move : motion_.moves) add(move);
    for (const Move& move : motion_.back) add(move);
    program_.drain_s = drain();
    return std::move(program_);
  }

 private:
  void write_setup() {
    auto& setup = program_.setup;
    setup = {"G21", "G90"};
    if (machine_.configure) {
      setup.push_back("M92" + per_axis([](const Tendon& t) { return t.steps_per_mm; }));
      setup.push_back("M201" +
                      per_axis([](const Tendon& t) { return t.max_acceleration_mm_per_s2 * t.axis_mm_per_cable_mm; }));
      setup.push_back("M203" + per_axis([](const Tendon& t) { return t.max_speed_mm_per_s * t.axis_mm_per_cable_mm; }));
      setup.push_back("M211 S0");
      setup.push_back("M84 S0");
    }
    setup.push_back("G92" + per_axis([](const Tendon&) { return 0.0; }));
  }

  template <class Value>
  std::string per_axis(const Value& value) const {
    std::string text;
    for (const Tendon& tendon : machine_.tendons) text += std::string(" ") + tendon.axis + significant(value(tendon));
    return text;
  }

  [[nodiscard]] std::vector<double> position() const {
    std::vector<double> result;
    for (std::size_t i = 0; i < here_.size(); ++i)
      result.push_back(static_cast<double>(here_[i]) / machine_.tendons[i].steps_per_mm);
    return result;
  }

  /// The length that Marlin takes a feed rate along.
  [[nodiscard]] double feed_length(const Steps& target) const {
    double primary = 0, secondary = 0;
    for (std::size_t i = 0; i < target.size(); ++i) {
      const Tendon& tendon = machine_.tendons[i];
      const double length = static_cast<double>(target[i] - here_[i]) / tendon.steps_per_mm;
      const bool is_primary = std::string("XYZ").find(tendon.axis) != std::string::npos;
      (is_primary ? primary : secondary) += length * length;
    }
    return std::sqrt(primary > 0 ? primary : secondary);
  }

  void add(const Move& move) {
    const double length = feed_length(move.target);
    if (length == 0) return add_rest(move);
    const double per_minute = 60 * length / move.seconds;
    here_ = move.target;
    std::string text = "G1";
    const std::vector<double> at = position();
    for (std::size_t i = 0; i < at.size(); ++i) text += " " + std::string(1, program_.axes[i]) + coordinate(at[i]);
    durations_.push_back(move.seconds);
    add_line(text + " F" + significant(per_minute), longest_ahead(), move.line);
  }

  /// Whole ms; what is left over is added to the next rest.
  void add_rest(const Move& move) {
    rest_left_ += move.seconds;
    const long long ms = std::llround(1000 * rest_left_);
    if (ms <= 0) return;
    rest_left_ -= static_cast<double>(ms) / 1000;
    durations_.push_back(move.seconds);
    add_line("G4 P" + std::to_string(ms), drain(), move.line);  // Marlin ends all moves before it begins to wait
  }

  void add_line(std::string text, double patience, std::size_t row) {
    if (text.size() > longest_command)
      throw InvalidInput("a line of G-code is longer than Marlin reads: " + text +
                         ": use fewer axes, or more mm of cable per mm of axis (steps_per_mm)");
    program_.lines.push_back({std::move(text), patience, position(), row});
  }

  [[nodiscard]] double longest_ahead() const {
    const auto count = static_cast<std::ptrdiff_t>(std::min(moves_ahead, durations_.size()));
    return count == 0 ? 0 : *std::max_element(durations_.end() - count, durations_.end());
  }
  [[nodiscard]] double drain() const {
    double sum = 0;
    for (std::size_t i = durations_.size() - std::min(moves_ahead, durations_.size()); i < durations_.size(); ++i)
      sum += durations_[i];
    return sum;
  }

  const Machine& machine_;
  const Motion& motion_;
  GcodeProgram program_;
  Steps here_;
  std::vector<double> durations_;  // [s]
  double rest_left_ = 0;           // [s]
};

}  // namespace

GcodeProgram make_gcode(const Machine& machine, const Motion& motion) {
  return Writer(machine, motion).write();
}

std::string gcode_text(const Machine& machine, const GcodeProgram& program) {
  std::string text = "; Before this program the motors stand at home: cables at their length at rest plus slack.\n";
  for (const Tendon& tendon : machine.tendons)
    text += std::string("; ") + tendon.axis + ": tendon '" + tendon.name + "', " +
            significant(tendon.axis_mm_per_cable_mm) + " mm of axis per mm of cable, " +
            significant(tendon.steps_per_mm) + " steps per mm of axis\n";
  for (const std::string& line : program.setup) text += line + "\n";
  for (const GcodeLine& line : program.lines) text += line.text + "\n";
  return text + "M400\n";
}

PressureSchedule plan_pressures(const Machine& machine, const Commands& commands) {
  PressureSchedule schedule;
  for (const Chamber& chamber : machine.chambers) schedule.channels.push_back(chamber.channel);
  if (schedule.channels.empty()) return schedule;
  if (!commands.rows.front().time_s)
    throw InvalidInput({commands.file}, "has no column t_s [s]: a schedule of pressures needs the times");
  for (const CommandRow& row : commands.rows) {
    PressureSchedule::Row out{*row.time_s, {}};
    for (const Chamber& chamber : machine.chambers) {
      const bool known = commands.pressure_known[static_cast<std::size_t>(chamber.actuator)];
      const double kpa = known ? row.pressures_kpa[chamber.actuator] : row.actuation[chamber.actuator];
      const bool low = kpa < chamber.low_kpa;
      if (low || kpa > chamber.high_kpa)
        throw InvalidInput({commands.file, row.line}, "chamber '" + chamber.name + "': pressure " + number(kpa, 6) +
                                                          " kPa is " + (low ? "below" : "above") + " its limit of " +
                                                          number(low ? chamber.low_kpa : chamber.high_kpa, 6) +
                                                          " kPa (" + chamber.origin.text() + ")");
      out.kpa.push_back(kpa);
    }
    schedule.rows.push_back(std::move(out));
  }
  return schedule;
}

std::string schedule_csv(const PressureSchedule& schedule) {
  std::string text = "t_s";
  for (const std::string& channel : schedule.channels) text += "," + channel + "_kPa";
  text += "\n";
  for (const PressureSchedule::Row& row : schedule.rows) {
    text += number(row.time_s, 12);
    for (const double kpa : row.kpa) text += "," + number(kpa, 9);
    text += "\n";
  }
  return text;
}

Plan make_plan(const Model& model, const HardwareSpec& hardware, Commands commands, bool return_home) {
  Plan plan;
  plan.commands = std::move(commands);
  plan.machine = assemble(model, hardware, plan.commands);
  plan.schedule = plan_pressures(plan.machine, plan.commands);
  if (plan.machine.tendons.empty()) return plan;
  plan.motion = plan_motion(plan.machine, plan.commands, return_home);
  plan.program = make_gcode(plan.machine, plan.motion);
  return plan;
}

TendonUse use_of(const Plan& plan, std::size_t index) {
  const Tendon& tendon = plan.machine.tendons[index];
  TendonUse use;
  use.shortest_mm = tendon.longest_mm;
  for (const CommandRow& row : plan.commands.rows) {
    const double length = row.actuation[tendon.actuator] * tendon.rest_length_mm;
    use.shortest_mm = std::min(use.shortest_mm, length);
    use.longest_mm = std::max(use.longest_mm, length);
  }
  const auto cable_mm = [&](std::int64_t steps) {
    return static_cast<double>(std::abs(steps)) / (tendon.steps_per_mm * tendon.axis_mm_per_cable_mm);
  };
  std::int64_t here = 0;
  for (const auto* moves : {&plan.motion.approach, &plan.motion.moves, &plan.motion.back})
    for (const Move& move : *moves) {
      use.fastest_mm_per_s = std::max(use.fastest_mm_per_s, cable_mm(move.target[index] - here) / move.seconds);
      here = move.target[index];
      use.lowest = std::min(use.lowest, here);
      use.highest = std::max(use.highest, here);
    }
  if (tendon.drum_radius_mm)
    use.turns = cable_mm(std::max(std::abs(use.lowest), std::abs(use.highest))) /
                (2 * std::numbers::pi * *tendon.drum_radius_mm);
  return use;
}

std::pair<double, double> pressure_range(const Plan& plan, std::size_t chamber) {
  const auto [low, high] =
      std::minmax_element(plan.schedule.rows.begin(), plan.schedule.rows.end(),
                          [chamber](const auto& a, const auto& b) { return a.kpa[chamber] < b.kpa[chamber]; });
  return {low->kpa[chamber], high->kpa[chamber]};
}

double seconds_of(const std::vector<Move>& moves) {
  double seconds = 0;
  for (const Move& move : moves) seconds += move.seconds;
  return seconds;
}

}  // namespace softkin::drive
