#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/core/text.hpp>
#include <softkin/drive/motion.hpp>

namespace softkin::drive {

namespace {

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

Motion plan_motion(const Machine& machine, const Commands& commands, bool return_home) {
  return Planner(machine, commands).plan(return_home);
}

}  // namespace softkin::drive
