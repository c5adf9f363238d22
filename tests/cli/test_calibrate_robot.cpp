#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// The block with a named material, its loads commanded.
std::string arm_scene(const std::string& modulus = "1") {
  return replaced(loaded_scene(), "{youngs_modulus: 1,", "{region: all, youngs_modulus: " + modulus + ",");
}

struct Poses : BlockFolder {
  Poses() : BlockFolder(arm_scene()) {
    const std::string path = write("path.csv", "air_kPa,tendon_N\n0,0\n100,0\n0,3\n150,2\n");
    const std::string soft = write("soft.yaml", arm_scene("0.8"));
    const ProgramResult made = run_fk(soft, {"--path", path, "--report", *this / "made.json"});
    EXPECT_EQ(made.exit_code, 0) << made.errors;
    std::string text = "air_kPa,tendon_N,tip_x_mm,tip_y_mm,tip_z_mm,corner_x_mm\n";
    const json report = json::parse(read_text(*this / "made.json"));
    for (const json& step : report["steps"]) {
      text += number(step["actuation"]["air"]) + "," + number(step["actuation"]["tendon"]);
      for (const json& coordinate : step["markers"]["tip"]) text += "," + number(coordinate);
      text += step["actuation"]["air"] == 100 ? ",\n" : "," + number(step["markers"]["corner"][0]) + "\n";
    }
    poses = write("poses.csv", text);
  }

  static std::string number(const json& value) { return value.dump(); }

  [[nodiscard]] ProgramResult calibrate(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"calibrate", "robot", scene, poses};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  std::string poses;
};

const char* const modulus = "materials.all.youngs_modulus";

TEST(CalibrateRobot, FindsTheModulusBehindThePoses) {
  const Poses folder;
  const std::string report = folder / "fit.json";
  const std::vector<std::string> requested{
      "--fit", modulus, "--report", report, "--plot", folder / "fit.svg", "--table", folder / "fit.csv"};
  const ProgramResult fitted = folder.calibrate(requested);
  ASSERT_EQ(fitted.exit_code, 0) << fitted.errors;
  expect_words(fitted.output, {"converged", "pose  line", "tip off by [mm]", "  materials.all.youngs_modulus=0.8",
                               "all markers: 0.00 mm root mean square", "readings: ", "plot: "});
  const json found = json::parse(read_text(report));
  EXPECT_NEAR(found["numbers"][0]["value"].get<double>(), 0.8, 1e-5);
  EXPECT_EQ(found["poses"].size(), 4u);
  expect_words(read_text(folder / "fit.csv"), {"pose,line,column,measured,computed,difference,kept", "corner_x_mm"});
  EXPECT_EQ(folder.calibrate(requested).exit_code, 0) << "what it wrote it replaces";
  const ProgramResult again = folder.calibrate({"--fit", modulus, "--report", report, "--resume", "--json"});
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_NEAR(json::parse(again.output)["numbers"][0]["start"].get<double>(), 0.8, 1e-5);
}

