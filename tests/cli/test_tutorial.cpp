#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <softkin/io/table/csv.hpp>

#include "run_program.hpp"
#include "support/skips.hpp"

namespace softkin {
namespace {

using nlohmann::json;
using testing::ProgramResult;
using testing::read_text;
using testing::run_program;
using testing::run_shell;
using testing::shell_quoted;
using testing::TemporaryFolder;

const std::string example = std::string(SOFTKIN_SOURCE_DIR) + "/examples/three_tendon_finger/";
const std::string scene = example + "three_tendon_finger.yaml";

// three_tendon_finger.hardware.yaml, by hand
constexpr double drum_mm = 6, steps_per_turn = 3200, slack_mm = 2, play_mm = 0.3, rest_mm = 34;
constexpr double cable_mm_per_step = 2 * std::numbers::pi * drum_mm / steps_per_turn;
constexpr std::array<double, 3> steps_per_mm{80, 80, 400};
const std::array<std::string, 3> tendons{"tendon1", "tendon2", "tendon3"};

// circle.csv, by hand
constexpr std::size_t count = 25;
constexpr double radius_mm = 8, seconds = 12;

/// x and z [mm]
std::array<double, 2> target(std::size_t waypoint) {
  const double angle = 2 * std::numbers::pi * static_cast<double>(waypoint) / (count - 1);
  return {76 + radius_mm * std::sin(angle), 66 + radius_mm * std::cos(angle)};
}

// the camera of the tutorial
constexpr double turn_degrees = 4, right_mm = 20, up_mm = 35, sigma_mm = 0.05;

/// What a rigid alignment in the plane leaves of noise of sigma in each coordinate: it fits 3 of 2 count numbers.
double noise_rms(double sigma) {
  return sigma * std::sqrt(2 * (1 - 3.0 / (2 * count)));
}

/// Lengths of vectors of two normal numbers follow Rayleigh's distribution.
double mean_of_rms(double rms) {
  return rms * std::sqrt(std::numbers::pi) / 2;
}
constexpr double rayleigh_spread = 0.523;  // standard deviation over mean

std::vector<double> column(const CsvTable& table, const std::string& name) {
  const auto found = std::find(table.columns.begin(), table.columns.end(), name);
  EXPECT_NE(found, table.columns.end()) << "no column " << name;
  std::vector<double> values;
  for (const auto& row : table.rows) values.push_back(row.at(found - table.columns.begin()));
  return values;
}

/// The number behind a letter of a line of G-code.
double word_of(const std::string& line, char letter) {
  return std::stod(line.substr(line.find(std::string(" ") + letter) + 2));
}

/// One run of the tutorial, up to the camera, for all tests.
class Tutorial : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    run({"follow", scene, example + "circle.csv", "-o", file("")});
    run({"drive", scene, file("commands.csv"), "--dry-run", "--gcode", file("finger.gcode")});
    awk("motors.awk", "", "finger.gcode", "cables.csv");
    run({"fk", scene, "--path", file("cables.csv"), "--report", file("robot.json")});
    steps_ = compared("robot.json", {"-o", file("robot.csv")});
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string file(const std::string& name) { return *folder_ / ("out/" + name); }

  static std::string run(const std::vector<std::string>& arguments) {
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments.front() << ": " << result.errors;
    return result.output;
  }

  static void awk(const std::string& script, const std::string& settings, const std::string& from,
                  const std::string& to, const std::string& program = "awk") {
    const std::string command = program + " " + settings + " -f " + shell_quoted(example + "simulated/" + script) +
                                " " + shell_quoted(file(from)) + " >" + shell_quoted(file(to));
    ASSERT_EQ(run_shell(command).exit_code, 0) << command;
  }

  /// Those of the tutorial's scripts by this awk and by the system's.
  static void expect_same_files(const std::string& program) {
    awk("camera.awk", "-v seed=1", "robot.csv", "track.csv");
    awk("motors.awk", "", "finger.gcode", "other_cables.csv", program);
    EXPECT_EQ(read_text(file("other_cables.csv")), read_text(file("cables.csv"))) << program;
    awk("camera.awk", "-v seed=1", "robot.csv", "other_track.csv", program);
    EXPECT_EQ(read_text(file("other_track.csv")), read_text(file("track.csv"))) << program;
  }

  /// The track of that name beside the predicted path.
  static json compared(const std::string& name, std::vector<std::string> options) {
    options.insert(options.begin(), {"compare", file("report.json"), file(name), "--json"});
    const std::string output = run(options);
    return output.empty() ? json() : json::parse(output)["tracks"][0];
  }

