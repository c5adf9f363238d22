#include <cmath>
#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

/// softkin ik --press: the force that a robot is to exert.

namespace {

using namespace softkin::testing;
using nlohmann::json;

const std::string plate_scene = SOFTKIN_SOURCE_DIR "/docs/scenes/actuator_under_plate.yaml";

ProgramResult run_press(const std::vector<std::string>& options, const std::string& scene = plate_scene) {
  std::vector<std::string> arguments{"ik", scene, "--threads", "1"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_program(arguments);
}

/// Forward kinematics along the commands of an answer.
json again(const json& step) {
  std::vector<std::string> options{"--json"};
  for (const auto& [name, actuator] : step.at("actuators").items()) {
    char value[40];
    std::snprintf(value, sizeof value, "%.15g", actuator.at("requested").get<double>());
    options.push_back("--set");
    options.push_back(name + "=" + value);
  }
  const ProgramResult result = run_fk(plate_scene, options);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return json::parse(result.output).at("steps").at(0);
}

TEST(IkPress, APlateIsPressedWhileTheTipStays) {
  const ProgramResult result = run_press({"--press", "plate=,,2", "--target", "tip=1,-0.5,", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(result.output), &ik = report.at("ik"), &step = report.at("steps").at(0);
  ASSERT_EQ(ik.at("goals").size(), 2u);
  const json& press = ik.at("goals").at(1);
  EXPECT_EQ(press.at("of"), "plate");
  EXPECT_EQ(press.at("kind"), "force");
  EXPECT_EQ(press.at("force_N"), json({nullptr, nullptr, 2}));
  EXPECT_NEAR(press.at("found_N").at(2).get<double>(), 2, 0.002);
  EXPECT_NEAR(press.at("mm_per_N").get<double>(), 0.5, 1e-12);
  EXPECT_LE(press.at("error_N").get<double>(), 0.002);
  EXPECT_FALSE(press.contains("error_mm"));
  EXPECT_LE(ik.at("error_mm").get<double>(), 1e-3);
  EXPECT_EQ(ik.at("error_N"), press.at("error_N"));
  const json found = again(step);
  ASSERT_EQ(found.at("contacts").size(), 1u);
  EXPECT_NEAR(found.at("contacts").at(0).at("force_N").at(2).get<double>(), -2, 0.02);  // on the robot
  EXPECT_NEAR(found.at("markers").at("tip").at(0).get<double>(), 1, 0.1);
  EXPECT_NEAR(found.at("markers").at("tip").at(1).get<double>(), -0.5, 0.1);
}

TEST(IkPress, TableTellsForces) {
  const ProgramResult result =
      run_press({"--press", "plate=,,2", "--tolerance-force", "0.01", "--weight", "plate=2", "--other-starts", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  for (const char* part : {"force on", "error [N]", "any any 2.0000 N", "reached: error at most 0.00"})
    EXPECT_NE(result.output.find(part), std::string::npos) << part << " is not in\n" << result.output;
  EXPECT_EQ(result.output.find("error [mm]"), std::string::npos) << result.output;
}

TEST(IkPress, SaysWhatIsOutOfReach) {
  const ProgramResult far = run_press({"--press", "plate=,,500", "--other-starts", "0"});
  EXPECT_EQ(far.exit_code, 1);
  for (const char* part : {"softkin: not reached: ", " N off at the nearest point", "end of its range"})
    EXPECT_NE(far.errors.find(part), std::string::npos) << part << " is not in " << far.errors;
  const ProgramResult pull = run_press({"--press", "plate=,,-2", "--other-starts", "0"});
  EXPECT_EQ(pull.exit_code, 1);
  EXPECT_NE(pull.errors.find("nothing touches 'plate' there"), std::string::npos) << pull.errors;
}

TEST(IkPress, RefusesBadInput) {
  const auto refused = [&](const std::vector<std::string>& options, const std::string& message,
                           const std::string& scene = plate_scene) {
    const ProgramResult result = run_press(options, scene);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_NE(result.errors.find(message), std::string::npos) << "no '" << message << "' in " << result.errors;
  };
  refused({"--press", "plat=,,2"}, "--press 'plat=,,2': no support, obstacle or body 'plat'; did you mean 'plate'?");
  refused({"--press", "plate=,,"}, "no component of it is given");
  refused({"--press", "plate=2,nan,"}, "expected three finite numbers in NAME=FX,FY,FZ in N");
  refused({"--press", "plate=,,2", "--map", "m.skmap"}, "does not go with --map");
  refused({"--press", "plate=,,2", "--tolerance-force", "0"}, "must be a force > 0");
  refused({"--target", "tip=1,2,3", "--tolerance-force", "1"}, "needs --press");
  refused({"--press", "base=2,,", "--formulation", "target-shape"}, "target",
          SOFTKIN_SOURCE_DIR "/examples/three_chamber_actuator/three_chamber_actuator.yaml");
}

}  // namespace
