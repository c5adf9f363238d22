#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <softkin/drive/plan.hpp>

#include "drive_samples.hpp"

namespace softkin::drive {
namespace {

using testing::two_commands;
using testing::two_motors;
using testing::two_tendons;

constexpr double step_mm = 1.0 / 80;

/// What a board makes of a program: where its axes are and when, read from the text alone.
struct Arrival {
  double time_s = 0;
  std::map<char, double> position;
  std::size_t row = 0;
};

/// The length that Marlin takes a feed rate along.
double feed_length(const std::map<char, double>& from, const std::map<char, double>& to) {
  for (const std::string group : {"XYZ", "UVW", "ABC"}) {
    double sum = 0;
    for (const auto& [axis, value] : to)
      if (group.find(axis) != std::string::npos) sum += std::pow(value - from.at(axis), 2);
    if (sum > 0) return std::sqrt(sum);
  }
  return 0;
}

/// Arrivals from the first row on; axes at constant speed.
std::vector<Arrival> simulate(const GcodeProgram& program, const Motion& motion) {
  Arrival here;
  for (const char axis : program.axes) here.position[axis] = 0;
  std::vector<Arrival> arrivals;
  bool runs = motion.approach.empty();
  for (const GcodeLine& line : program.lines) {
    if (line.text == "M400") runs = true;
    if (line.text.rfind("G4 P", 0) == 0) here.time_s += std::stod(line.text.substr(4)) / 1000;
    if (line.text.rfind("G1 ", 0) == 0) {
      std::map<char, double> target;
      double feed = 0;
      for (std::size_t i = 3; i < line.text.size(); i = line.text.find(' ', i) + 1) {
        (line.text[i] == 'F' ? feed : target[line.text[i]]) = std::stod(line.text.substr(i + 1));
        if (line.text.find(' ', i) == std::string::npos) break;
      }
      EXPECT_EQ(target.size(), program.axes.size());
      if (runs) here.time_s += feed_length(here.position, target) / (feed / 60);
      here.position = target;
    }
    here.row = line.row;
    if (runs && line.text != "M400") arrivals.push_back(here);
  }
  return arrivals;
}

struct Planned {
  Machine machine;
  Motion motion;
  GcodeProgram program;
};

Planned plan(const HardwareSpec& hardware, const Commands& commands, bool return_home = false) {
  Planned result{assemble(two_tendons(), hardware, commands), {}, {}};
  result.motion = plan_motion(result.machine, commands, return_home);
  result.program = make_gcode(result.machine, result.motion);
  return result;
}

void expect_refused(const HardwareSpec& hardware, const Commands& commands, const std::string& part) {
  try {
    (void)plan(hardware, commands);
    ADD_FAILURE() << "accepted; expected " << part;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

/// A random walk of both cables, at random times.
Commands random_walk(unsigned seed, std::size_t rows, double step) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> change(-step, step), time(0.2, 1.0);
  std::vector<std::array<double, 2>> ratios{{0.8, 0.7}};
  std::vector<double> times{3};
  for (std::size_t i = 1; i < rows; ++i) {
    ratios.push_back(ratios.back());
    for (double& ratio : ratios.back()) ratio = std::clamp(ratio + change(random), 0.5, 1.0);
    times.push_back(times.back() + time(random));
  }
  return two_commands(ratios, times);
}

TEST(Motion, ArrivesAtTheTimesOfTheRows) {
  for (const auto& [first, second] :
       {std::pair('X', 'Y'), std::pair('X', 'A'), std::pair('A', 'B'), std::pair('Z', 'U')}) {
    HardwareSpec hardware = two_motors();
    hardware.tendons[0].axis = first;
    hardware.tendons[1].axis = second;
    hardware.tendons[1].drum_radius_mm = 4;
    hardware.tendons[1].steps_per_mm = 400;
    hardware.tendons[0].backlash_mm = 0.4;
    Commands commands = random_walk(7, 300, 0.05);
    for (std::size_t row = 100; row < 110; ++row) commands.rows[row].actuation[0] = commands.rows[99].actuation[0];
    for (std::size_t row = 120; row < 125; ++row) commands.rows[row].actuation = commands.rows[119].actuation;
    const Planned planned = plan(hardware, commands);
    const auto arrivals = simulate(planned.program, planned.motion);
    ASSERT_GT(arrivals.size(), 280u);
    for (const Arrival& arrival : arrivals) {
      const double requested = *commands.rows[arrival.row - 2].time_s - *commands.rows[0].time_s;
      EXPECT_NEAR(arrival.time_s, requested, 1e-3) << "row " << arrival.row;  // G4 takes whole ms
    }
    EXPECT_NEAR(planned.motion.seconds, *commands.rows.back().time_s - *commands.rows[0].time_s, 1e-9);
  }
}

/// Marlin's own planner: each move a trapezoid, its corners as fast as both moves allow, without jerk.
double planner_seconds(const std::vector<double>& lengths, const std::vector<double>& feeds, double acceleration) {
  const std::size_t count = lengths.size();
  std::vector<double> corner(count + 1, 0.0);
  for (std::size_t i = 1; i < count; ++i)
    if (lengths[i - 1] * lengths[i] > 0) corner[i] = std::min(feeds[i - 1], feeds[i]);
  for (std::size_t i = count; i-- > 0;)
    corner[i] = std::min(corner[i], std::sqrt(std::pow(corner[i + 1], 2) + 2 * acceleration * std::abs(lengths[i])));
  double seconds = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double length = std::abs(lengths[i]), in = corner[i];
    corner[i + 1] = std::min(corner[i + 1], std::sqrt(in * in + 2 * acceleration * length));
    const double out = corner[i + 1];
    const double top = std::min(feeds[i], std::sqrt((2 * acceleration * length + in * in + out * out) / 2));
    const double ramps = (2 * top * top - in * in - out * out) / (2 * acceleration);
    seconds += (2 * top - in - out) / acceleration + (length - ramps) / top;
  }
  return seconds;
}

TEST(Motion, RampsDelayLittle) {
  std::vector<std::array<double, 2>> ratios;
  std::vector<double> times;
  for (int i = 0; i <= 200; ++i) {
    times.push_back(0.05 * i);
    ratios.push_back({0.75 - 0.2 * std::cos(2 * std::numbers::pi * times.back() / 5), 1});
  }
  const Planned planned = plan(two_motors(), two_commands(ratios, times));
  std::vector<double> lengths, feeds;
  double here = planned.motion.approach.empty() ? 0 : static_cast<double>(planned.motion.approach[0].target[0]);
  for (const Move& move : planned.motion.moves) {
    lengths.push_back((static_cast<double>(move.target[0]) - here) * step_mm);
    feeds.push_back(std::abs(lengths.back()) / move.seconds);
    here = static_cast<double>(move.target[0]);
  }
  ASSERT_TRUE(std::all_of(feeds.begin(), feeds.end(), [](double feed) { return feed > 0; }));
  const double late = planner_seconds(lengths, feeds, 500) - 10;
  EXPECT_GE(late, 0);
  EXPECT_LT(late, 0.06);  // 10 s, a top speed of 10 mm/s, 500 mm/s^2
}

/// A drum with play: the cable follows the motor at the end of the play alone.
struct Play {
  double play, cable = 0;
  void turn_to(double motor) { cable = std::clamp(cable, motor, motor + play); }
};

TEST(Motion, CableEndsAtTheRightPlaceInSpiteOfBacklash) {
  HardwareSpec hardware = two_motors();
  hardware.tendons[0].backlash_mm = 0.6;
  hardware.tendons[1].backlash_mm = 1.1;
  hardware.tendons[0].direction = -1;
  hardware.tendons[1].drum_radius_mm = 5;
  hardware.tendons[0].slack_offset_mm = 1.5;
  const Commands commands = random_walk(11, 500, 0.03);
  const Planned planned = plan(hardware, commands);
  Play a{0.6}, b{1.1};
  const double b_mm = 2 * std::numbers::pi * 5 / 3200 * 80;  // cable per mm of axis
  const auto arrivals = simulate(planned.program, planned.motion);
  const auto& approach = planned.program.lines[0].position;
  a.turn_to(-approach[0]);
  b.turn_to(approach[1] * b_mm);
  for (const Arrival& arrival : arrivals) {
    a.turn_to(-arrival.position.at('X'));
    b.turn_to(arrival.position.at('Y') * b_mm);
    const CommandRow& row = commands.rows[arrival.row - 2];
    // half a step; a row whose moves were put off is less than 6 steps away
    EXPECT_NEAR(a.cable, 40 * (1 - row.actuation[0]) + 1.5, 6.5 * step_mm) << "row " << row.line;
    EXPECT_NEAR(b.cable, 60 * (1 - row.actuation[1]), 6.5 * b_mm * step_mm) << "row " << row.line;
  }
  EXPECT_NEAR(a.cable, 40 * (1 - commands.rows.back().actuation[0]) + 1.5, 0.51 * step_mm);
  EXPECT_NEAR(b.cable, 60 * (1 - commands.rows.back().actuation[1]), 0.51 * b_mm * step_mm);
}

TEST(Motion, ReversalsCostTheBacklash) {
  HardwareSpec hardware = two_motors();
  hardware.tendons[0].backlash_mm = 0.5;
  const Planned planned =
      plan(hardware, two_commands({{0.9, 1}, {0.8, 1}, {0.9, 1}, {0.95, 1}, {0.9, 1}}, {0, 1, 2, 3, 4}));
  std::vector<std::int64_t> steps{planned.motion.approach.at(0).target[0]};
  for (const Move& move : planned.motion.moves) steps.push_back(move.target[0]);
  // wound up: 4, 8, 4, 2, 4 mm; where it pays out the motor is 0.5 mm behind
  EXPECT_EQ(steps, (std::vector<std::int64_t>{320, 640, 280, 120, 320}));
}

TEST(Motion, RefusesWhatIsOutsideTheLimits) {
  HardwareSpec hardware = two_motors();
  hardware.tendons[0].length_limits_mm = {{24, 38}};
  hardware.tendons[1].max_speed_mm_per_s = 6;
  hardware.tendons[1].max_acceleration_mm_per_s2 = 20;
  const auto refused = [&](const std::vector<std::array<double, 2>>& ratios, const std::vector<double>& times,
                           const std::string& part) { expect_refused(hardware, two_commands(ratios, times), part); };
  refused({{0.9, 1}, {0.59, 1}}, {0, 1},
          "commands.csv:3: tendon 'a': length 23.6 mm (ratio 0.59 of 40 mm) is below its limit of 24 mm "
          "(hardware.yaml:3)");
  refused({{0.96, 1}}, {}, "commands.csv:2: tendon 'a': length 38.4 mm (ratio 0.96 of 40 mm) is above its limit of 38");
  refused({{0.9, 1}, {0.9, 0.9}, {0.9, 0.79}}, {0, 1, 2},
          "commands.csv:4: tendon 'b': 6.6 mm/s to reach this row is above its limit of 6 mm/s (hardware.yaml:4)");
  refused({{0.9, 1}, {0.9, 0.95}}, {0, 0.51}, "a change of speed by 5.88235 mm/s on the way to this row takes");
  refused({{0.9, 1}, {0.9, 0.98}, {0.9, 0.98}, {0.9, 0.985}}, {0, 1, 1.01, 1.11}, "above its limit of 20 mm/s^2");
  // at the limits themselves
  hardware.tendons[1].max_acceleration_mm_per_s2 = 12;
  EXPECT_NO_THROW((void)plan(hardware, two_commands({{0.95, 1}, {0.6, 0.9}}, {0, 1})));
  hardware.tendons[1].backlash_mm = 0.1;  // the motor has to be faster than the cable where it turns back
  EXPECT_NO_THROW((void)plan(hardware, two_commands({{0.9, 0.9}, {0.9, 0.8}}, {0, 1})));
  refused({{0.9, 0.9}, {0.9, 1}}, {0, 1}, "commands.csv:3: tendon 'b': 6.1 mm/s to reach this row");
}

/// Checks that a refusal about cable a (24 to 38 mm, 4 mm/s) is true of the rows.
void expect_reason(const Commands& commands, const std::string& message) {
  if (message.find("tendon 'a'") == std::string::npos) return;
  ASSERT_EQ(message.rfind("commands.csv:", 0), 0u) << message;
  const std::size_t row = std::stoul(message.substr(13)) - 2;
  const double length = 40 * commands.rows[row].actuation[0];
  if (message.find("length") != std::string::npos) {
    EXPECT_TRUE(length < 24 || length > 38) << message;
    return;
  }
  const double before = 40 * commands.rows[row - 1].actuation[0];
  EXPECT_GT(std::abs(length - before) / (*commands.rows[row].time_s - *commands.rows[row - 1].time_s), 4) << message;
}

TEST(Motion, NothingThatIsAcceptedLeavesTheLimits) {
  HardwareSpec hardware = two_motors();
  hardware.tendons[0].length_limits_mm = {{24, 38}};
  hardware.tendons[0].max_speed_mm_per_s = 4;
  hardware.tendons[1].max_acceleration_mm_per_s2 = 30;
  hardware.tendons[1].backlash_mm = 0.2;
  int accepted = 0, refused = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const Commands commands = random_walk(seed, 2 + seed % 9, 0.01 + 0.0005 * seed);
    try {
      const Planned planned = plan(hardware, commands);
      ++accepted;
      Arrival before;
      before.position = {{'X', planned.program.lines[0].position[0]}, {'Y', planned.program.lines[0].position[1]}};
      for (const Arrival& arrival : simulate(planned.program, planned.motion)) {
        const double length = 40 - arrival.position.at('X');
        ASSERT_TRUE(length > 24 - step_mm && length < 38 + step_mm);
        const double seconds = arrival.time_s - before.time_s;
        ASSERT_LT(std::abs(arrival.position.at('X') - before.position.at('X')), 4 * seconds + 7 * step_mm);
        before = arrival;
      }
    } catch (const InvalidInput& error) {
      ++refused;
      expect_reason(commands, error.what());
    }
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(refused, 50);
}

TEST(Motion, HoldsAndTinyMovesKeepTheTime) {
  std::vector<std::array<double, 2>> ratios{{1, 1}, {0.9, 1}, {0.9, 1}, {0.9, 1}};
  std::vector<double> times{0, 1, 2.5, 4};
  for (int i = 1; i <= 40; ++i) {  // 0.01 mm, less than a step, in each
    ratios.push_back({0.9 - 0.00025 * i, 1});
    times.push_back(4 + 0.1 * i);
  }
  const Planned planned = plan(two_motors(), two_commands(ratios, times));
  EXPECT_EQ(planned.program.lines[1].text, "G4 P3000");
  EXPECT_EQ(planned.program.lines[1].patience_s, 4);
  std::int64_t here = 0;
  for (std::size_t i = 0; i + 1 < planned.motion.moves.size(); ++i) {
    const std::int64_t there = planned.motion.moves[i].target[0];
    EXPECT_TRUE(there == here || std::abs(there - here) >= 6) << i;
    here = there;
  }
  EXPECT_EQ(planned.motion.moves.back().target[0], 352);  // 4.4 mm
  const auto arrivals = simulate(planned.program, planned.motion);
  EXPECT_NEAR(arrivals.back().time_s, 8, 1e-6);
}

TEST(Motion, WithoutTimesMovesTakeAsLongAsTheyNeed) {
  HardwareSpec hardware = two_motors();
  hardware.approach_speed_mm_per_s = 3;
  const Planned planned = plan(hardware, two_commands({{0.9, 1}, {0.6, 0.9}, {0.6, 0.9}, {0.62, 0.9}}), true);
  ASSERT_EQ(planned.motion.approach.size(), 1u);
  EXPECT_NEAR(planned.motion.approach[0].seconds, 4.0 / 3, 1e-9);
  ASSERT_EQ(planned.motion.moves.size(), 2u);
  EXPECT_NEAR(planned.motion.moves[0].seconds, 12.0 / 3, 1e-9);  // the farther one of 12 and 6 mm
  EXPECT_FALSE(planned.motion.timed);
  ASSERT_EQ(planned.motion.back.size(), 1u);
  EXPECT_EQ(planned.motion.back[0].target, (Steps{0, 0}));
}

TEST(Motion, GoesBackHomeWithTheBacklashTakenUp) {
  HardwareSpec hardware = two_motors();
  hardware.tendons[0].backlash_mm = 0.5;
  const Planned planned = plan(hardware, two_commands({{0.9, 1}}, {0}), true);
  ASSERT_EQ(planned.motion.back.size(), 2u);
  EXPECT_EQ(planned.motion.back[0].target, (Steps{-40, 0}));  // the cable is at its rest length
  EXPECT_EQ(planned.motion.back[1].target, (Steps{0, 0}));    // and the motor too
  EXPECT_TRUE(planned.motion.moves.empty());
}

TEST(Gcode, IsWhatMarlinReads) {
  HardwareSpec hardware = two_motors();
  hardware.tendons[1].drum_radius_mm = 50 / std::numbers::pi;  // 100 mm of cable in a turn: 32 steps a mm
  const Planned planned = plan(hardware, two_commands({{1, 1}, {0.9, 0.95}, {0.9, 0.95}}, {0, 2, 3.5}));
  EXPECT_EQ(planned.program.setup, (std::vector<std::string>{"G21", "G90", "M92 X80 Y80", "M201 X500 Y200",
                                                             "M203 X50 Y20", "M211 S0", "M84 S0", "G92 X0 Y0"}));
  ASSERT_EQ(planned.program.lines.size(), 2u);
  EXPECT_EQ(planned.program.lines[0].text, "G1 X4 Y1.2 F125.2837");  // 60 * sqrt(4^2 + 1.2^2) / 2
  EXPECT_EQ(planned.program.lines[1].text, "G4 P1500");
  EXPECT_EQ(planned.program.lines[0].row, 3u);
  const std::string text = gcode_text(planned.machine, planned.program);
  EXPECT_NE(text.find("G92 X0 Y0\nG1 X4 Y1.2 F125.2837\nG4 P1500\nM400\n"), std::string::npos) << text;
  hardware.configure = false;
  EXPECT_EQ(plan(hardware, two_commands({{1, 1}}, {0})).program.setup,
            (std::vector<std::string>{"G21", "G90", "G92 X0 Y0"}));
}

}  // namespace
}  // namespace softkin::drive
