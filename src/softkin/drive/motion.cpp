#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/drive/motion.hpp>

namespace softkin::drive {

namespace {

constexpr std::int64_t fewest_steps = 6;  // MIN_STEPS_PER_SEGMENT of Marlin
constexpr double shortest_s = 0.1;
constexpr double no_move_mm = 1e-9;       // of cable or plunger: rounding of ratios
constexpr double slack_of_limits = 1e-9;  // relative

using Motors = std::vector<const Motor*>;

/// Where the motors stand, in mm of cable or plunger from home, backlash included.
class Stand {
 public:
  explicit Stand(const Motors& motors) : motors_(motors), moved_(motors.size(), 0.0), loose_(motors.size(), 0.0) {}

  /// Motors for these places of cables and plungers, from where they stand; they stand there afterwards.
  const std::vector<double>& go_to(const std::vector<double>& places) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double change = places[i] - moved_[i];
      if (std::abs(change) <= no_move_mm) continue;
      loose_[i] = change > 0 ? 0 : motors_[i]->backlash_mm;
      moved_[i] = places[i];
    }
    here_.resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) here_[i] = moved_[i] - loose_[i];
    return here_;
  }

 private:
  const Motors& motors_;
  std::vector<double> moved_, loose_, here_;
};

Steps to_steps(const Motors& motors, const std::vector<double>& places) {
  Steps steps;
  for (std::size_t i = 0; i < places.size(); ++i) steps.push_back(std::llround(motors[i]->steps(places[i])));
  return steps;
}

/// Puts off moves that a board would drop.
class Merger {
 public:
  Merger(Steps start, std::vector<Move>& moves) : given_(start), emitted_(std::move(start)), moves_(moves) {}

  /// holds: cables and plungers are to stay where they are, to the last digit.
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
      : machine_(machine),
        commands_(commands),
        motors_(machine.motors()),
        stand_(motors_),
        here_(motors_.size(), 0.0) {}

  Motion plan(bool return_home) {
    Motion motion;
    motion.timed = commands_.rows.front().time_s.has_value();
    const Steps home(motors_.size(), 0);
    approach(home, motion.approach);
    Merger merger(motion.approach.empty() ? home : motion.approach.back().target, motion.moves);
    for (std::size_t row = 1; row < commands_.rows.size(); ++row) add_row(row, merger);
    merger.finish();
    check_acceleration(commands_.rows.back(), speeds_, std::vector<double>(speeds_.size(), 0.0), last_seconds_ / 2,
                       "the stop after");
    for (const Move& move : motion.moves) motion.seconds += move.seconds;
    if (return_home) {
      const Steps end = to_steps(motors_, here_);
      go_free(std::vector<double>(motors_.size(), 0.0), 0, end, motion.back);
      // from home cables are wound up and plungers pushed: leave the backlash as it was found
      const bool loose = !motion.back.empty() && motion.back.back().target != home;
      if (loose) motion.back.push_back({home, free_seconds(std::vector<double>(home.size(), 0.0)), 0});
    }
    return motion;
  }

 private:
  [[nodiscard]] std::string kind_of(std::size_t motor) const {
    return motor < machine_.tendons.size() ? "tendon" : "syringe";
  }
  [[noreturn]] void fail(const CommandRow& row, std::size_t motor, const std::string& message) const {
    throw InvalidInput({commands_.file, row.line}, kind_of(motor) + " '" + motors_[motor]->name + "': " + message +
                                                       " (" + motors_[motor]->origin.text() + ")");
  }

  /// What a row asks of every motor, in mm of cable or plunger from home.
  [[nodiscard]] std::vector<double> places(const CommandRow& row) const {
    std::vector<double> result;
    for (const Tendon& tendon : machine_.tendons) result.push_back(wound(row, tendon, result.size()));
    for (const Syringe& syringe : machine_.syringes) result.push_back(pushed(row, syringe, result.size()));
    return result;
  }

  [[nodiscard]] double wound(const CommandRow& row, const Tendon& tendon, std::size_t motor) const {
    const double length = row.actuation[tendon.actuator] * tendon.rest_length_mm;
    const bool low = length < tendon.shortest_mm * (1 - slack_of_limits);
    if (low || length > tendon.longest_mm * (1 + slack_of_limits))
      fail(row, motor,
           "length " + number(length) + " mm (ratio " + number(row.actuation[tendon.actuator]) + " of " +
               number(tendon.rest_length_mm) + " mm) is " + (low ? "below" : "above") + " its limit of " +
               number(low ? tendon.shortest_mm : tendon.longest_mm) + " mm");
    return tendon.wound_mm(length);
  }

