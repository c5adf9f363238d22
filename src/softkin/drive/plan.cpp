#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/drive/curve_pressures.hpp>
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
  Writer(const Machine& machine, const Motion& motion)
      : machine_(machine), motors_(machine.motors()), motion_(motion) {}

  GcodeProgram write() {
    for (const Motor* motor : motors_) program_.axes += motor->axis;
    here_.assign(motors_.size(), 0);
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
      setup.push_back("M92" + per_axis([](const Motor& m) { return m.steps_per_mm; }));
      setup.push_back("M201" +
                      per_axis([](const Motor& m) { return m.max_acceleration_mm_per_s2 * m.axis_mm_per_mm; }));
      setup.push_back("M203" + per_axis([](const Motor& m) { return m.max_speed_mm_per_s * m.axis_mm_per_mm; }));
      setup.push_back("M211 S0");
      setup.push_back("M84 S0");
    }
    setup.push_back("G92" + per_axis([](const Motor&) { return 0.0; }));
  }

  template <class Value>
  std::string per_axis(const Value& value) const {
    std::string text;
    for (const Motor* motor : motors_) text += std::string(" ") + motor->axis + significant(value(*motor));
    return text;
  }

  [[nodiscard]] std::vector<double> position() const {
    std::vector<double> result;
    for (std::size_t i = 0; i < here_.size(); ++i)
      result.push_back(static_cast<double>(here_[i]) / motors_[i]->steps_per_mm);
    return result;
  }

  /// The length that Marlin takes a feed rate along.
  [[nodiscard]] double feed_length(const Steps& target) const {
    double primary = 0, secondary = 0;
    for (std::size_t i = 0; i < target.size(); ++i) {
      const double length = static_cast<double>(target[i] - here_[i]) / motors_[i]->steps_per_mm;
      const bool is_primary = std::string("XYZ").find(motors_[i]->axis) != std::string::npos;
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
                         ": use fewer axes, or more mm of cable or plunger per mm of axis (steps_per_mm)");
    program_.lines.push_back({std::move(text), patience, position(), row});
  }

  [[nodiscard]] double longest_ahead() const {
    const std::ptrdiff_t count = std::min(moves_ahead, durations_.size());
    return count == 0 ? 0 : *std::max_element(durations_.end() - count, durations_.end());
  }
  [[nodiscard]] double drain() const {
    double sum = 0;
    for (std::size_t i = durations_.size() - std::min(moves_ahead, durations_.size()); i < durations_.size(); ++i)
      sum += durations_[i];
    return sum;
  }

  const Machine& machine_;
  const std::vector<const Motor*> motors_;
  const Motion& motion_;
  GcodeProgram program_;
  Steps here_;
  std::vector<double> durations_;  // [s]
  double rest_left_ = 0;           // [s]
};

std::string gear_text(const char* kind, const char* what, const Motor& motor) {
  return std::string("; ") + motor.axis + ": " + kind + " '" + motor.name + "', " + significant(motor.axis_mm_per_mm) +
         " mm of axis per mm of " + what + ", " + significant(motor.steps_per_mm) + " steps per mm of axis\n";
}

}  // namespace

GcodeProgram make_gcode(const Machine& machine, const Motion& motion) {
  return Writer(machine, motion).write();
}

std::string gcode_text(const Machine& machine, const GcodeProgram& program) {
  std::string text = "; Before this program the motors stand at home: cables at their length at rest plus slack.\n";
  for (const Tendon& tendon : machine.tendons) text += gear_text("tendon", "cable", tendon);
  if (!machine.syringes.empty())
    text += "; Home of a plunger: its chamber at rest, the air under the pressure around it.\n";
  for (const Syringe& syringe : machine.syringes) text += gear_text("syringe", "plunger", syringe);
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
      const bool known = commands.pressure_known[chamber.actuator];
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
  take_curve_pressures(model, plan.commands);
  plan.machine = assemble(model, hardware, plan.commands);
  plan.schedule = plan_pressures(plan.machine, plan.commands);
  if (!plan.has_motors()) return plan;
  plan.motion = plan_motion(plan.machine, plan.commands, return_home);
  plan.program = make_gcode(plan.machine, plan.motion);
  return plan;
}

std::pair<double, double> pressure_range(const Plan& plan, std::size_t chamber) {
  const auto [low, high] =
      std::minmax_element(plan.schedule.rows.begin(), plan.schedule.rows.end(),
                          [chamber](const auto& a, const auto& b) { return a.kpa[chamber] < b.kpa[chamber]; });
  return {low->kpa[chamber], high->kpa[chamber]};
}

}  // namespace softkin::drive
