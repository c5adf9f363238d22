#include <gtest/gtest.h>

#include <numbers>
#include <softkin/drive/marlin_answer.hpp>
#include <softkin/drive/marlin_link.hpp>

#include "drive_samples.hpp"
#include "faulty_marlin.hpp"

namespace softkin::drive {
namespace {

using testing::FaultyMarlin;
using testing::LineFaults;

/// Returns a program of moves within the limits of the machine; successive moves differ.
GcodeProgram sample_program(std::size_t moves) {
  std::vector<std::array<double, 2>> ratios;
  std::vector<double> times;
  for (std::size_t i = 0; i <= moves; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    ratios.push_back({0.75 + 0.2 * std::cos(0.9 * t), 0.75 + 0.2 * std::cos(0.7 * t)});
    times.push_back(t);
  }
  const Commands commands = testing::two_commands(ratios, times);
  const Machine machine = assemble(testing::two_tendons(), testing::two_motors(), commands);
  GcodeProgram program = make_gcode(machine, plan_motion(machine, commands, false));
  for (GcodeLine& line : program.lines) line.patience_s = 0;  // the board of the tests needs no time to move
  program.drain_s = 0;
  return program;
}

/// So short that what is lost costs little.
LinkOptions quick_options() {
  LinkOptions options;
  options.timeout_s = 0.002;
  options.quiet_s = 0.0004;
  options.boot_s = 0;
  options.attempts = 400;
  options.checkpoint_lines = 64;
  return options;
}

/// The places that the program leads to, each different from the one before.
std::vector<FaultyMarlin::Position> expected_motions(const GcodeProgram& program) {
  std::vector<FaultyMarlin::Position> motions;
  std::vector<double> here = program.start;
  for (const GcodeLine& line : program.lines) {
    if (line.position == here) continue;
    here = line.position;
    motions.emplace_back();
    for (std::size_t i = 0; i < here.size(); ++i) motions.back()[program.axes[i]] = here[i];
  }
  return motions;
}

/// Are the first `count` motions those of the program, in order, each once?
void expect_prefix(const FaultyMarlin& board, const GcodeProgram& program, std::size_t count) {
  const auto expected = expected_motions(program);
  ASSERT_LE(count, expected.size());
  for (std::size_t i = 0; i < count; ++i)
    for (const auto& [axis, value] : expected[i])
      ASSERT_NEAR(board.motions()[i].at(axis), value, 1e-5) << "motion " << i << " of axis " << axis;
}

StreamReport stream_to(FaultyMarlin& board, const GcodeProgram& program, const LinkOptions& options,
                       const LinkHooks& hooks = {}) {
  StreamReport report;
  {
    SerialPort port(board.port(), 115200);
    report = stream(port, program, options, hooks);
  }
  board.end();
  return report;
}

TEST(MarlinLink, HundredThousandLinesOverABadLine) {
  LineFaults faults;
  faults.fraction = 0.01;
  const GcodeProgram program = sample_program(102'000);
  ASSERT_GE(program.lines.size(), 100'000u);
  FaultyMarlin board(faults);
  const auto begin = std::chrono::steady_clock::now();
  const StreamReport report = stream_to(board, program, quick_options());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  std::printf("%zu lines in %.1f s: %ld faults, %ld lines refused, %zu asked for again, %zu timeouts\n", report.lines,
              seconds.count(), board.faults_made(), board.refused(), report.resends, report.timeouts);
  EXPECT_EQ(report.end, StreamEnd::finished) << report.message;
  EXPECT_TRUE(report.position_known);
  EXPECT_EQ(report.acknowledged, program.lines.size());
  EXPECT_GT(board.faults_made(), 1500);
  EXPECT_GT(board.refused(), 500);
  EXPECT_EQ(board.motions().size(), expected_motions(program).size());
  expect_prefix(board, program, board.motions().size());
  for (const auto& position : board.motions()) {  // 0.5 to 1 of 40 and 60 mm
    ASSERT_TRUE(position.at('X') >= -0.01 && position.at('X') <= 20.01);
    ASSERT_TRUE(position.at('Y') >= -0.01 && position.at('Y') <= 30.01);
  }
}

TEST(MarlinLink, CleanLineNeedsEachLineOnce) {
  const GcodeProgram program = sample_program(500);
  for (const bool advanced : {false, true}) {
    LineFaults faults;
    faults.advanced_ok = advanced;
    FaultyMarlin board(faults);
    LinkOptions options = quick_options();
    options.timeout_s = 5;
    const StreamReport report = stream_to(board, program, options);
    EXPECT_EQ(report.end, StreamEnd::finished) << report.message;
    EXPECT_EQ(report.resends + report.timeouts, 0u);
    EXPECT_EQ(board.refused(), 0);
    // M110, the setup, every line, and M400; M114 before and after
    EXPECT_EQ(board.executed().size(), 1 + program.setup.size() + program.lines.size() + 3);
    EXPECT_EQ(board.executed().back(), "M114");
    ASSERT_EQ(report.position.size(), 2u);
    EXPECT_NEAR(report.position[0], board.motions().back().at('X'), 1e-5);
  }
}

TEST(MarlinLink, AnotherMakersWordsAreUnderstood) {
  const GcodeProgram program = sample_program(60);
  LineFaults faults;
  faults.other_words = true;
  faults.refuse_once = 10002;  // of the set-up
  FaultyMarlin board(faults);
  LinkOptions options = quick_options();
  options.timeout_s = 5;
  options.quiet_s = 0.01;
  const StreamReport report = stream_to(board, program, options);
  EXPECT_EQ(report.end, StreamEnd::finished) << report.message;
  EXPECT_TRUE(report.position_known);
  EXPECT_EQ(board.refused(), 1);
  EXPECT_EQ(report.resends, 1u);
  const auto begins = [](const std::string& command) { return command.starts_with("M110"); };
  EXPECT_EQ(std::count_if(board.executed().begin(), board.executed().end(), begins), 1);
  EXPECT_EQ(board.motions().size(), expected_motions(program).size());

  faults.refuse_once = 10020;  // while it moves
  FaultyMarlin again(faults);
  const StreamReport moving = stream_to(again, program, options);
  EXPECT_EQ(moving.end, StreamEnd::finished) << moving.message;
  EXPECT_EQ(again.motions().size(), expected_motions(program).size());
}

TEST(MarlinLink, WorseLinesOfAllKinds) {
  const GcodeProgram program = sample_program(400);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    LineFaults faults;
    faults.fraction = 0.08;
    faults.seed = seed;
    faults.busy = 0.01;
    faults.ok_after_resend = seed % 3 / 2.0;
    faults.advanced_ok = seed % 2 == 0;
    FaultyMarlin board(faults);
    const StreamReport report = stream_to(board, program, quick_options());
    expect_prefix(board, program, board.motions().size());
    EXPECT_EQ(report.end, StreamEnd::finished) << "seed " << seed << ": " << report.message;
    EXPECT_EQ(board.motions().size(), expected_motions(program).size()) << "seed " << seed;
  }
}

TEST(MarlinLink, RebootEndsTheStreamAndMovesNothingMore) {
  const GcodeProgram program = sample_program(300);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    LineFaults faults;
    faults.fraction = 0.02;
    faults.seed = seed;
    faults.silent_reboot = seed % 2 == 0;
    faults.reboot_after_moves = 20 * seed;
    FaultyMarlin board(faults);
    const StreamReport report = stream_to(board, program, quick_options());
    EXPECT_EQ(report.end, StreamEnd::rebooted) << "seed " << seed << ": " << report.message;
    EXPECT_FALSE(report.position_known);
    EXPECT_NE(report.message.find("position is unknown"), std::string::npos) << report.message;
    EXPECT_EQ(board.motions().size(), static_cast<std::size_t>(faults.reboot_after_moves));
    EXPECT_EQ(board.motions().size(), board.motions_before_boot());
    expect_prefix(board, program, board.motions().size());
    EXPECT_GE(report.sent, board.motions().size());
  }
}

TEST(MarlinLink, StopsByOrderWithTheLastMoveDone) {
  const GcodeProgram program = sample_program(2000);
  FaultyMarlin board;
  LinkHooks hooks;
  hooks.order = [&board] { return board.moves() < 50 ? Order::go : Order::stop; };
  const StreamReport report = stream_to(board, program, quick_options(), hooks);
  EXPECT_EQ(report.end, StreamEnd::stopped);
  EXPECT_TRUE(report.position_known);
  EXPECT_EQ(report.acknowledged, report.sent);
  EXPECT_LT(board.motions().size(), 60u);
  EXPECT_GE(board.motions().size(), 50u);
  expect_prefix(board, program, board.motions().size());
  EXPECT_NEAR(report.position[0], board.motions().back().at('X'), 1e-5);
  EXPECT_NEAR(program.lines[report.acknowledged - 1].position[0], board.motions().back().at('X'), 1e-5);
}

TEST(MarlinLink, PausesAndGoesOn) {
  const GcodeProgram program = sample_program(100);
  FaultyMarlin board;
  int requested = 0;
  long at_pause = -1, after_pause = -1;
  LinkHooks hooks;
  hooks.order = [&] {
    if (board.moves() < 30 || requested >= 10) return Order::go;
    if (requested++ == 2) at_pause = board.moves();  // the line in flight has ended by now
    if (requested == 10) after_pause = board.moves();
    return Order::pause;
  };
  const StreamReport report = stream_to(board, program, quick_options(), hooks);
  EXPECT_EQ(report.end, StreamEnd::finished);
  EXPECT_GE(at_pause, 30);
  EXPECT_EQ(at_pause, after_pause);
  EXPECT_EQ(board.motions().size(), expected_motions(program).size());
}

TEST(MarlinLink, QuickStopLosesThePosition) {
  const GcodeProgram program = sample_program(2000);
  FaultyMarlin board;
  LinkHooks hooks;
  hooks.order = [&board] { return board.moves() < 50 ? Order::go : Order::quick_stop; };
  StreamReport report;
  {
    SerialPort port(board.port(), 115200);
    report = stream(port, program, quick_options(), hooks);
    for (int i = 0; i < 1000 && board.moves() == 0; ++i) ::usleep(1000);
    ::usleep(20000);
  }
  board.end();
  EXPECT_EQ(report.end, StreamEnd::quick_stopped);
  EXPECT_FALSE(report.position_known);
  EXPECT_EQ(board.quick_stops(), 2);
  EXPECT_NE(report.message.find("position is unknown"), std::string::npos);
  EXPECT_LT(board.motions().size(), 60u);
}

TEST(MarlinLink, MuteBoardsEndTheStream) {
  const GcodeProgram program = sample_program(100);
  LinkOptions options = quick_options();
  options.attempts = 5;
  LineFaults faults;
  faults.mute_after_moves = 30;
  FaultyMarlin board(faults);
  const StreamReport report = stream_to(board, program, options);
  EXPECT_EQ(report.end, StreamEnd::no_answer);
  EXPECT_FALSE(report.position_known);
  EXPECT_EQ(board.motions().size(), 30u);
  EXPECT_EQ(report.acknowledged, 30u);  // approach, M400, then 28 moves; the next was executed, and nobody knows
  EXPECT_EQ(report.sent, 31u);

  LineFaults dead;
  dead.fraction = 1;
  FaultyMarlin noise(dead);
  options.attempts = 3;
  const StreamReport none = stream_to(noise, program, options);
  EXPECT_EQ(none.end, StreamEnd::no_answer);
  EXPECT_EQ(none.sent, 0u);
  EXPECT_TRUE(noise.motions().empty());
  EXPECT_NE(none.message.find("nothing was moved"), std::string::npos) << none.message;
}

TEST(MarlinLink, PulledCableEndsTheStream) {
  const GcodeProgram program = sample_program(50'000);
  FaultyMarlin board;
  StreamReport report;
  {
    SerialPort port(board.port(), 115200);
    std::thread hand([&board] {
      while (board.moves() < 100) ::usleep(500);
      board.unplug();
    });
    report = stream(port, program, quick_options());
    hand.join();
  }
  EXPECT_EQ(report.end, StreamEnd::port_lost) << report.message;
  EXPECT_FALSE(report.position_known);
  expect_prefix(board, program, board.motions().size());
}

TEST(MarlinLink, BoardsThatAreNotWhereTheyShouldBeAreNoticed) {
  const GcodeProgram program = sample_program(100);
  LinkOptions options = quick_options();
  options.timeout_s = 1;
  LineFaults endstops;
  endstops.clamp = [](double x) { return std::min(x, 5.0); };
  FaultyMarlin clamped(endstops);
  const StreamReport report = stream_to(clamped, program, options);
  EXPECT_EQ(report.end, StreamEnd::wrong_position);
  EXPECT_NE(report.message.find("the board reports X 5.00 mm instead of"), std::string::npos) << report.message;
  EXPECT_FALSE(report.position_known);

  LineFaults one_axis;
  one_axis.axes = "X";
  FaultyMarlin small(one_axis);
  const StreamReport missing = stream_to(small, program, options);
  EXPECT_EQ(missing.end, StreamEnd::wrong_position);
  EXPECT_NE(missing.message.find("the board has no axis Y, before anything was moved"), std::string::npos);
  EXPECT_TRUE(small.motions().empty());
}

TEST(MarlinLink, RefusesPorts) {
  const auto refused = [](const std::string& path, int baud, const std::string& part) {
    try {
      const SerialPort port(path, baud);
      ADD_FAILURE() << "accepted " << path;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused("/nowhere/tty", 115200, "port /nowhere/tty: No such file");
  refused("/dev/null", 115200, "port /dev/null: is no serial port");
}

TEST(MarlinLink, NumbersAndChecksums) {
  EXPECT_EQ(numbered_line(3, "T0"), "N3 T0*57");  // the example of the RepRap documentation
  const std::string line = numbered_line(10001, "G1 X1.5 F300");
  unsigned char all = 0;
  for (const char c : line.substr(0, line.find('*'))) all = static_cast<unsigned char>(all ^ c);
  EXPECT_EQ(line.substr(line.find('*') + 1), std::to_string(all));
}

TEST(MarlinAnswer, KnowsWhatMarlinSays) {
  using Kind = MarlinAnswer::Kind;
  const auto kind = [](const char* line) { return parse_answer(line).kind; };
  EXPECT_EQ(kind("ok"), Kind::ok);
  EXPECT_EQ(parse_answer("ok N123 P15 B3").number, 123);
  EXPECT_EQ(parse_answer("ok T:20.1 /0.0").number, std::nullopt);
  EXPECT_EQ(kind("okok"), Kind::other);
  const MarlinAnswer on_ok = parse_answer("ok X:1.50 Y:-2.00 Z:0.00 E:0.00 Count: A:120");
  EXPECT_EQ(on_ok.kind, Kind::ok);
  ASSERT_EQ(on_ok.position.size(), 4u);
  EXPECT_EQ(on_ok.position[1].second, -2);
  EXPECT_TRUE(parse_answer("ok X:1.50 Y:-2.0").position.size() == 2 && parse_answer("ok X:1.50 Y:").position.empty());
  EXPECT_EQ(kind("Error:something that nobody knows"), Kind::error);
  EXPECT_EQ(parse_answer("Resend: 12").number, 12);
  EXPECT_EQ(parse_answer("rs 12").number, 12);
  for (const char* line : {"Resend: ", "Resend: 1x", "Resend: -3", "Resend: 99999999999999999999"})
    EXPECT_EQ(kind(line), Kind::other) << line;
  EXPECT_EQ(kind("start"), Kind::started);
  EXPECT_EQ(kind("started"), Kind::other);
  EXPECT_EQ(kind("echo:busy: processing"), Kind::busy);
  EXPECT_EQ(kind("Error:Printer halted. kill() called!"), Kind::halted);
  EXPECT_EQ(parse_answer("Error:checksum mismatch, Last Line: 41").number, 41);
  const std::string error = "Error:Line Number is not Last Line Number+1, Last Line: 41";
  for (std::size_t i = 6; i < error.size(); ++i) {  // one damaged byte is no fault of the board
    std::string damaged = error;
    damaged[i] = '#';
    EXPECT_EQ(kind(damaged.c_str()), Kind::line_error) << damaged;
  }
  const MarlinAnswer position = parse_answer("X:1.50 Y:-2.00 Z:0.00 E:0.00 Count X:120 Y:-160 Z:0");
  EXPECT_EQ(position.kind, Kind::position);
  ASSERT_EQ(position.position.size(), 4u);
  EXPECT_EQ(position.position[1].first, 'Y');
  EXPECT_EQ(position.position[1].second, -2);
  for (const char* line : {"X:1.50 Y:-2.", "X:1.5x Y:2.0 Count X:1", "X: Count", "X:1.50Y:2.00 Count X:1",
                           "X:nan Count X:1", "X:1.50 Y:inf Count X:1"})
    EXPECT_EQ(kind(line), Kind::other) << line;
}

}  // namespace
}  // namespace softkin::drive