  [[nodiscard]] double pushed(const CommandRow& row, const Syringe& syringe, std::size_t motor) const {
    const double command = row.actuation[syringe.actuator], gauge_kpa = row.pressures_kpa[syringe.actuator];
    if (!syringe.by_pushed_mL) check_pressure(row, syringe, motor, gauge_kpa);
    const double place =
        syringe.by_pushed_mL ? 1000 * command / syringe.mm3_per_mm : syringe.plunger_mm(command, gauge_kpa);
    const double slack = slack_of_limits * std::max(std::abs(syringe.lowest_mm), std::abs(syringe.highest_mm));
    const bool low = place < syringe.lowest_mm - slack;
    if (low || !(place <= syringe.highest_mm + slack) || !std::isfinite(place))
      fail(row, motor,
           "plunger " + number(place, 6) + " mm from home (" +
               (syringe.by_pushed_mL ? number(command, 6) + " mL pushed"
                                     : "ratio " + number(command, 6) + " at " + number(gauge_kpa, 6) + " kPa") +
               ") is " + (low ? "below" : "above") + " its limit of " +
               number(low ? syringe.lowest_mm : syringe.highest_mm, 6) + " mm");
    return place;
  }

  void check_pressure(const CommandRow& row, const Syringe& syringe, std::size_t motor, double gauge_kpa) const {
    if (gauge_kpa <= -syringe.air.atmosphere_kPa)
      fail(row, motor,
           "pressure " + number(gauge_kpa, 6) + " kPa (gauge) is not above vacuum, which is " +
               number(-syringe.air.atmosphere_kPa, 6) + " kPa");
    if (!syringe.limits_kpa) return;
    const auto [least, most] = *syringe.limits_kpa;
    if (gauge_kpa < least || gauge_kpa > most)
      fail(row, motor,
           "pressure " + number(gauge_kpa, 6) + " kPa is " + (gauge_kpa < least ? "below" : "above") +
               " its limit of " + number(gauge_kpa < least ? least : most, 6) + " kPa");
  }

  /// Time that motors need to a place without a given time: at the approach speed, and within the accelerations.
  [[nodiscard]] double free_seconds(const std::vector<double>& places) const {
    double seconds = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Motor& motor = *motors_[i];
      const double distance = std::abs(places[i] - here_[i]);
      const double speed = std::min(machine_.approach_speed_mm_per_s, motor.max_speed_mm_per_s);
      seconds = std::max({seconds, distance / speed, std::sqrt(2 * distance / motor.max_acceleration_mm_per_s2)});
    }
    return seconds;
  }

  void go_free(const std::vector<double>& target, std::size_t line, const Steps& from, std::vector<Move>& moves) {
    const std::vector<double> places = stand_.go_to(target);
    const Steps steps = to_steps(motors_, places);
    if (steps != from) moves.push_back({steps, free_seconds(places), line});
    here_ = places;
  }

  void approach(const Steps& home, std::vector<Move>& moves) {
    const CommandRow& first = commands_.rows.front();
    go_free(places(first), first.line, home, moves);
    speeds_.assign(machine_.tendons.size(), 0.0);
  }

  void add_row(std::size_t index, Merger& merger) {
    const CommandRow& row = commands_.rows[index];
    const std::vector<double> there = stand_.go_to(places(row));
    const double seconds = row.time_s ? *row.time_s - *commands_.rows[index - 1].time_s : free_seconds(there);
    std::vector<double> speeds(there.size(), 0.0);
    if (seconds > 0)
      for (std::size_t i = 0; i < there.size(); ++i) speeds[i] = (there[i] - here_[i]) / seconds;
    for (std::size_t i = 0; i < there.size(); ++i) {
      const double most = motors_[i]->max_speed_mm_per_s;
      if (std::abs(speeds[i]) > most * (1 + slack_of_limits))
        fail(row, i,
             number(std::abs(speeds[i])) + " mm/s to reach this row is above its limit of " + number(most) + " mm/s");
    }
    check_acceleration(row, speeds_, speeds, (last_seconds_ + seconds) / 2, "the way to");
    merger.add(to_steps(motors_, there), there == here_, seconds, row.line);
    speeds_ = speeds;
    last_seconds_ = seconds;
    here_ = there;
  }

  void check_acceleration(const CommandRow& row, const std::vector<double>& before, const std::vector<double>& after,
                          double seconds, const std::string& where) const {
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double most = motors_[i]->max_acceleration_mm_per_s2;
      const double change = std::abs(after[i] - before[i]);
      if (change <= most * seconds * (1 + slack_of_limits)) continue;
      fail(row, i,
           "a change of speed by " + number(change) + " mm/s on " + where + " this row takes " +
               number(change / seconds) + " mm/s^2, above its limit of " + number(most) + " mm/s^2");
    }
  }

  const Machine& machine_;
  const Commands& commands_;
  Motors motors_;
  Stand stand_;
  std::vector<double> here_;    // motors [mm of cable or plunger]
  std::vector<double> speeds_;  // of the last row's move [mm/s]
  double last_seconds_ = 0;     // of the last row's move
};

}  // namespace

Motion plan_motion(const Machine& machine, const Commands& commands, bool return_home) {
  return Planner(machine, commands).plan(return_home);
}

}  // namespace softkin::drive