  /// The camera of the tutorial with these settings, beside the predicted path.
  static json filmed(const std::string& settings, std::vector<std::string> more = {}) {
    awk("camera.awk", settings, "robot.csv", "track.csv");
    more.insert(more.end(), {"--plane", "xz", "--align"});
    return compared("track.csv", more);
  }

  /// Of camera and whole steps together [mm].
  static double expected_mean(double sigma = sigma_mm) {
    return mean_of_rms(std::hypot(noise_rms(sigma), steps_["rms_mm"].get<double>()));
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static json steps_;  // what whole steps of the motors cost
};

std::unique_ptr<TemporaryFolder> Tutorial::folder_;
json Tutorial::steps_;

TEST_F(Tutorial, EveryWaypointIsReached) {
  const CsvTable errors = read_csv(file("errors.csv"));
  const std::vector<double> x = column(errors, "tip_x_mm"), z = column(errors, "tip_z_mm");
  ASSERT_EQ(errors.rows.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_LT(column(errors, "error_mm")[i], 1e-3) << i;
    EXPECT_EQ(column(errors, "reached")[i], 1) << i;
    EXPECT_LT(std::hypot(x[i] - target(i)[0], z[i] - target(i)[1]), 1e-3 + 1e-4) << i << ": the file has 4 decimals";
  }
}

TEST_F(Tutorial, TheLastMoveWindsUpTheCablesOfTheLastRow) {
  std::string last;
  std::istringstream program(read_text(file("finger.gcode")));
  for (std::string line; std::getline(program, line);)
    if (line.starts_with("G1 ")) last = line;
  const CsvTable commands = read_csv(file("commands.csv"));
  ASSERT_EQ(commands.rows.size(), count);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double> ratio = column(commands, tendons[i]);
    const bool pays_out = ratio[count - 1] > ratio[count - 2];
    const double motor_mm = slack_mm + rest_mm * (1 - ratio[count - 1]) - (pays_out ? play_mm : 0);
    const double steps = std::round(motor_mm / cable_mm_per_step);
    EXPECT_NEAR(word_of(last, "XYZ"[i]), steps / steps_per_mm[i], 1e-5) << last;
  }
}

TEST_F(Tutorial, MotorsLeaveCablesWithinHalfAStepAndOnTime) {
  const CsvTable commands = read_csv(file("commands.csv")), cables = read_csv(file("cables.csv"));
  ASSERT_EQ(cables.rows.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_NEAR(column(cables, "t_s")[i], seconds * static_cast<double>(i) / (count - 1), 1e-4);
    for (const std::string& tendon : tendons) {
      const double off_mm = rest_mm * std::abs(column(cables, tendon)[i] - column(commands, tendon)[i]);
      EXPECT_LE(off_mm, cable_mm_per_step / 2 + 1e-6) << tendon << ", row " << i;
    }
  }
  // tendons 1 and 2 move the tip by up to some mm per mm of cable
  EXPECT_GT(steps_["mean_mm"].get<double>(), 0.1 * cable_mm_per_step);
  EXPECT_LT(steps_["largest_mm"].get<double>(), 10 * cable_mm_per_step);
}

TEST_F(Tutorial, TheErrorIsThatOfTheNoise) {
  constexpr int films = 20;
  double means = 0;
  for (int seed = 1; seed <= films; ++seed) {
    const json track = filmed("-v seed=" + std::to_string(seed));
    const double mean = track["mean_mm"].get<double>(), largest = track["largest_mm"].get<double>();
    // four standard errors; of 20 times 25 the largest is above 4.8 or below 1.4 sigma in one run of 200
    EXPECT_NEAR(mean / expected_mean(), 1, 4 * rayleigh_spread / std::sqrt(count)) << "seed " << seed;
    EXPECT_GT(largest, 1.4 * sigma_mm) << "seed " << seed;
    EXPECT_LT(largest, 4.8 * sigma_mm) << "seed " << seed;
    EXPECT_EQ(track["error_mm"].size(), count);
    EXPECT_EQ(track["axes"], "xz");
    means += mean / films;
  }
  EXPECT_NEAR(means / expected_mean(), 1, 4 * rayleigh_spread / std::sqrt(films * count));
}

TEST_F(Tutorial, TheNoiseIsNormalInBothCoordinatesAndFromFrameToFrame) {
  awk("camera.awk", "-v fps=3000", "robot.csv", "noisy.csv");
  awk("camera.awk", "-v fps=3000 -v sigma_mm=0", "robot.csv", "quiet.csv");
  const CsvTable noisy = read_csv(file("noisy.csv")), quiet = read_csv(file("quiet.csv"));
  ASSERT_EQ(noisy.rows.size(), 36001u);
  const auto noise = [&](std::size_t row, std::size_t axis) {
    return (noisy.rows[row][axis + 1] - quiet.rows[row][axis + 1]) / sigma_mm;
  };
  const double frames = 36000;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double squares = 0, together = 0, in_row = 0, within_one = 0, within_two = 0;
    for (std::size_t row = 0; row < 36000; ++row) {
      const double n = noise(row, axis);
      squares += n * n / frames;
      together += n * noise(row, 1 - axis) / frames;
      in_row += n * noise(row + 1, axis) / frames;
      within_one += (std::abs(n) < 1 ? 1 : 0) / frames;
      within_two += (std::abs(n) < 2 ? 1 : 0) / frames;
    }
    EXPECT_NEAR(squares, 1, 0.03);  // four standard errors
    EXPECT_NEAR(together, 0, 0.021);
    EXPECT_NEAR(in_row, 0, 0.021);
    EXPECT_NEAR(within_one, 0.6827, 0.01);
    EXPECT_NEAR(within_two, 0.9545, 0.0045);
  }
}

