#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "start_program.hpp"

namespace softkin {
namespace {

using nlohmann::json;
using testing::ProgramResult;
using testing::read_text;
using testing::run_program;
using testing::TemporaryFolder;

const std::string bar = SOFTKIN_SOURCE_DIR "/examples/two_material_bar/";
const std::vector<std::string> calibrate{"calibrate", "material"};

std::vector<std::string> command(std::vector<std::string> more) {
  more.insert(more.begin(), calibrate.begin(), calibrate.end());
  return more;
}

void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& fragments) {
  const ProgramResult result = run_program(command(arguments));
  EXPECT_EQ(result.exit_code, 2) << result.output << result.errors;
  EXPECT_TRUE(result.output.empty()) << result.output;
  EXPECT_TRUE(result.errors.starts_with("softkin: ")) << result.errors;
  EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
  for (const std::string& fragment : fragments)
    EXPECT_NE(result.errors.find(fragment), std::string::npos) << fragment << "\nis not in\n" << result.errors;
}

/// The scene of the example with other materials.
std::string scene_with(const std::string& materials) {
  return "softkin: 1\nmesh: {file: " + bar + "two_material_bar.msh, order: 2}\n" + materials +
         "fixed:\n  - {region: base}\n  - {region: free_end, displacement: [2, 0, 0]}\n"
         "markers: [{name: interface, region: interface}]\n";
}

double interface_x(const std::string& scene, const std::string& formulation) {
  const ProgramResult result = run_program({"fk", scene, "--formulation", formulation, "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return json::parse(result.output)["steps"][0]["markers"]["interface"][0].get<double>();
}

}  // namespace

TEST(CalibrateMaterial, StoppedAndResumedEndsWithTheSameBytes) {
  const TemporaryFolder folder;
  const auto arguments = [&](const std::string& output, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {bar + "specimens.csv", "--twist", bar + "twist.csv", "--threads", "1", "--formulation",
                               "target-shape", "-o", output});
    return command(more);
  };
  const std::string whole = folder / "whole.yaml", parts = folder / "parts.yaml", journal = parts + ".run";
  const ProgramResult undisturbed = run_program(arguments(whole, {"--json"}));
  ASSERT_EQ(undisturbed.exit_code, 0) << undisturbed.errors;
  const auto lines = [&] {
    const std::string text = std::filesystem::exists(journal) ? read_text(journal) : "";
    return std::count(text.begin(), text.end(), '\n');
  };
  std::vector<std::string> more;
  std::string errors;
  for (const auto& [signal_number, least] : {std::pair{SIGKILL, 3}, std::pair{SIGINT, 8}}) {  // the first line: set-up
    testing::StartedProgram program(folder, arguments(parts, more));
    ASSERT_TRUE(program.wait_until([&, least = least] { return lines() >= least; }));
    program.send(signal_number);
    errors = program.wait().errors;
    more = {"--resume"};
  }
  EXPECT_FALSE(std::filesystem::exists(parts));
  const std::string kept_in =
      " of 12 simulated tests; they are in " + journal + ", the same command with --resume continues\n";
  EXPECT_NE(errors.find(kept_in), std::string::npos) << errors;
  const auto kept = lines() - 1;
  const ProgramResult reported = run_program(arguments(parts, {"--resume", "--grip", "sliding"}));
  EXPECT_EQ(reported.exit_code, 2);
  EXPECT_NE(reported.errors.find("it is of other specimens, options or softkin"), std::string::npos) << reported.errors;
  EXPECT_EQ(lines() - 1, kept);
  const ProgramResult resumed = run_program(arguments(parts, {"--json", "--resume"}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
  EXPECT_EQ(resumed.output, undisturbed.output);
  EXPECT_EQ(read_text(parts), read_text(whole));
  EXPECT_FALSE(std::filesystem::exists(journal));
  expect_refused({bar + "specimens.csv", "--resume"}, {"--resume", "needs the --output"});
}

/// Made with E_A = 45, E_B = 12 MPa; the example's mesh is not the specimen's.
TEST(CalibrateMaterial, RecoversTheSpecimensOfTheExample) {
  const TemporaryFolder folder;
  const std::string fragment = folder / "materials.yaml", plot = folder / "fit.svg", residuals = folder / "r.csv";
  const ProgramResult result = run_program(command({bar + "specimens.csv", "--twist", bar + "twist.csv", "-o", fragment,
                                                    "--plot", plot, "--residuals", residuals, "--json"}));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_NEAR(report["physical"]["ratio"]["ratio"].get<double>(), 3.75, 0.03 * 3.75);
  EXPECT_NEAR(report["physical"]["moduli"]["a_MPa"].get<double>(), 45, 1);
  EXPECT_NEAR(report["physical"]["moduli"]["b_MPa"].get<double>(), 12, 0.2);
  EXPECT_NEAR(report["target_shape"]["ratio"]["ratio"].get<double>(), 5.25, 0.2);
  EXPECT_EQ(report["specimens"].size(), 5u);
  for (const char* formulation : {"physical", "target_shape"})
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_NEAR(
          report[formulation]["specimens"][i]["dl1_mm"].get<double>() / report["specimens"][i]["dl1_mm"].get<double>(),
          1, 0.01);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(
        report["twist"]["physical_deg"][i].get<double>() / report["twist"]["tests"][i]["interface_deg"].get<double>(),
        1, 0.03);
  EXPECT_NE(read_text(plot).find("</svg>"), std::string::npos);
  EXPECT_EQ(json(read_text(fragment)), report["materials_yaml"]);
  std::istringstream rows(read_text(residuals));
  EXPECT_EQ(std::count(std::istreambuf_iterator<char>(rows), {}, '\n'), 6);

  const std::string scene = folder.write("bar.yaml", scene_with(read_text(fragment)));
  EXPECT_NEAR(interface_x(scene, "physical") - 50, 0.42, 0.0042);
  EXPECT_NEAR(interface_x(scene, "target-shape") - 50, 0.42, 0.0084);
}

TEST(CalibrateMaterial, SaysWhatItTookByDefault) {
  const ProgramResult result =
      run_program(command({bar + "table_2_tpu.csv", "--cells", "1", "--height", "12", "--modulus-b", "12"}));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  for (const char* text : {"20 x 12 mm (default)", "ends clamped (default)", "law neo-hookean (default)",
                           "Poisson's ratio 0.45 (default), 1 cells", "R_omega 1 of the stiffer material (default)",
                           "one specimen: no spread", "closed form of Eq. (16):", "5.125", "youngs_modulus: 12,"})
    EXPECT_NE(result.output.find(text), std::string::npos) << text << "\nis not in\n" << result.output;
  EXPECT_EQ(result.output.find("spread 0"), std::string::npos);
}

TEST(CalibrateMaterial, TriesARatioFoundElsewhere) {
  const ProgramResult result =
      run_program(command({bar + "table_2_tpu.csv", "--formulation", "target-shape", "--try", "7.08", "--twist",
                           bar + "table_2_twist.csv", "--cells", "2", "--json"}));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_FALSE(report.contains("physical"));
  EXPECT_LT(report["tried"][0]["dl1_mm"][0].get<double>(), 0.85 * 0.210526);
  EXPECT_LT(report["tried"][0]["interface_deg"][0].get<double>(), report["twist"]["target_shape_deg"][0].get<double>());
}

TEST(CalibrateMaterial, NoRatioIsExitCodeOneAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string specimens = folder.write("s.csv", "l_mm,l1_mm,dl_mm,dl1_mm\n100,50,1,0.2\n100,50,1,0.0000001\n");
  const ProgramResult result = run_program(command({specimens, "--formulation", "target-shape", "--cells", "1", "-o",
                                                    folder / "m.yaml", "--plot", folder / "p.svg"}));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("s.csv:3: the simulated target-shape tensile test has status limit"), std::string::npos)
      << result.errors;
  EXPECT_EQ(result.output.find("materials:"), std::string::npos);
  EXPECT_EQ(folder.files(), 1u);
}

/// Made of yeoh 2, -0.25, 0.03 MPa with noise.
TEST(CalibrateMaterial, FitsTheTensileTestOfTheExample) {
  const TemporaryFolder folder;
  const ProgramResult result =
      run_program(command({"--tensile", bar + "tensile.csv", "-o", folder / "m.yaml", "--plot", folder / "p.svg",
                           "--residuals", folder / "r.csv", "--region", "all", "--json"}));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report["chosen"], "yeoh");
  EXPECT_NEAR(report["laws"]["yeoh"]["c10_MPa"].get<double>(), 2, 0.04);
  EXPECT_NEAR(report["laws"]["yeoh"]["quality"]["rms_MPa"].get<double>(), 0.03, 0.01);
  EXPECT_GT(report["laws"]["yeoh"]["quality"]["r_squared"].get<double>(), 0.998);
  EXPECT_GT(report["linear"]["end_strain"].get<double>(), 0.1);
  EXPECT_NE(read_text(folder / "p.svg").find("mooney-rivlin"), std::string::npos);
  for (const std::string law : {"", "linear", "neo-hookean", "mooney-rivlin", "yeoh"}) {
    std::vector<std::string> arguments{"--tensile", bar + "tensile.csv", "-o", folder / "m.yaml", "--region", "all"};
    if (!law.empty()) arguments.insert(arguments.end(), {"--law", law});
    ASSERT_EQ(run_program(command(arguments)).exit_code, 0);
    const std::string scene = folder.write("bar.yaml", scene_with(read_text(folder / "m.yaml")));
    EXPECT_NEAR(interface_x(scene, "physical"), 51, 0.02) << law;  // one material: the middle moves by half
  }
}

TEST(CalibrateMaterial, RefusesBadInput) {
  const TemporaryFolder folder;
  const std::string wrong = folder.write("wrong.csv", "l_mm,l1_mm,dl_cm,dl1_mm\n100,50,0.1,0.2\n");
  expect_refused({wrong}, {"wrong.csv:1:", "'dl_cm'", "'dl_mm'"});
  const std::string row = folder.write("row.csv", "l_mm,l1_mm,dl_mm,dl1_mm\n100,50,1,0.2\n100,50,1,3\n");
  expect_refused({row, "-o", folder / "m.yaml"}, {"row.csv:3:", "'dl1_mm' must be less than 'dl_mm'"});
  expect_refused({row, "--twist", wrong}, {"row.csv:3:"});
  expect_refused({folder / "none.csv"}, {"none.csv"});
  const std::string flat = folder.write("flat.csv", "strain,stress_mpa\n0,2\n.1,2\n.2,2\n.3,2\n.4,2\n");
  expect_refused({"--tensile", flat}, {"flat.csv: ", "no linear range"});
  EXPECT_EQ(folder.files(), 3u);
}

TEST(CalibrateMaterial, RefusesBadUsage) {
  const std::string specimens = bar + "specimens.csv", tensile = bar + "tensile.csv";
  expect_refused({}, {"SPECIMENS, --tensile: give one of the two", "softkin calibrate material --help"});
  expect_refused({specimens, "--tensile", tensile}, {"give one of the two"});
  expect_refused({"--tensile", tensile, "--twist", bar + "twist.csv"}, {"--twist", "does not go with --tensile"});
  expect_refused({specimens, "--up-to", "0.3"}, {"--up-to", "needs --tensile"});
  expect_refused({specimens, "--poisson-ratio", "0.5"}, {"--poisson-ratio", "less than 0.5"});
  expect_refused({specimens, "--width", "nan"}, {"--width", "greater than 0"});
  expect_refused({specimens, "--stiffer", "1.5"}, {"--stiffer", "at most 1"});
  expect_refused({specimens, "--grip", "glued"}, {"--grip"});
  expect_refused({specimens, "--law", "yeo"}, {"--law", "take E and nu"});
  expect_refused({"--tensile", tensile, "--law", "yeo"}, {"--law", "did you mean 'yeoh'?"});
  expect_refused({specimens, "--plot", "fit.png"}, {"--plot", ".svg"});
  expect_refused({specimens, "--regions", "A", "A"}, {"--regions"});
  expect_refused({specimens, "--regions", "A: 1", "B"}, {"--regions"});
  expect_refused({specimens, "--modulus-b", "12"}, {"modulus of B", "force"});
  expect_refused({specimens, "--formulation", "physical", "--try", "5"}, {"--try"});
  expect_refused({bar + "table_2_tpu.csv", "--formulation", "physical", "-o", "m.yaml"}, {"m.yaml", "--modulus-b"});
  const ProgramResult group = run_program({"calibrate"});
  EXPECT_EQ(group.exit_code, 2);
  EXPECT_NE(group.errors.find("a subcommand of calibrate"), std::string::npos) << group.errors;
}

/// Nothing is written over an input.
TEST(CalibrateMaterial, KeepsItsInputs) {
  const TemporaryFolder folder;
  const std::string test = folder.write("test.csv", read_text(bar + "tensile.csv"));
  expect_refused({"--tensile", test, "--residuals", test}, {"--residuals"});
  EXPECT_EQ(read_text(test), read_text(bar + "tensile.csv"));
}

}  // namespace softkin
