#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// A block of rubber, and beside it a cube of 8 g on a floor of friction 0.4.
std::string cube_on_floor(const std::string& more = "") {
  return "softkin: 1\n"
         "mesh: {file: block.msh}\n"
         "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, density: 1000}]\n"
         "fixed: [{region: base}]\n"
         "gravity: [0, 0, -9.81]\n"
         "actuators: [{name: tendon, kind: cable, points: [[0, 6, 6], [20, 6, 6]], control: tension, range: [0, 5]}]\n"
         "contact: {distance: 0.05, friction: 0.4}\n"
         "obstacles: [{name: floor, halfspace: {point: [0, 0, -1.06], normal: [0, 0, 1]}}]\n"
         "bodies:\n"
         "  - {name: cube, box: [[40, 0, -1], [60, 20, 19]], density: 1000}\n" +
         more;
}

struct GraspFolder : BlockFolder {
  using BlockFolder::BlockFolder;

  [[nodiscard]] ProgramResult grasp(const std::vector<std::string>& options) const {
    std::vector<std::string> arguments{"grasp", scene, "--threads", "1"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments);
  }

  void expect_refused(const std::string& message, const std::vector<std::string>& options) const {
    const std::size_t before = files();
    const ProgramResult result = grasp(options);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_EQ(result.output, "") << message;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_NE(result.errors.find(message), std::string::npos) << "no '" << message << "' in " << result.errors;
    EXPECT_EQ(files(), before) << message;
  }
};

/// Along the floor Coulomb's limit, across it the weight.
TEST(GraspCommand, PullsUntilItSlipsOrLifts) {
  const GraspFolder folder(cube_on_floor());
  const std::string table = folder / "pulls.csv", image = folder / "grasp.png";
  const ProgramResult result =
      folder.grasp({"--pull", "x", "--pull", "0,-3,0", "--pull", "z", "--json", "--table", table, "--image", image});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json pulls = json::parse(result.output);
  ASSERT_EQ(pulls.size(), 3U);
  const double weight = 8e-3 * 9.81;
  EXPECT_NEAR(pulls[0].at("force_N").get<double>(), 0.4 * weight, 0.01 * 0.4 * weight);
  EXPECT_NEAR(pulls[1].at("force_N").get<double>(), 0.4 * weight, 0.01 * 0.4 * weight);
  EXPECT_NEAR(pulls[2].at("force_N").get<double>(), weight, 0.01 * weight);
  EXPECT_EQ(pulls[0].at("end"), "slips");
  EXPECT_TRUE(std::filesystem::exists(image));
  EXPECT_TRUE(read_text(table).starts_with("direction,force_N,moved_mm,normal_N,slipping,end\nx,")) << read_text(table);
}

/// What a pull of the shipped gripper came to.
struct Pull {
  double force = 0, moved = 0, normal = 0;
};

/// Pulls along x what a scene of the shipped gripper has between its fingers.
Pull pulled(const std::string& scene) {
  const TemporaryFolder folder;
  const std::string shape = folder / "grasp.vtu", table = folder / "pulls.csv";
  const ProgramResult result =
      run_program({"grasp", SOFTKIN_SOURCE_DIR "/examples/two_finger_gripper/" + scene, "--set", "left.air=1.15",
                   "--set", "right.air=1.15", "--pull", "x", "--threads", "1", "--table", table, "-o", shape});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  for (const char* stage : {"closing: ", "releasing '", "pull along"})
    EXPECT_NE(result.output.find(stage), std::string::npos) << result.output;
  EXPECT_TRUE(std::filesystem::exists(shape));
  const std::string pulls = read_text(table), row = pulls.substr(pulls.find("\nx,") + 3);
  Pull pull;
  EXPECT_EQ(std::sscanf(row.c_str(), "%lf,%lf,%lf", &pull.force, &pull.moved, &pull.normal), 3) << pulls;
  return pull;
}

/// The number that docs/contact.md has after these words.
double documented(const std::string& words) {
  const std::string text = read_text(SOFTKIN_SOURCE_DIR "/docs/contact.md");
  const std::size_t at = text.find(words);
  return at == std::string::npos ? 0 : std::strtod(text.c_str() + at + words.size(), nullptr);
}

/// The results agree with Coulomb's law and with the document.
TEST(GraspCommand, ACubeIsHeldUntilItSlips) {
  const Pull pull = pulled("two_finger_gripper.yaml");
  const double weight = 0.027 * 9.81;
  EXPECT_NEAR(pull.force, 0.5 * pull.normal - weight, 0.01 * pull.force);
  EXPECT_NEAR(pull.force, documented("the cube is held up to "), 0.002 * pull.force);
}

/// A ball between two fingers: without an end before, as it flew off in every try beyond the largest pull. Coulomb's
/// law at the places where the fingers touch it, their normals tilted by the angle at which they stand on the ball.
TEST(GraspCommand, ABallIsHeldUntilItSlips) {
  const Pull pull = pulled("ball.yaml");
  const double tilt = std::asin(5.4 / 15), weight = 0.01412 * 9.81;  // where they touch, below the ball's middle
  const double all_slips = pull.normal * (0.5 * std::cos(tilt) + std::sin(tilt)) - weight;
  EXPECT_LT(pull.force, 1.02 * all_slips);
  EXPECT_GT(pull.force, 0.93 * all_slips);
  EXPECT_NEAR(pull.force, documented("which holds it, too, up to "), 0.002 * pull.force);
  EXPECT_GT(pull.moved, 0);
}

TEST(GraspCommand, ABodyThatNothingHoldsIsTold) {
  const GraspFolder folder(replaced(cube_on_floor(), "-1.06", "-900"));
  const ProgramResult result = folder.grasp({});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("'cube' is not held when it is released"), std::string::npos) << result.errors;
}

TEST(GraspCommand, WhatIsNotRightIsRefused) {
  const GraspFolder folder(cube_on_floor());
  folder.expect_refused("--pull must be x, -x, y, -y, z, -z or DX,DY,DZ that are not all 0, not 'up'",
                        {"--pull", "up"});
  folder.expect_refused("--body: there is no body 'cub'; did you mean 'cube'?", {"--body", "cub"});
  folder.expect_refused("must be a force > 0 in N, not 0", {"--most", "0"});
  folder.expect_refused("--table", {"--table", "pulls.txt"});
  folder.expect_refused("no actuator 'cube_hol'; did you mean 'cube_hold'?", {"--set", "cube_hol=0"});
  const GraspFolder two(cube_on_floor("  - {name: ball, sphere: {center: [100, 0, 20], radius: 5}}\n"));
  two.expect_refused("--body: there are 2 bodies, cube, ball: say which one is pulled", {});
}

}  // namespace