/// No camera: the cable's length by its motor, the chamber's volume by a syringe.
TEST(CalibrateRobot, FindsTheModulusBehindLengthsAndVolumes) {
  const Poses folder;
  std::string text = "air_kPa,tendon_N,tendon_length_mm,air_volume_mm3\n";
  const json made = json::parse(read_text(folder / "made.json"));
  for (const json& step : made["steps"]) {
    text += Poses::number(step["actuation"]["air"]) + "," + Poses::number(step["actuation"]["tendon"]);
    const json &air = step["actuators"]["air"], &tendon = step["actuators"]["tendon"];  // 20 mm, 3 cells of 4 mm
    text += "," + Poses::number(20 * tendon["achieved"].get<double>()) + "," +
            Poses::number(192 * air["achieved"].get<double>()) + "\n";
  }
  const std::string measured = folder.write("measured.csv", text);
  const ProgramResult fitted =
      run_program({"calibrate", "robot", folder.scene, measured, "--fit", modulus, "--deviation-volume", "0.1"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.errors;
  expect_words(fitted.output, {"materials.all.youngs_modulus=0.8", "deviation of a volume as read: 0.1 mm^3 (given)",
                               "deviation of a length as read: "});
  const std::string commanded = folder.write("commanded.csv", "air,air_volume_mm3\n1.1,200\n");
  const std::string by_volume = folder.write("by_volume.yaml", physical_scene());
  const ProgramResult refused = run_program({"calibrate", "robot", by_volume, commanded});
  EXPECT_EQ(refused.exit_code, 2);
  expect_words(refused.errors, {"'air_volume_mm3'", "commanded by that, so it is no reading"});
}

TEST(CalibrateRobot, PredictsWhatIsKeptAside) {
  const Poses folder;
  const ProgramResult fitted = folder.calibrate({"--fit", std::string(modulus) + "=1,0.5,2", "--keep", "1", "--json"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.errors;
  const json found = json::parse(fitted.output);
  EXPECT_LT(found["kept"]["rms_mm"].get<double>(), 1e-3);
  EXPECT_EQ(found["kept"]["readings"], 2);
  const ProgramResult predicted = folder.calibrate({"--json"});  // as the scene is: a quarter too stiff
  ASSERT_EQ(predicted.exit_code, 0) << predicted.errors;
  EXPECT_GT(json::parse(predicted.output)["markers"]["rms_mm"].get<double>(), 0.02);
}

/// The poses again, of which a camera saw dots: which is which changes from pose to pose, one is missing, one is none.
TEST(CalibrateRobot, MatchesDotsToMarkers) {
  const Poses folder;
  std::string text = "air_kPa,tendon_N,dot1_x_mm,dot1_y_mm,dot1_z_mm,dot2_x_mm,dot2_y_mm,dot2_z_mm\n";
  const json made = json::parse(read_text(folder / "made.json"));
  const auto dot = [](const json& place, double z = 0) {
    return "," + Poses::number(place[0]) + "," + Poses::number(place[1]) + "," +
           Poses::number(place[2].get<double>() + z);
  };
  for (std::size_t p = 0; p < 4; ++p) {
    const json& step = made["steps"][p];
    const json &tip = step["markers"]["tip"], &corner = step["markers"]["corner"];
    text += Poses::number(step["actuation"]["air"]) + "," + Poses::number(step["actuation"]["tendon"]);
    text += p == 0   ? dot(corner) + dot(tip)
            : p == 1 ? dot(tip) + ",,,"
            : p == 2 ? dot(tip, 30) + dot(corner)
                     : dot(tip) + dot(corner);
    text += "\n";
  }
  const std::string dots = folder.write("dots.csv", text), report = folder / "fit.json";
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"calibrate", "robot", folder.scene, dots, "--match-within", "2"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  };
  const ProgramResult fitted = run({"--fit", modulus, "--report", report, "--table", folder / "fit.csv"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.errors;
  expect_words(fitted.output, {"6 of 7 dots matched to markers within 2 mm", "pose 3 (line 4): dot1 is no marker",
                               "materials.all.youngs_modulus=0.8"});
  const json found = json::parse(read_text(report));
  EXPECT_NEAR(found["numbers"][0]["value"].get<double>(), 0.8, 1e-5);
  EXPECT_EQ(found["poses"][0]["dots"]["dot1"]["marker"], "corner");
  EXPECT_EQ(found["poses"][1]["dots"]["dot1"]["marker"], "tip");
  EXPECT_FALSE(found["poses"][1]["dots"].contains("dot2"));
  EXPECT_TRUE(found["poses"][2]["dots"]["dot1"]["marker"].is_null());
  EXPECT_EQ(found["dots"]["matched"], 6);
  expect_words(read_text(folder / "fit.csv"), {"kept,marker,may_be", "1,2,dot1_x_mm,", ",corner,"});
  const ProgramResult again = run({"--fit", modulus, "--report", report, "--resume", "--keep", "1", "--json"});
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  const json resumed = json::parse(again.output);
  EXPECT_NEAR(resumed["numbers"][0]["start"].get<double>(), 0.8, 1e-5);
  EXPECT_NEAR(resumed["numbers"][0]["value"].get<double>(), 0.8, 1e-5);
  EXPECT_EQ(resumed["kept"]["readings"], 1) << "the third, with its false dot";
  const ProgramResult unsaid = run_program({"calibrate", "robot", folder.scene, dots, "--fit", modulus});
  EXPECT_EQ(unsaid.exit_code, 2);
  expect_words(unsaid.errors, {"dots.csv", "dots without names"});
  EXPECT_EQ(unsaid.output, "");
}

TEST(CalibrateRobot, RefusesWithAReason) {
  const Poses folder;
  const auto expect_bad = [&](const std::vector<std::string>& more, const std::vector<std::string>& words) {
    std::vector<std::string> all{"--report", folder / "bad.json"};
    all.insert(all.end(), more.begin(), more.end());
    const ProgramResult result = folder.calibrate(all);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    EXPECT_EQ(result.output, "");
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    expect_words(result.errors, words);
    EXPECT_FALSE(std::filesystem::exists(folder / "bad.json"));
  };
  expect_bad({"--fit", "materials.all.youngs"}, {"materials.all.youngs"});
  expect_bad({"--fit", std::string(modulus) + "=3,1,2"}, {modulus, "3"});
  expect_bad({"--fit", modulus, "--keep", "4"}, {"--keep 4", "4 poses"});
  expect_bad({"--fit", modulus, "--resume"}, {"bad.json"});
  folder.write("poses.csv", "air_kPa,tendon_N,top_x_mm\n0,0,20\n");
  expect_bad({"--fit", modulus}, {"poses.csv:1", "top_x_mm", "no marker 'top'"});
  folder.write("poses.csv", "air_kPa,tendon_N,tip_x_mm\n0,,20\n");
  expect_bad({"--fit", modulus}, {"poses.csv:2", "tendon_N", "a command is missing"});
  folder.write("poses.csv", "air_kPa,tendon_N\n0,0\n");
  expect_bad({"--fit", modulus}, {"poses.csv:1", "no column is a reading"});
  folder.write("poses.csv", "air_kPa,tendon_N,dot1_x_mm,dot1_y_mm\n0,0,20,3\n0,0,20,\n");
  expect_bad({"--fit", modulus, "--match-within", "3"}, {"poses.csv:3", "dot1_y_mm"});
  expect_bad({"--fit", modulus, "--match-within", "-3"}, {"--match-within", "-3"});
}

}  // namespace
