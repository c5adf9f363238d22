#include <cmath>
#include <nlohmann/json.hpp>

#include "fk_physical_samples.hpp"

/// Reactions of a support that closes a chamber, wherever they are shown or used.

namespace {

using namespace softkin::testing;
using nlohmann::json;

constexpr double bore_area = 16;  // of the bore [mm^2]

/// The block with a bore of 4 x 4 mm that ends at the plate x = 0 which holds it.
std::string bored_scene(int order = 1) {
  return "softkin: 1\n"
         "mesh: {file: block.msh, order: " +
         std::to_string(order) +
         "}\n"
         "regions: [{name: bore, box: [[0, 4, 4], [16, 8, 8]]}]\n"
         "materials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
         "fixed: [{region: base}]\n"
         "actuators: [{name: air, kind: pneumatic, region: bore, control: pressure, range: [0, 60]}]\n"
         "markers: [{name: tip, region: tip}]\n";
}

void expect_vector(const json& found, const std::array<double, 3>& expected, double tolerance) {
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(found.at(axis).get<double>(), expected[axis], tolerance);
}

TEST(SupportReactions, AreReportedApartFromThePressureOnTheSupport) {
  for (const int order : {1, 2}) {
    const BlockFolder folder(bored_scene(order));
    const json step = step_of(folder, {"--set", "air=20"});
    ASSERT_EQ(step.at("reactions").size(), 1u);
    const json& base = step.at("reactions").at(0);
    expect_vector(base.at("force_N"), {-0.02 * bore_area, 0, 0}, 1e-8);
    expect_vector(base.at("moment_N_mm"), {0, 0, 0}, 1e-7);
    ASSERT_EQ(base.at("chambers").size(), 1u);
    const json& chamber = base.at("chambers").at(0);
    EXPECT_EQ(chamber.at("actuator"), "air");
    expect_vector(chamber.at("air_force_N"), {-0.02 * bore_area, 0, 0}, 1e-12);
    expect_vector(chamber.at("air_moment_N_mm"), {0, 0, 0}, 1e-12);
  }
  const BlockFolder folder(bored_scene());
  const std::string shape = folder / "shape.vtu";
  const ProgramResult reported = run_fk(folder.scene, {"--set", "air=20", "-o", shape});
  EXPECT_EQ(reported.exit_code, 0) << reported.errors;
  expect_words(reported.output, {"support 'base' exerts (-0.32, 0, 0) N and (0, 0, 0) N mm about (0, 6, 6) mm; the "
                                 "pressure of 'air' acts on the support with (-0.32, 0, 0) N\n"});
  const BlockFolder closed(physical_scene());
  EXPECT_FALSE(step_of(closed, {"--set", "air=1.2"}).at("reactions").at(0).contains("chambers"));
}

/// What an interrupted run has is read again.
TEST(SupportReactions, AreTheSameInARunThatGoesOn) {
  const BlockFolder folder(bored_scene());
  const std::string path = folder.write("path.csv", "air_kPa\n10\n20\n"), report = folder / "run.json";
  const std::vector<std::string> options{"--path", path, "--report", report, "-o", folder / "run.pvd"};
  ASSERT_EQ(run_fk(folder.scene, options).exit_code, 0);
  const json first = json::parse(read_text(report)).at("steps");
  std::vector<std::string> again = options;
  again.emplace_back("--resume");
  const ProgramResult resumed = run_fk(folder.scene, again);
  ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
  const json second = json::parse(read_text(report)).at("steps");
  ASSERT_EQ(second.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(first.at(i).at("reactions"), second.at(i).at("reactions"));
  expect_vector(second.at(0).at("reactions").at(0).at("chambers").at(0).at("air_force_N"), {-0.16, 0, 0}, 1e-12);
}

/// The force of the robot on its base is p A.
TEST(SupportReactions, APressureIsFoundForAForceOnTheBase) {
  const BlockFolder folder(bored_scene(2));
  const ProgramResult result = run_program({"ik", folder.scene, "--press", "base=0.48,,", "--threads", "1", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json step = json::parse(result.output).at("steps").at(0);
  EXPECT_NEAR(step.at("actuation").at("air").get<double>(), 1e3 * 0.48 / bore_area, 0.05);
}

/// A load cell at the base reads -p A, less the pressure on its plate: so the pressure is known.
TEST(SupportReactions, APressureIsEstimatedFromALoadCell) {
  const BlockFolder folder(bored_scene());
  const std::string readings = folder.write("readings.csv", "base_force_x_N,base_force_y_N\n-0.32,0\n-0.64,0\n");
  const ProgramResult reported =
      run_program({"estimate", folder.scene, readings, "--unknown", "air=20+-40", "--deviation-force", "0.0001",
                   "--report", folder / "told.json", "--threads", "1"});
  ASSERT_EQ(reported.exit_code, 0) << reported.errors << reported.output;
  const json rows = json::parse(read_text(folder / "told.json")).at("rows");
  ASSERT_EQ(rows.size(), 2u);
  for (std::size_t r = 0; r < 2; ++r)
    EXPECT_NEAR(rows.at(r).at("numbers").at(0).at("value").get<double>(), 20.0 * static_cast<double>(r + 1), 0.01);
}

}  // namespace
