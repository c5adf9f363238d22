#include <gtest/gtest.h>

#include <cmath>

#include "fk_physical_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

std::string viscous_scene(const std::string& viscosity = "[{modulus: 0.4, time: 2}]") {
  return "softkin: 1\n"
         "mesh: {file: block.msh}\n"
         "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, viscosity: " +
         viscosity +
         "}]\n"
         "fixed: [{region: base}]\n"
         "actuators: [{name: air, kind: pneumatic, region: chamber, range: [1.0, 2.0]}]\n"
         "markers: [{name: tip, region: tip}]\n";
}

double pressure(const json& step) {
  return step["actuators"]["air"]["pressure_kPa"].get<double>();
}

}  // namespace

/// A volume that is held: the pressure falls from that of the instant answer to that of the relaxed one, by retardation
/// times between the branch's and that times what the material is stiffer at once; without times it is relaxed.
TEST(ViscousPath, TimesAreAHistory) {
  const BlockFolder folder(viscous_scene());
  std::string rows = "t_s,air\n";
  for (int i = 0; i <= 40; ++i) rows += std::to_string(i) + ",1.3\n";
  const json timed = report_of(folder, {"--path", folder.write("timed.csv", rows)})["steps"];
  const double relaxed = pressure(step_of(folder, {"--set", "air=1.3"}));
  const double instant = pressure(step_of(folder, {"--set", "air=1.3", "--instant"}));
  EXPECT_GT(instant, 1.2 * relaxed);
  EXPECT_NEAR(pressure(timed[0]), instant, 1e-9 * instant);
  EXPECT_NEAR(pressure(timed[40]), relaxed, 1e-4 * relaxed);
  for (std::size_t i = 1; i <= 40; ++i) EXPECT_LT(pressure(timed[i]), pressure(timed[i - 1])) << i;
  const auto above = [&](std::size_t i) { return pressure(timed[i]) - relaxed; };
  constexpr double mu = 1 / 2.6, stiffer = (mu + 0.4) / mu;
  EXPECT_GT(above(4) / above(2), std::exp(-1));
  EXPECT_LT(above(4) / above(2), std::exp(-1 / stiffer));
  const json untimed = report_of(folder, {"--path", folder.write("untimed.csv", "air\n1.1\n1.3\n")})["steps"];
  EXPECT_NEAR(pressure(untimed[1]), relaxed, 1e-9 * relaxed);
  EXPECT_FALSE(untimed[1].contains("viscous_loss_mJ"));
}

/// Around a cycle the pressure does work, which is what the material loses; from the second cycle on nothing is left of
/// how it began.
TEST(ViscousPath, ALoopLosesItsArea) {
  const BlockFolder folder(viscous_scene());
  constexpr int steps = 100, cycles = 4;
  std::string rows = "t_s,air\n0,1\n";
  for (int i = 1; i <= cycles * steps; ++i)
    rows += std::to_string(4.0 * i / steps) + "," + std::to_string(1.15 - 0.15 * std::cos(2 * M_PI * i / steps)) + "\n";
  const json path = report_of(folder, {"--path", folder.write("loop.csv", rows)})["steps"];
  double area = 0, lost = 0;  // of pressure [kPa] over the volume's ratio
  for (std::size_t i = (cycles - 1) * steps + 1; i < path.size(); ++i) {
    const double ratio = path[i]["actuation"]["air"], before = path[i - 1]["actuation"]["air"];
    area += 0.5 * (pressure(path[i]) + pressure(path[i - 1])) * (ratio - before);
    lost += path[i]["viscous_loss_mJ"].get<double>();
  }
  constexpr double chamber_mm3 = 3 * 64;
  EXPECT_GT(lost, 0);
  EXPECT_NEAR(1e-3 * chamber_mm3 * area, lost, 0.02 * lost);
}

/// Commands that keep a tip where it is against creep, and the check of them.
TEST(ViscousPath, InverseKinematicsHoldsStillAgainstCreep) {
  const BlockFolder folder(viscous_scene());
  const json there = step_of(folder, {"--set", "air=1.4"})["markers"]["tip"];
  std::string rows = "t_s,x_mm\n";
  for (int i = 0; i <= 10; ++i) rows += std::to_string(i) + "," + std::to_string(there[0].get<double>()) + "\n";
  const std::string out = folder / "out";
  const ProgramResult found = run_program({"follow", folder.scene, folder.write("still.csv", rows), "-o", out});
  ASSERT_EQ(found.exit_code, 0) << found.errors;
  const json checked = report_of(folder, {"--path", out + "/commands.csv"})["steps"];
  ASSERT_EQ(checked.size(), 11u);
  for (const json& step : checked) EXPECT_NEAR(step["markers"]["tip"][0], there[0], 2e-3);
}

/// A pressure that the chamber cannot carry is reported, with the shape where the search ended.
TEST(ViscousPath, ALimitIsReported) {
  std::string scene = viscous_scene();
  scene.replace(scene.find("range: [1.0, 2.0]"), 17, "control: pressure, range: [0, 9000]");
  const BlockFolder folder(scene);
  const std::string rows = folder.write("rows.csv", "t_s,air_kPa\n0,0\n1,100\n2,9000\n");
  const std::string shape = folder / "last.vtu", report = folder / "limit.json";
  const ProgramResult run = run_program({"fk", folder.scene, "--path", rows, "-o", shape, "--report", report});
  EXPECT_EQ(run.exit_code, 1) << run.errors;
  EXPECT_NE(run.errors.find("limit"), std::string::npos) << run.errors;
  const json steps = json::parse(read_text(report))["steps"];
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_EQ(steps[1]["status"], "converged");
  EXPECT_EQ(steps[2]["status"], "limit");
  EXPECT_TRUE(std::filesystem::exists(shape));
}

TEST(ViscousPath, RefusesWhatHasNoMeaning) {
  const BlockFolder folder(viscous_scene());
  const std::string timed = folder.write("timed.csv", "t_s,air\n0,1.1\n1,1.2\n");
  expect_refused(folder, {"--path", timed, "--instant"}, "--instant: ");
  const BlockFolder elastic(physical_scene());
  expect_refused(elastic, {"--instant"}, "--instant is for viscous materials");
  for (const auto& [viscosity, word] :
       std::vector<std::pair<std::string, std::string>>{{"[{modulus: 0, time: 1}]", "modulus"},
                                                        {"[{modulus: 1, time: -1}]", "time"},
                                                        {"[{modulus: 1}]", "time"},
                                                        {"[{modulus: 1, time: 1, tau: 1}]", "tau"},
                                                        {"3", "viscosity"}})
    expect_refused(BlockFolder(viscous_scene(viscosity)), {}, word);
  expect_refused(folder, {"--formulation", "target-shape"}, "shape_ratio");
}
