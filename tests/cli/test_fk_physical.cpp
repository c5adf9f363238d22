#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/vtk.hpp>

#include "fk_physical_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

TEST(FkPhysical, ReportSaysWhatItIsAboutAndInWhichUnits) {
  const BlockFolder folder(physical_scene());
  const json report = report_of(folder, {"--set", "air=1.3", "--set", "tendon=0.95"});
  EXPECT_EQ(report["formulation"], "physical");
  EXPECT_EQ(report["units"]["energy"], "mJ");
  EXPECT_EQ(report["units"]["residual"], "N");
  EXPECT_EQ(report["mesh"], json({{"order", 1}, {"vertices", 96}, {"tetrahedra", 252}, {"prisms", 0}}));
  const json& material = report["materials"][0];
  EXPECT_EQ(material["law"], "neo-hookean");
  EXPECT_NEAR(material["mu_MPa"], 1 / 2.6, 1e-12);
  EXPECT_NEAR(material["lambda_MPa"], 0.3 / (1.3 * 0.4), 1e-12);
  EXPECT_EQ(report["actuators"]["air"],
            json::parse(R"({"kind": "pneumatic", "control": "volume", "unit": "ratio to rest", "range": [0.5, 3.0]})"));

  const json& step = report["steps"][0];
  EXPECT_EQ(step["status"], "converged");
  EXPECT_EQ(step["reached"], 1.0);
  EXPECT_EQ(step["remark"], "");
  EXPECT_EQ(step["shape_actuation"], json({{"air", 1.3}, {"tendon", 0.95}}));
  EXPECT_GE(step["factorisations"], 1);
  EXPECT_GE(step["continuation_steps"], 1);
  for (const char* key : {"projections", "shifts"}) EXPECT_TRUE(step[key].is_number_unsigned()) << key;
  const json &air = step["actuators"]["air"], &tendon = step["actuators"]["tendon"];
  EXPECT_EQ(air.size(), 3u);
  EXPECT_NEAR(air["achieved"], 1.3, 1e-7);
  EXPECT_GT(air["pressure_kPa"], 10);
  EXPECT_EQ(tendon.size(), 4u);
  EXPECT_NEAR(tendon["achieved"], 0.95, 1e-9);
  EXPECT_GT(tendon["tension_N"], 0.1);
  EXPECT_EQ(tendon["slack"], false);
}

/// Supports, stress and balance: on the terminal, in the report and in the shape.
TEST(FkPhysical, SaysWhatHoldsTheRobotAndHowItIsStressed) {
  const BlockFolder folder(physical_scene());
  const std::vector<std::string> options{"--set",    "air=1.3",
                                         "--force",  "payload=0.01,0,-0.02",
                                         "-o",       folder / "shape.vtu",
                                         "--report", folder / "report.json"};
  const ProgramResult result = run_fk(folder.scene, options);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  for (const char* text :
       {"support 'base' exerts (-0.01, ", " N and (", " N mm about (0, ", "stress in the body: von Mises at most ",
        " MPa, at (", " N out of balance, elements pull with ", "principal strain of the body: "})
    EXPECT_NE(result.output.find(text), std::string::npos) << text << "\n" << result.output;
  const json step = json::parse(read_text(folder / "report.json"))["steps"][0];
  ASSERT_EQ(step["reactions"].size(), 1u);
  const json& base = step["reactions"][0];
  EXPECT_EQ(base["support"], "base");
  const double expected[] = {-0.01, 0, 0.02};
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(base["force_N"][axis], expected[axis], 1e-7);
  EXPECT_NEAR(base["moment_N_mm"][1],
              -0.02 * step["markers"]["tip"][0].get<double>() -
                  0.01 * (step["markers"]["tip"][2].get<double>() - base["center_mm"][2].get<double>()),
              0.02)
      << "a lever of about 20 mm";
  EXPECT_NEAR(base["center_mm"][1], 6, 1e-9);
  EXPECT_GT(step["stress"]["von_mises_MPa"]["value"], 0.01);
  EXPECT_EQ(step["stress"]["von_mises_MPa"]["region"], "body");
  EXPECT_GT(step["stress"]["principal_max_MPa"]["value"], step["stress"]["principal_min_MPa"]["value"]);
  EXPECT_EQ(step["unstable_modes"], 0);
  EXPECT_LE(step["residual_N"], 1e-6 * step["pull_N"].get<double>());
  const std::string shape = read_text(folder / "shape.vtu");
  for (const char* name : {"von_mises_MPa", "principal_stress_MPa", "reaction_N", "support", "support_base",
                           "pressure_kPa_air", "tension_N_tendon"})
    EXPECT_NE(shape.find("Name=\"" + std::string(name) + "\""), std::string::npos) << name;
  const std::string pressure = "Name=\"pressure_kPa_air\" NumberOfTuples=\"1\" format=\"ascii\">";
  const std::size_t at = shape.find(pressure);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(std::stod(shape.substr(at + pressure.size())), step["actuators"]["air"]["pressure_kPa"]);
  EXPECT_EQ(softkin::read_mesh(folder / "shape.vtu").tetrahedra.size(), 252u) << "it is read as before";
}