TEST_F(Tutorial, TheAlignmentFindsTheCamera) {
  const json track = filmed("-v sigma_mm=0");
  const json& rotation = track["rotation"];
  const double angle = std::atan2(rotation[2][0].get<double>(), rotation[0][0].get<double>()) * 180 / std::numbers::pi;
  EXPECT_NEAR(angle, turn_degrees, 0.05);
  EXPECT_NEAR(track["translation_mm"][0].get<double>(), right_mm, 0.1);
  EXPECT_NEAR(track["translation_mm"][2].get<double>(), up_mm, 0.1);
  EXPECT_NEAR(track["mean_mm"].get<double>() / steps_["mean_mm"].get<double>(), 1, 0.25) << "the steps remain";
}

TEST_F(Tutorial, AScaleThatIsOffBy3PercentIsSeen) {
  double x = 0, z = 0, off = 0;
  for (std::size_t i = 0; i < count; ++i) {
    x += target(i)[0] / count;
    z += target(i)[1] / count;
  }
  for (std::size_t i = 0; i < count; ++i) off += 0.03 * std::hypot(target(i)[0] - x, target(i)[1] - z) / count;
  EXPECT_NEAR(off, 0.24, 0.001);
  EXPECT_NEAR(filmed("-v sigma_mm=0 -v scale=1.03")["mean_mm"].get<double>(), off, 0.01);
  for (int seed = 1; seed <= 5; ++seed) {
    const json track = filmed("-v scale=1.03 -v seed=" + std::to_string(seed));
    EXPECT_NEAR(track["mean_mm"].get<double>(), off, 0.05) << seed;
    EXPECT_GT(track["mean_mm"].get<double>(), 3 * expected_mean()) << seed;
  }
}

TEST_F(Tutorial, OnACircleADelayLooksLikeATurn) {
  constexpr double delay_s = 0.1, turn = 360 / seconds * delay_s;  // [degrees]
  constexpr double unaligned_mm = 2 * std::numbers::pi * radius_mm / seconds * delay_s;
  const json track = filmed("-v sigma_mm=0", {"--start", std::to_string(delay_s)});
  const json& rotation = track["rotation"];
  const double angle = std::atan2(rotation[2][0].get<double>(), rotation[0][0].get<double>()) * 180 / std::numbers::pi;
  EXPECT_NEAR(std::abs(angle - turn_degrees), turn, 0.2);
  EXPECT_LT(track["mean_mm"].get<double>(), 0.25 * unaligned_mm);
}

TEST_F(Tutorial, MawkMakesTheSameFiles) {
  SKIP_WITHOUT_PROGRAM("mawk");
  expect_same_files("mawk");
}

TEST_F(Tutorial, GawkMakesTheSameFiles) {
  SKIP_WITHOUT_PROGRAM("gawk");
  expect_same_files("gawk");
  expect_same_files("gawk --posix");
}

TEST_F(Tutorial, OriginalAwkMakesTheSameFiles) {
  SKIP_WITHOUT_PROGRAM("original-awk");
  expect_same_files("original-awk");
}

}  // namespace
}  // namespace softkin
