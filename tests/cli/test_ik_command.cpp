#include <cmath>
#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;
using Point = std::array<double, 3>;

ProgramResult run_ik(const std::string& scene, const std::vector<std::string>& options) {
  std::vector<std::string> arguments{"ik", scene, "--threads", "1"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_program(arguments);
}

/// The only step of a report on standard output.
json step_of(const ProgramResult& result) {
  return json::parse(result.output).at("steps").at(0);
}

std::string digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.15g", value);
  return text;
}

std::string coordinates(const Point& p) {
  return digits(p[0]) + "," + digits(p[1]) + "," + digits(p[2]);
}

double distance(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// The block with a chamber and a tendon.
struct IkFolder : BlockFolder {
  explicit IkFolder(const std::string& text = physical_scene()) : BlockFolder(text) {}

  /// By forward kinematics.
  [[nodiscard]] json pose(const std::vector<std::pair<std::string, double>>& settings) const {
    std::vector<std::string> options{"--json", "--solver-tolerance", "1e-9"};
    for (const auto& [name, value] : settings) {
      options.push_back("--set");
      options.push_back(name + "=" + digits(value));
    }
    const ProgramResult result = run_fk(scene, options);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return step_of(result);
  }
  [[nodiscard]] Point marker(const std::string& name, double air, double tendon) const {
    return pose({{"air", air}, {"tendon", tendon}}).at("markers").at(name);
  }
};

TEST(IkCommand, ReachesWhereForwardKinematicsWas) {
  const IkFolder folder;
  const Point target = folder.marker("tip", 1.4, 0.94);
  const ProgramResult result = run_ik(folder.scene, {"--target", "tip=" + coordinates(target), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  const json report = json::parse(result.output), &step = report.at("steps").at(0), &ik = report.at("ik");
  EXPECT_TRUE(ik.at("reached").get<bool>());
  EXPECT_EQ(ik.at("status"), "reached");
  EXPECT_LE(step.at("error_mm").get<double>(), 1e-3);
  EXPECT_EQ(ik.at("history").at("error_mm").size(), ik.at("equilibria").get<std::size_t>());
  const json &air = step.at("actuators").at("air"), &tendon = step.at("actuators").at("tendon");
  const Point found = folder.marker("tip", air.at("requested"), tendon.at("requested"));
  EXPECT_LT(distance(found, target), 1.01e-3);
  EXPECT_NEAR(distance(found, target), step.at("error_mm").get<double>(), 1e-5);
  EXPECT_TRUE(air.contains("pressure_kPa"));
  EXPECT_TRUE(tendon.contains("tension_N"));
}

TEST(IkCommand, TableHasUnitsAndErrors) {
  const IkFolder folder;
  const Point target = folder.marker("tip", 1.4, 0.94);
  const ProgramResult result =
      run_ik(folder.scene, {"--target", "tip=" + digits(target[0]) + ",," + digits(target[2]), "-o", folder / "s.vtu",
                            "--report", folder / "r.json", "--plot", folder / "p.svg"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  for (const char* part : {"actuator", "range", "0.5 to 3", "[-]", " kPa", " any ", "error [mm]",
                           "reached: error at most", "equilibria", "output: ", "report: ", "plot: "})
    EXPECT_NE(result.output.find(part), std::string::npos) << part << " is not in\n" << result.output;
  EXPECT_NE(read_text(folder / "s.vtu").find("displacement_mm"), std::string::npos);
  EXPECT_NE(read_text(folder / "p.svg").find("largest error [mm]"), std::string::npos);
  const json goal = json::parse(read_text(folder / "r.json")).at("ik").at("goals").at(0);
  EXPECT_TRUE(goal.at("target_mm").at(1).is_null());
  EXPECT_NEAR(goal.at("target_mm").at(0).get<double>(), target[0], 1e-12);
}

TEST(IkCommand, SaysWhatIsOutOfReach) {
  const IkFolder folder;
  const ProgramResult result =
      run_ik(folder.scene, {"--target", "tip=40,6,6", "--report", folder / "r.json", "-o", folder / "s.vtu"});
  EXPECT_EQ(result.exit_code, 1);
  for (const char* part :
       {"softkin: not reached: ", "mm off at the nearest point", "air is at the high end of its range, 3"})
    EXPECT_NE(result.errors.find(part), std::string::npos) << part << " is not in " << result.errors;
  EXPECT_NE(result.output.find("not reached: error at most"), std::string::npos) << result.output;
  const json ik = json::parse(read_text(folder / "r.json")).at("ik");
  EXPECT_FALSE(ik.at("reached").get<bool>());
  EXPECT_EQ(ik.at("status"), "not reached");
  EXPECT_EQ(ik.at("at_end_of_range").at("air"), "high");
  EXPECT_LT(ik.at("slope_mm_per_range").get<double>(), 1e-3);
  EXPECT_GT(ik.at("error_mm").get<double>(), 1);
  EXPECT_NE(read_text(folder / "s.vtu"), "");
}

TEST(IkCommand, JacobianEqualsDifferences) {
  const IkFolder folder;
  const Point target = folder.marker("tip", 1.4, 0.94);
  const ProgramResult result =
      run_ik(folder.scene, {"--target", "tip=" + coordinates(target), "--json", "--solver-tolerance", "1e-9"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(result.output), &jacobian = report.at("ik").at("jacobian");
  const json& found = report.at("steps").at(0).at("actuation");
  EXPECT_EQ(jacobian.at("unit").at("air"), "mm per unit of ratio");
  constexpr double reach = 1e-4;
  for (const std::string name : {"air", "tendon"}) {
    const auto beside = [&](double change) {
      return folder.pose({{"air", found.at("air").get<double>() + (name == "air" ? change : 0)},
                          {"tendon", found.at("tendon").get<double>() + (name == "tendon" ? change : 0)}});
    };
    const json high = beside(reach), low = beside(-reach);
    for (const char* marker : {"tip", "corner"})
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double change =
            (high["markers"][marker][axis].get<double>() - low["markers"][marker][axis].get<double>()) / (2 * reach);
        EXPECT_NEAR(jacobian.at("markers").at(marker).at(name).at(axis).get<double>(), change,
                    1e-4 * (1 + std::abs(change)));
      }
    const double pressure = (high["actuators"]["air"]["pressure_kPa"].get<double>() -
                             low["actuators"]["air"]["pressure_kPa"].get<double>()) /
                            (2 * reach);
    EXPECT_NEAR(jacobian.at("pressure_kPa").at("air").at(name).get<double>(), pressure, 1e-3 * std::abs(pressure));
  }
}

TEST(IkCommand, PlanesDirectionsAndWeights) {
  const IkFolder folder;
  const Point tip = folder.marker("tip", 1.4, 0.94), corner = folder.marker("corner", 1.4, 0.94);
  const Point line{corner[0] - tip[0], corner[1] - tip[1], corner[2] - tip[2]};
  const ProgramResult result =
      run_ik(folder.scene, {"--plane", "tip=" + coordinates({tip[0] + 3, tip[1], tip[2]}) + "/0,0,2", "--direction",
                            "tip:corner=" + coordinates(line), "--weight", "tip=3", "--lever", "5", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json goals = json::parse(result.output).at("ik").at("goals");
  ASSERT_EQ(goals.size(), 2u);
  EXPECT_EQ(goals[0].at("kind"), "plane");
  EXPECT_EQ(goals[0].at("weight"), 3);
  EXPECT_NEAR(goals[0].at("found_mm").at(2).get<double>(), tip[2], 1e-3);
  EXPECT_EQ(goals[1].at("of"), "tip:corner");
  EXPECT_EQ(goals[1].at("lever_mm"), 5);
  const double length = std::hypot(line[0], line[1], line[2]);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(goals[1].at("found").at(axis).get<double>(), line[axis] / length, 1e-3 / 5);
}

TEST(IkCommand, StartsPrefersAndFixes) {
  const IkFolder folder;
  const Point target = folder.marker("tip", 1.4, 0.94);
  const std::vector<std::string> height{"--target", "tip=,," + digits(target[2]), "--json"};
  const auto found = [&](std::vector<std::string> more) {
    more.insert(more.end(), height.begin(), height.end());
    const ProgramResult result = run_ik(folder.scene, more);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    const json step = step_of(result);
    EXPECT_NEAR(step.at("markers").at("tip").at(2).get<double>(), target[2], 1e-3);
    return step.at("actuation");
  };
  EXPECT_EQ(found({"--fix", "air=1.3"}).at("air"), 1.3);
  EXPECT_NEAR(found({"--fix", "tendon=0.94"}).at("air").get<double>(), 1.4, 1e-2);
  const json near = found({"--prefer", "air=1.4", "--prefer", "tendon=0.94"});
  EXPECT_NEAR(near.at("air").get<double>(), 1.4, 5e-3);
  EXPECT_NEAR(near.at("tendon").get<double>(), 0.94, 2e-3);
  const json from = found({"--start", "air=1.4", "--start", "tendon=0.94"});
  EXPECT_NEAR(from.at("air").get<double>(), 1.4, 5e-3);
}

TEST(IkCommand, GradientMethodReachesItsTolerance) {
  const IkFolder folder;
  const Point target = folder.marker("tip", 1.3, 0.97);
  const ProgramResult result =
      run_ik(folder.scene, {"--target", "tip=" + coordinates(target), "--method", "gradient", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json ik = json::parse(result.output).at("ik");
  EXPECT_EQ(ik.at("tolerance_mm"), 0.2);
  EXPECT_LE(ik.at("error_mm").get<double>(), 0.2);
  EXPECT_FALSE(ik.contains("jacobian"));
}

TEST(IkCommand, StartsFromTheNearestSampleOfAWorkspace) {
  const IkFolder folder;
  const Point target = folder.marker("tip", 1.4, 0.94);
  const std::string samples = folder / "samples.csv";
  const ProgramResult made =
      run_program({"workspace", folder.scene, "--samples", "16", "-o", samples, "--threads", "1"});
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  const auto first_error = [&](const std::vector<std::string>& more) {
    std::vector<std::string> options{"--target", "tip=" + coordinates(target), "--json"};
    options.insert(options.end(), more.begin(), more.end());
    const ProgramResult result = run_ik(folder.scene, options);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output).at("ik").at("history").at("error_mm").at(0).get<double>();
  };
  EXPECT_LT(first_error({"--workspace", samples}), first_error({}));
}

TEST(IkCommand, WarnsOfOtherUnits) {
  const IkFolder folder;
  const ProgramResult far = run_ik(folder.scene, {"--target", "tip=20000,6000,6000"});
  EXPECT_EQ(far.exit_code, 1);
  EXPECT_NE(far.errors.find("softkin: warning: target of 'tip': "), std::string::npos) << far.errors;
  EXPECT_NE(far.errors.find("another unit than mm?"), std::string::npos) << far.errors;
  const ProgramResult metres = run_ik(folder.scene, {"--target", "tip=0.02,0.006,0.006"});
  EXPECT_NE(metres.errors.find("if the coordinates were in metres: are they?"), std::string::npos) << metres.errors;
  const ProgramResult near = run_ik(folder.scene, {"--target", "tip=20.1,6,6"});
  EXPECT_EQ(near.errors.find("warning"), std::string::npos) << near.errors;
}

TEST(IkCommand, RefusesBadInput) {
  const IkFolder folder;
  const auto refused = [&](const std::vector<std::string>& options, const std::string& message) {
    const std::size_t before = folder.files();
    const ProgramResult result = run_ik(folder.scene, options);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_EQ(result.output, "") << message;
    EXPECT_EQ(result.errors.rfind("softkin: ", 0), 0u) << result.errors;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_NE(result.errors.find(message), std::string::npos) << "no '" << message << "' in " << result.errors;
    EXPECT_EQ(folder.files(), before) << message;
  };
  const auto target = [&](const std::string& text, const std::string& message) {
    refused({"--target", text}, "--target '" + text + "': " + message);
  };
  refused({}, "nothing to reach");
  target("tpi=1,2,3", "no marker 'tpi'; did you mean 'tip'?");
  target("tip=nan,2,3", "expected three finite numbers");
  target("tip=1,inf,3", "expected three finite numbers");
  target("tip=1,2", "expected three finite numbers");
  target("tip=1,2,3,4", "expected three finite numbers");
  target("tip=1,2,3mm", "expected three finite numbers");
  target("tip=,,", "no coordinate of it is given");
  target("tip", "expected MARKER=X,Y,Z");
  target("=1,2,3", "expected MARKER=X,Y,Z");
  refused({"--plane", "tip=1,2,3"}, "expected a point in mm and a normal");
  refused({"--plane", "tip=1,2,3/0,0,0"}, "is zero");
  refused({"--plane", "tip=1,,3/0,0,1"}, "expected three finite numbers");
  refused({"--direction", "tip=1,2,3"}, "expected two markers");
  refused({"--direction", "tip:cornre=1,2,3"}, "did you mean 'corner'?");
  refused({"--direction", "tip:tip=1,2,3"}, "in one place at rest");
  refused({"--direction", "tip:corner=0,0,0"}, "is zero");
  const std::vector<std::string> good{"--target", "tip=20,6,6"};
  const auto also = [&](std::vector<std::string> more, const std::string& message) {
    more.insert(more.begin(), good.begin(), good.end());
    refused(more, message);
  };
  also({"--weight", "corner=2"}, "nothing is requested of 'corner'");
  also({"--weight", "tip=0"}, "a finite number > 0");
  also({"--weight", "tip=-1"}, "a finite number > 0");
  also({"--start", "air=4"}, "--start 'air=4': the ratio is outside its range, 0.5 to 3 [-]");
  also({"--prefer", "air=0.1"}, "outside its range");
  also({"--fix", "ari=1"}, "no actuator 'ari'; did you mean 'air'?");
  also({"--fix", "air=1", "--start", "air=1"}, "takes no --start");
  also({"--fix", "air=1", "--prefer", "air=1"}, "takes no --prefer");
  also({"--start", "air=1", "--workspace", "w.csv"}, "does not go with --start");
  also({"--workspace", folder / "none.csv"}, "none.csv");
  also({"--lever", "3"}, "needs --direction");
  also({"--descents", "3"}, "needs --method gradient");
  also({"--tolerance", "0"}, "must be a length > 0");
  also({"--method", "bfgs"}, "--method");
  also({"--max-equilibria", "0"}, "must be an integer from 1");
  also({"-o", "shape.pvd"}, "must end in .vtu");
  also({"--plot", "p.png"}, "must end in .svg");
  also({"--report", folder.scene}, "must end in .json");
}

TEST(IkCommand, ReachesWhereItLeansOnABall) {
  const std::string scene = SOFTKIN_SOURCE_DIR "/docs/scenes/actuator_on_ball.yaml";
  const ProgramResult made = run_fk(scene, {"--set", "air1=1.57", "--set", "air2=1.53", "--set", "air3=1.1", "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  const Point target = step_of(made).at("markers").at("tip");
  ASSERT_EQ(step_of(made).at("contacts").at(0).at("by"), "ball");
  const ProgramResult result = run_ik(scene, {"--target", "tip=" + coordinates(target), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_LT(distance(step_of(result).at("markers").at("tip"), target), 1e-3);
  EXPECT_EQ(step_of(result).at("contacts").at(0).at("by"), "ball");
  EXPECT_EQ(json::parse(result.output).at("ik").at("jacobian").at("one_sided"), json::array());
}

/// Regression test: the report once had no step and no residual, as if nothing had been solved.
TEST(IkCommand, AStartThatIsTheAnswerSaysHowWellItWasSolved) {
  const IkFolder folder;
  const Point target = folder.marker("tip", 1.2, 1);
  const ProgramResult result = run_ik(
      folder.scene, {"--target", "tip=" + coordinates(target), "--start", "air=1.2", "--tolerance", "1", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(json::parse(result.output).at("ik").at("equilibria"), 1);
  EXPECT_GT(step_of(result).at("iterations").get<int>(), 0);
  EXPECT_GT(step_of(result).at("pull_N").get<double>(), 0);
}

TEST(IkCommand, TellsWhereTheJacobianIsOneSided) {
  const std::string scene = SOFTKIN_SOURCE_DIR "/docs/scenes/finger_on_floor.yaml";
  const std::vector<std::string> options{"--start",     "air=1.15", "--target", "tip=119.28,0.05,-9.9",
                                         "--tolerance", "0.3"};
  const ProgramResult text = run_ik(scene, options);
  ASSERT_EQ(text.exit_code, 0) << text.errors;
  EXPECT_NE(text.output.find("it slips\n"), std::string::npos) << text.output;  // or a fraction of the contact slips
  EXPECT_NE(text.output.find("the Jacobian is one-sided: that for sliding on, of robot on floor\n"), std::string::npos)
      << text.output;
  std::vector<std::string> as_json = options;
  as_json.push_back("--json");
  const json report = json::parse(run_ik(scene, as_json).output);
  EXPECT_EQ(report.at("ik").at("jacobian").at("one_sided"), json::parse(R"([["robot", "floor"]])"));
}

}  // namespace