/// A block that a load bends onto a floor: on the terminal, in the report and in the shape.
TEST(FkPhysical, SaysWhatTouches) {
  const std::string held = replaced(physical_scene(), "force: [0, 0, 0]", "force: [0, 0, -5]");
  const auto above = [&](const char* height) {
    return held + "obstacles: [{name: floor, halfspace: {point: [0, 0, " + height + "], normal: [0, 0, 1]}}]\n";
  };
  const BlockFolder folder(above("-0.1"));
  const ProgramResult result = run_fk(
      folder.scene, {"-o", folder / "shape.vtu", "--report", folder / "report.json", "--image", folder / "shape.png"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json step = json::parse(read_text(folder / "report.json"))["steps"][0];
  ASSERT_EQ(step["contacts"].size(), 1u);
  const json &floor = step["contacts"][0], &base = step["reactions"][0];
  EXPECT_EQ(floor["on"], "robot");
  EXPECT_EQ(floor["by"], "floor");
  const double load = floor["force_N"][2];
  EXPECT_GT(load, 0.1);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(floor["force_N"][axis].get<double>() + base["force_N"][axis].get<double>(), axis == 2 ? 5 : 0, 5e-6);
  EXPECT_NEAR(floor["normal_N"], load, 1e-9 * load);
  const auto digits = [](const json& value, int count) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", count, value.get<double>());
    return std::string(text);
  };
  for (const std::string& text :
       {"obstacle 'floor' exerts (0, 0, " + digits(floor["force_N"][2], 4) + ") N and (0, 0, 0) N mm about (",
        " mm on the robot, at most " + digits(floor["pressure_kPa"], 4) + " kPa over " + digits(floor["area_mm2"], 4) +
            " mm^2; least gap " + digits(floor["gap_mm"], 3) + " mm\n"})
    EXPECT_NE(result.output.find(text), std::string::npos) << text << "\n" << result.output;
  EXPECT_EQ(result.output.find("passes through itself"), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find("nothing touches"), std::string::npos) << result.output;
  EXPECT_NE(read_text(folder / "shape.vtu").find("Name=\"contact_pressure_kPa\""), std::string::npos);

  const BlockFolder far(above("-30")), without(held);
  const ProgramResult apart = run_fk(far.scene, {"--report", far / "report.json"}),
                      bare = run_fk(without.scene, {"--report", without / "report.json", "-o", without / "shape.vtu"});
  EXPECT_NE(apart.output.find("\nnothing touches\n"), std::string::npos) << apart.output;
  EXPECT_EQ(json::parse(read_text(far / "report.json"))["steps"][0]["contacts"], json::array());
  EXPECT_EQ(bare.output.find("touches"), std::string::npos) << bare.output;
  EXPECT_FALSE(json::parse(read_text(without / "report.json"))["steps"][0].contains("contacts"));
  EXPECT_EQ(read_text(without / "shape.vtu").find("contact_pressure"), std::string::npos);
}

/// A bar of an uneven mesh buckles by itself, however far its ends are pressed together at once.
TEST(FkPhysical, ABarThatIsPressedBuckles) {
  double aside = 0;
  for (const char* by : {"6", "7", "10"}) {
    const TemporaryFolder folder;
    const std::string scene =
        folder.write("strut.yaml", "softkin: 1\nmesh: {file: " + std::string(SOFTKIN_SOURCE_DIR) +
                                       "/examples/two_material_bar/two_material_bar.msh}\n"
                                       "materials:\n  - {law: neo-hookean, youngs_modulus: 12, poisson_ratio: 0.3}\n"
                                       "fixed:\n  - {region: base}\n  - {region: free_end, displacement: [-" +
                                       by + ", 0, 0]}\nmarkers:\n  - {name: middle, point: [50, 5, 0]}\n");
    const ProgramResult result = run_fk(scene, {"--json"});
    ASSERT_EQ(result.exit_code, 0) << by << ": " << result.errors;
    const json step = json::parse(result.output)["steps"][0];
    EXPECT_EQ(step["unstable_modes"], 0) << by;
    const double z = std::abs(step["markers"]["middle"][2].get<double>());
    EXPECT_GT(z, aside + 2) << by;
    aside = z;
  }
}

TEST(FkPhysical, TellsWhereItIsUnstableAndLeavesThatIfAsked) {
  const BlockFolder folder;
  const std::string strip = std::string(SOFTKIN_SOURCE_DIR) + "/docs/scenes/against_field.yaml";
  const ProgramResult reported = run_fk(strip, {"--set", "field=-10", "--report", folder / "told.json"});
  EXPECT_EQ(reported.exit_code, 0) << reported.errors;
  EXPECT_NE(reported.output.find("  converged, unstable\n"), std::string::npos) << reported.output;
  EXPECT_NE(reported.output.find("warning: this equilibrium is unstable in "), std::string::npos) << reported.output;
  const ProgramResult left = run_fk(strip, {"--set", "field=-10", "--stable", "--report", folder / "left.json"});
  EXPECT_EQ(left.exit_code, 0) << left.errors;
  EXPECT_EQ(left.output.find("unstable in"), std::string::npos) << left.output;
  EXPECT_NE(left.output.find("the robot left "), std::string::npos) << left.output;
  const json before = json::parse(read_text(folder / "told.json")),
             after = json::parse(read_text(folder / "left.json"));
  EXPECT_GT(before["steps"][0]["unstable_modes"], 0);
  EXPECT_EQ(after["steps"][0]["unstable_modes"], 0);
  EXPECT_LT(after["steps"][0]["energy"], before["steps"][0]["energy"]);
  EXPECT_EQ(after["solver"]["stable"], true);
  const BlockFolder targets;
  const ProgramResult refused = run_fk(targets.scene, {"--stable"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("--stable is for the physical formulation"), std::string::npos) << refused.errors;
}

TEST(FkPhysical, ReportNamesTheUnitsOfLoads) {
  const BlockFolder folder(loaded_scene());
  const json report = report_of(folder, {});
  EXPECT_EQ(report["actuators"]["air"]["control"], "pressure");
  EXPECT_EQ(report["actuators"]["air"]["unit"], "kPa");
  EXPECT_EQ(report["actuators"]["tendon"]["control"], "tension");
  EXPECT_EQ(report["actuators"]["tendon"]["unit"], "N");
  EXPECT_EQ(report["steps"][0]["actuation"], json({{"air", 0.0}, {"tendon", 0.0}}));
  EXPECT_FALSE(report["steps"][0]["actuators"]["tendon"]["slack"]) << "a tension of 0 was requested";
}

/// Along a path of three values of one actuator: the energy's central difference in its measure.
double energy_slope(const BlockFolder& folder, const std::string& actuator, double value, double step,
                    const std::string& other) {
  const std::string path = folder.write(
      "path.csv", actuator + "\n" + text(value - step) + "\n" + text(value) + "\n" + text(value + step) + "\n");
  const json steps = report_of(folder, {"--path", path, "--set", other})["steps"];
  return (steps[2]["energy"].get<double>() - steps[0]["energy"].get<double>()) / (2 * step);
}

TEST(FkPhysical, PressureAndTensionAreSlopesOfTheEnergy) {
  const BlockFolder folder(physical_scene());
  const json found = step_of(folder, {"--set", "air=1.3", "--set", "tendon=0.9"})["actuators"];
  const double volume = 3 * 64, length = 20;                                                    // [mm^3], [mm]
  const double pressure = 1e3 * energy_slope(folder, "air", 1.3, 1e-3, "tendon=0.9") / volume;  // mJ/mm^3 is MPa
  const double tension = -energy_slope(folder, "tendon", 0.9, 1e-3, "air=1.3") / length;
  EXPECT_NEAR(found["air"]["pressure_kPa"], pressure, 1e-5 * pressure);
  EXPECT_NEAR(found["tendon"]["tension_N"], tension, 1e-5 * tension);
}

TEST(FkPhysical, LoadsFindTheShapeThatRatiosFind) {
  const BlockFolder ratios(physical_scene()), loads(loaded_scene());
  const json by_ratio = step_of(ratios, {"--set", "air=1.3", "--set", "tendon=0.9"});
  const std::string pressure = text(by_ratio["actuators"]["air"]["pressure_kPa"]);
  const std::string tension = text(by_ratio["actuators"]["tendon"]["tension_N"]);
  const json by_load = step_of(loads, {"--set", "air=" + pressure, "--set", "tendon=" + tension});
  expect_same_markers(by_ratio, by_load, 1e-5);
  EXPECT_NEAR(by_load["actuators"]["air"]["achieved"], 1.3, 1e-6);
  EXPECT_NEAR(by_load["actuators"]["tendon"]["achieved"], 0.9, 1e-6);
  EXPECT_EQ(text(by_load["actuators"]["air"]["requested"]), pressure);
  EXPECT_NEAR(by_load["actuators"]["air"]["pressure_kPa"], by_load["actuators"]["air"]["requested"], 1e-9);
  for (const std::string blank : {"", " "})
    EXPECT_EQ(timeless(by_load), timeless(step_of(loads, {"--set", "air=" + pressure + blank + "kPa", "--set",
                                                          "tendon=" + tension + blank + "N"})));
}

TEST(FkPhysical, AchievedVolumeIsThatOfTheShape) {
  const BlockFolder loads(loaded_scene());
  const json step = step_of(loads, {"--set", "air=80", "-o", loads / "shape.vtu"});
  const softkin::Mesh rest = softkin::read_mesh(loads / "block.msh");
  const softkin::Points shape = softkin::read_vtu_points(loads / "shape.vtu");
  double before = 0, after = 0;
  for (const softkin::Region& region : rest.regions) {
    if (region.name != "chamber") continue;
    // the chamber's vertices all lie on its boundary, so that its elements fill it in every shape
    for (const softkin::Index e : region.tetrahedra) {
      const softkin::Tetrahedron& t = rest.tetrahedra[e];
      before += std::abs(softkin::signed_volume(rest.vertices, t));
      after += std::abs(softkin::signed_volume(shape, t));
    }
  }
  EXPECT_NEAR(before, 3 * 64, 1e-9);
  EXPECT_NEAR(step["actuators"]["air"]["achieved"], after / before, 1e-12);
  EXPECT_GT(after / before, 1.01);
}

TEST(FkPhysical, APayloadBendsItAndDoesWork) {
  const BlockFolder folder(replaced(physical_scene(), "control: length", "control: tension"));
  folder.write("block.yaml", replaced(replaced(physical_scene(), "volume, range: [0.5, 3]", "pressure, range: [0, 10]"),
                                      "length, range: [0.5, 1.2]", "tension, range: [0, 1]"));
  const auto sink = [](const json& step) { return 6 - step["markers"]["tip"][2].get<double>(); };
  const json none = step_of(folder, {}), light = step_of(folder, {"--force", "payload=0,0,-0.001"}),
             heavy = step_of(folder, {"--force", "payload=0,0,-0.002"});
  EXPECT_NEAR(sink(none), 0, 1e-12);
  EXPECT_GT(sink(light), 1e-4);
  EXPECT_NEAR(sink(heavy), 2 * sink(light), 1e-3 * sink(heavy));
  // Clapeyron: elastic energy less the work of the load is minus half that work
  EXPECT_NEAR(heavy["energy"].get<double>(), -0.5 * 0.002 * sink(heavy), 1e-3 * 0.002 * sink(heavy));

  const BlockFolder written(replaced(read_text(folder.scene), "force: [0, 0, 0]", "force: [0, 1e-3, -0.002]"));
  EXPECT_EQ(timeless(step_of(written, {})), timeless(step_of(folder, {"--force", "payload=0,1e-3,-0.002"})));
}

TEST(FkPhysical, RefusesForces) {
  const BlockFolder folder(physical_scene()), target(block_scene());
  const auto refused = [&](const std::vector<std::string>& forces, const std::string& message) {
    std::vector<std::string> options{"-o", folder / "new/a.vtu"};
    for (const std::string& force : forces) options.insert(options.end(), {"--force", force});
    expect_refused(folder, options, message);
  };
  refused({"paylaod=0,0,1"}, "--force 'paylaod=0,0,1': no force 'paylaod'; did you mean 'payload'?");
  refused({"payload"}, "--force 'payload': expected NAME=FX,FY,FZ in N, for example --force payload=0,0,-0.5");
  for (const std::string bad : {"", "1", "1,2", "1,2,3,4", "1,2,nan", "1,2,3N", "1;2;3", "1, 2,3"})
    refused({"payload=" + bad}, "the force must be three finite numbers in N, FX,FY,FZ, not '" + bad + "'");
  refused({"payload=1,0,0", "payload=1,0,0"}, "force 'payload' is given twice");
  expect_refused(target, {"--force", "payload=0,0,1"}, "the target-shape formulation knows no forces");
  folder.write("block.yaml",
               replaced(physical_scene(), "forces: [{name: payload, region: tip, force: [0, 0, 0]}]", ""));
  refused({"payload=1,0,0"}, "no force 'payload'; the scene has none");
}

TEST(FkPhysical, RefusesSettings) {
  const BlockFolder loads(loaded_scene()), ratios(physical_scene());
  const auto refused = [](const BlockFolder& folder, const std::string& setting, const std::string& message) {
    expect_refused(folder, {"--set", setting, "-o", folder / "new/a.vtu"}, "--set '" + setting + "': " + message);
  };
  for (const std::string value : {"50N", "50MPa", "50 kpa", "kPa", "", "nan", "nankPa", "5 0", "50 k Pa"})
    refused(loads, "air=" + value,
            "the pressure must be a finite number in kPa, such as 5 or 5kPa, not '" + value + "'");
  refused(loads, "tendon=3kPa", "the tension must be a finite number in N, such as 5 or 5N, not '3kPa'");
  refused(loads, "air=3001", "the pressure is outside its range, -100 to 3000 kPa");
  refused(loads, "air=-100.1kPa", "the pressure is outside its range, -100 to 3000 kPa");
  refused(loads, "tendon=-1N", "the tension is outside its range, 0 to 100 N");
  for (const std::string value : {"1.1kPa", "1N"})
    refused(ratios, "air=" + value, "the ratio to rest must be a finite number without unit, not '" + value + "'");
  expect_refused(ratios, {"--solver", "local-global"}, "--solver local-global is for the target-shape formulation");
}

TEST(FkPhysical, ColumnsMayNameTheUnitOfTheirLoad) {
  const BlockFolder loads(loaded_scene()), ratios(physical_scene());
  const auto steps = [&](const std::string& table) {
    json all = report_of(loads, {"--path", loads.write("path.csv", table)})["steps"];
    for (json& step : all) step = timeless(step);
    return all;
  };
  EXPECT_EQ(steps("air,tendon\n10,0\n20,0.5\n"), steps("tendon_N,air_kPa\n0,10\n0.5,20\n"));
  const auto refused = [](const BlockFolder& folder, const std::string& table, const std::string& message) {
    const std::string path = folder.write("path.csv", table);
    expect_refused(folder, {"--path", path}, path + message);
  };
  refused(loads, "air_N\n1\n", ": column 'air_N': actuator 'air' takes a pressure: its column is 'air' or 'air_kPa'");
  refused(ratios, "air_kPa\n1\n", ": column 'air_kPa': actuator 'air' takes a ratio without unit: its column is 'air'");
  refused(loads, "air,air_kPa\n1,1\n", ": column 'air_kPa': another column is of the same actuator");
  refused(loads, "air_kPa\n10\n3001\n", ":3: column 'air_kPa': 3001 is outside its range, -100 to 3000 kPa");
  refused(loads, "air_kPa\n10kPa\n", ":2: column 'air_kPa' must hold a finite number, not '10kPa'");
  const std::string path = loads.write("path.csv", "air_kPa\n1\n");
  expect_refused(loads, {"--path", path, "--set", "air=1"},
                 "'air' is set for the whole path, too; leave out one of them");
}

TEST(FkPhysical, TableHasPressuresTensionsAndTheirUnits) {
  const BlockFolder loads(loaded_scene()), ratios(physical_scene());
  const std::string by_load = run_fk(loads.scene, {"--set", "air=80", "--set", "tendon=0.5"}).output;
  const std::string by_ratio = run_fk(ratios.scene, {"--set", "air=1.3"}).output;
  const auto has = [](const std::string& output, const std::string& part) {
    EXPECT_NE(output.find(part), std::string::npos) << part << "\n" << output;
  };
  has(by_load, "252 tetrahedra of order 1; physical formulation (neo-hookean), solver newton\n");
  has(by_load, "actuator air: pneumatic, 192 mm^3 at rest, pressure -100 to 3000 kPa\n");
  has(by_load, "actuator tendon: cable, 20 mm at rest, tension 0 to 100 N\n");
  has(by_load, "step  air [kPa]  volume ratio [-]  pressure [kPa]  tendon [N]  length ratio [-]   tension [N]  ");
  has(by_load, "   0    80.0000            1.");
  has(by_load, "         80.0000      0.5000  ");
  has(by_ratio, "step  air [-]  achieved [-]  pressure [kPa]  tendon [-]  achieved [-]   tension [N]  ");
  has(by_ratio, "   0   1.3000        1.3000  ");
  EXPECT_EQ(by_ratio.find("slack"), std::string::npos) << by_ratio;
}

TEST(FkPhysical, ASlackCableIsSaidToBe) {
  const BlockFolder folder(physical_scene());
  const std::vector<std::string> options{"--set", "tendon=1.1", "--force", "payload=0.1,0,0"};
  const std::string output = run_fk(folder.scene, options).output;
  EXPECT_NE(output.find("         slack  "), std::string::npos) << output;
  EXPECT_NE(output.find("\ncable 'tendon' is slack: its path is 1.0"), std::string::npos) << output;
  const json step = step_of(folder, options), &tendon = step["actuators"]["tendon"];
  EXPECT_EQ(tendon["slack"], true);
  EXPECT_EQ(tendon["tension_N"], 0.0);
  EXPECT_LT(tendon["achieved"], 1.1);
  const BlockFolder none(replaced(loaded_scene(), "pressure, range: [-100, 3000]", "volume, range: [0.5, 3]"));
  expect_same_markers(step, step_of(none, {"--force", "payload=0.1,0,0"}), 1e-6);
}

}  // namespace
