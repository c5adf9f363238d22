#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "fk_samples.hpp"
#include "support/skips.hpp"

/// The commands of examples/real, where the measurements are there.

namespace {

using namespace softkin::testing;
using nlohmann::json;
namespace fs = std::filesystem;

/// The example's files and what its script makes of the measurements; empty: these are absent.
class RealRobot {
 public:
  explicit RealRobot(const std::string& name) {
    const char* named = std::getenv("SOFTKIN_REAL");
    const fs::path measured = fs::path(named ? named : SOFTKIN_SOURCE_DIR "/../shared/real") / name;
    if (!fs::exists(measured)) return;
    const fs::path example = fs::path(SOFTKIN_SOURCE_DIR) / "examples/real" / name;
    for (const auto& entry : fs::directory_iterator(example))
      if (entry.path().extension() == ".py" || entry.path().extension() == ".yaml")
        fs::copy_file(entry.path(), folder_ / entry.path().filename().string());
    const std::string script = folder_ / ("make_" + name + ".py");
    there_ = std::system((shell_quoted(test_python()) + " " + shell_quoted(script) + " " +
                          shell_quoted(measured.string()) + " > /dev/null")
                             .c_str()) == 0;
    EXPECT_TRUE(there_);
    name_ = name;
  }

  [[nodiscard]] bool is_there() const { return there_; }
  /// Leaves the others, from 1, out of its poses.
  void keep(const std::vector<std::size_t>& poses) const {
    std::istringstream lines(read_text(folder_ / "poses.csv"));
    std::string kept, line;
    std::getline(lines, kept);
    for (std::size_t pose = 1; std::getline(lines, line); ++pose)
      if (std::find(poses.begin(), poses.end(), pose) != poses.end()) kept += "\n" + line;
    std::ofstream(folder_ / "poses.csv") << kept << "\n";
  }
  [[nodiscard]] json calibrated(const std::vector<std::string>& more) const {
    return reported({"calibrate", "robot", folder_ / (name_ + ".yaml"), folder_ / "poses.csv", "--json"}, more);
  }
  [[nodiscard]] json estimated(const std::string& readings, const std::vector<std::string>& more) const {
    return reported({"estimate", folder_ / (name_ + ".yaml"), folder_ / readings, "--json"}, more);
  }

 private:
  [[nodiscard]] static json reported(std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output);
  }

  TemporaryFolder folder_;
  bool there_ = false;
  std::string name_;
};

const std::string absent = std::string(absent_measurements) + "examples/real";

/// The modulus is near the 0.2638 MPa that its measurers found by another method.
TEST(RealRobots, ABeamsModulusForetellsItsLoad) {
  const RealRobot beam("beam");
  if (!beam.is_there()) GTEST_SKIP() << absent;
  const json weight = beam.calibrated({"--fit", "materials.all.youngs_modulus", "--keep", "1"});
  EXPECT_NEAR(weight["numbers"][0]["value"].get<double>(), 0.2638, 0.01);
  EXPECT_LT(weight["kept"]["rms_mm"].get<double>(), 1.4);
  const json both = beam.calibrated({"--fit", "materials.all.youngs_modulus"});
  EXPECT_NEAR(both["numbers"][0]["value"].get<double>(), 0.2638, 0.01);
  EXPECT_LT(both["markers"]["rms_mm"].get<double>(), 0.75);
}

/// The beam without a load determines the stiffness, and with it the other beam determines the hanging mass, within the
/// reported deviation.
TEST(RealRobots, ABeamTellsWhatHangsFromIt) {
  const RealRobot beam("beam");
  if (!beam.is_there()) GTEST_SKIP() << absent;
  const json found =
      beam.estimated("at_once.csv", {"--change", "forces.mass.range=[[0, 0], [0, 0], [-2, 0]]", "--material",
                                     "all.youngs_modulus=0.269", "--unknown", "mass=-0.5+-1", "--unknown",
                                     "materials.all.stiffness=1+-0.5", "--deviation", "0.5"});
  const json& mass = found["rows"][0]["numbers"][0];
  const double deviation = mass["deviation"].get<double>();
  EXPECT_NEAR(mass["value"].get<double>(), -0.510, 1.6 * deviation);
  EXPECT_LT(deviation, 0.05);
}

/// Each measured pose has an equilibrium, whether it is solved at half the tension first or at the full tension at
/// once.
TEST(RealRobots, ATentacleStandsWhereItStood) {
  const RealRobot tentacle("tentacle");
  if (!tentacle.is_there()) GTEST_SKIP() << absent;
  tentacle.keep({3, 7, 10, 14});
  const json found = tentacle.calibrated({"--change", "materials.all.youngs_modulus=0.3"});
  EXPECT_EQ(found["poses"].size(), 4u);
  for (const json& pose : found["poses"]) EXPECT_EQ(pose["status"], "converged");
  EXPECT_LT(found["markers"]["rms_mm"].get<double>(), 20);
}

}  // namespace
