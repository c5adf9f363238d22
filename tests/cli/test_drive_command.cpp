#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "../drive/faulty_marlin.hpp"
#include "fk_samples.hpp"
#include "map_samples.hpp"
#include "start_program.hpp"

namespace softkin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::BlockFolder;
using testing::FaultyMarlin;
using testing::physical_scene;
using testing::ProgramResult;
using testing::read_text;
using testing::run_program;

/// Tendon of 20 mm at rest, on X.
const std::string one_motor =
    "softkin_hardware: 1\n"
    "board: {approach_speed_mm_per_s: 4}\n"
    "tendons:\n"
    "  - {actuator: tendon, axis: X, backlash_mm: 0.5, max_speed_mm_per_s: 8}\n";

/// The block with the hardware of its name and commands.csv.
struct DriveFolder : BlockFolder {
  std::string commands;

  explicit DriveFolder(const std::string& hardware = one_motor, const std::string& text = physical_scene())
      : BlockFolder(text) {
    write("block.hardware.yaml", hardware);
    commands = write("commands.csv", "t_s,tendon\n0,1\n1,0.9\n2,0.8\n3.5,0.8\n4.5,0.9\n");
  }

  [[nodiscard]] ProgramResult drive(const std::vector<std::string>& options) const {
    std::vector<std::string> arguments{"drive", scene, commands};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments);
  }

  /// One line on standard error, exit code 2, nothing printed, nothing written.
  void refused(const std::vector<std::string>& options, const std::string& message) const {
    const std::size_t before = files();
    const ProgramResult result = drive(options);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_EQ(result.output, "") << message;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_EQ(result.errors.rfind("softkin: ", 0), 0u) << result.errors;
    EXPECT_NE(result.errors.find(message), std::string::npos) << "no '" << message << "' in " << result.errors;
    EXPECT_EQ(files(), before) << message;
  }
  void refused_rows(const std::string& text, const std::string& message) const {
    write("commands.csv", text);
    refused({"--dry-run", "--gcode", *this / "a.gcode"}, commands + message);
  }
  void refused_hardware(const std::string& text, const std::string& message) const {
    write("block.hardware.yaml", text);
    refused({"--gcode", *this / "new/a.gcode"}, (*this / "block.hardware.yaml") + message);
  }
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(DriveCommand, DryRunPrintsAndWritesNothing) {
  const DriveFolder folder;
  const std::size_t before = folder.files();
  const ProgramResult result = folder.drive({"--dry-run"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(folder.files(), before);
  EXPECT_TRUE(has(result.output, "default: board: configure true\n")) << result.output;
  EXPECT_TRUE(has(result.output,
                  "default: tendon 'tendon': rest_length_mm 20, steps_per_mm 80, drum_radius_mm none "
                  "(a mm of the axis is a mm of cable), direction 1, slack_offset_mm 0, "
                  "length_limits_mm [10, 24] (the actuator's range), max_acceleration_mm_per_s2 500\n"))
      << result.output;
  EXPECT_TRUE(has(result.output, "16.00 to 20.00  10.00 to 24.00         0 to 320"));
  // wound up 0, 2, 4, 4, 2 mm; 0.5 mm behind where it pays out
  EXPECT_TRUE(has(result.output, "G92 X0\nG1 X2 F120\nG1 X4 F120\nG4 P1500\nG1 X1.5 F150\nM400\n")) << result.output;
}

TEST(DriveCommand, WritesGcodeAndReportsJson) {
  const DriveFolder folder;
  const std::string file = folder / "out/block.gcode";
  const ProgramResult result = folder.drive({"--gcode", file, "--json", "--return"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_TRUE(has(read_text(file), "G92 X0\nG1 X2 F120\nG1 X4 F120\nG4 P1500\nG1 X1.5 F150\nG1 X-0.5 F240\nG1 X0 F240"))
      << read_text(file);
  const json report = json::parse(result.output);
  EXPECT_EQ(report["rows"], 5);
  EXPECT_EQ(report["motion_s"], 4.5);
  EXPECT_EQ(report["tendons"]["tendon"]["steps"], (json{-40, 320}));
  EXPECT_EQ(report["defaults"].size(), 2u);
}

TEST(DriveCommand, SchedulesPressures) {
  const std::string hardware =
      "softkin_hardware: 1\nchambers: [{actuator: air, channel: pump, limits_kPa: [0, 500]}]\n";
  DriveFolder folder(hardware, testing::loaded_scene());
  folder.write("commands.csv", "t_s,air_kPa\n0,0\n0.5,120\n2,80.25\n");
  const std::string file = folder / "schedule.csv";
  const ProgramResult result = folder.drive({"--schedule", file});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(read_text(file), "t_s,pump_kPa\n0,0\n0.5,120\n2,80.25\n");
  folder.write("commands.csv", "t_s,air\n0,0\n0.5,501\n");
  folder.refused({"--dry-run"},
                 folder.commands + ":3: chamber 'air': pressure 501 kPa is above its limit of 500 kPa (");
  folder.write("commands.csv", "air\n0\n");
  folder.refused({"--dry-run"}, folder.commands + ": has no column t_s [s]");
  folder.write("commands.csv", "t_s,air_psi\n0,0\n");
  folder.refused({"--dry-run"}, "column 'air_psi': actuator 'air' takes a pressure: its column is 'air' or 'air_kPa'");
  folder.write("commands.csv", "t_s,tendon_N\n0,3\n");
  folder.refused({"--dry-run"}, folder.commands + ": cable 'tendon' is commanded by its tension");
}

TEST(DriveCommand, TakesThePressuresOfVolumes) {
  const DriveFolder folder(one_motor + "chambers: [{actuator: air, limits_kPa: [0, 5000]}]\n");
  folder.write("commands.csv", "t_s,air\n0,1\n1,1.2\n");
  const std::string report = folder / "report.json", schedule = folder / "schedule.csv";
  folder.refused({"--dry-run"}, folder.commands +
                                    ": chamber 'air' is commanded by its volume, and a regulator sets "
                                    "pressures: add a column 'air_pressure_kPa', or name the report");
  const ProgramResult fk = testing::run_fk(folder.scene, {"--path", folder.commands, "--report", report});
  ASSERT_EQ(fk.exit_code, 0) << fk.errors;
  const ProgramResult result = folder.drive({"--pressures", report, "--schedule", schedule});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const double kpa = json::parse(read_text(report))["steps"][1]["actuators"]["air"]["pressure_kPa"];
  EXPECT_GT(kpa, 1);
  const std::string text = read_text(schedule);
  EXPECT_NEAR(std::stod(text.substr(text.rfind(',') + 1)), kpa, 1e-6 * kpa) << text;

  folder.write("commands.csv", "t_s,air\n0,1\n1,1.25\n");
  folder.refused({"--pressures", report, "--dry-run"}, report + ": its step 1 is of air = 1.2, but ");
  folder.write("commands.csv", "t_s,air\n0,1\n");
  folder.refused({"--pressures", report, "--dry-run"}, "it has 2 steps, but " + folder.commands + " has 1 row");
  folder.refused({"--pressures", folder.scene, "--dry-run"}, "this is no report of softkin");
  folder.write("commands.csv", "t_s,air,air_pressure_kPa\n0,1,0\n1,1.2,33\n");
  folder.refused({"--pressures", report, "--dry-run"}, "has the column 'air_pressure_kPa' already");
  EXPECT_TRUE(has(folder.drive({"--dry-run"}).output, "t_s,air_kPa\n0,0\n1,33\n"));
}

/// Where an actuator has a measured curve, a pump gets the pressures of that, not those of the model: by columns in kPa
/// as they stand, by volumes as the report of either formulation has them.
TEST(DriveCommand, TakesThePressuresOfCurves) {
  const std::string folder = SOFTKIN_SOURCE_DIR "/examples/three_chamber_actuator/";
  const std::string scene = folder + "measured/actuator.yaml";
  const testing::TemporaryFolder work;
  const std::string hardware = folder + "three_chamber_actuator.hardware.yaml";
  const std::string by_pressure = work.write("pressures.csv", "t_s,air1_kPa\n0,0\n1,60\n2,120\n");
  const std::string expected = "t_s,regulator1_kPa\n0,0\n1,60\n2,120\n";
  const auto schedule_of = [&](const std::string& commands, const std::vector<std::string>& options) {
    const std::string schedule = work / "schedule.csv";
    std::vector<std::string> arguments{"drive",  scene,        commands, "--hardware",
                                       hardware, "--schedule", schedule, "--force-overwrite"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return read_text(schedule);
  };
  EXPECT_EQ(schedule_of(by_pressure, {}), expected);

  for (const std::string formulation : {"target-shape", "physical"}) {
    const std::string report = work / (formulation + ".json");
    const ProgramResult fk =
        run_program({"fk", scene, "--path", by_pressure, "--formulation", formulation, "--report", report});
    ASSERT_EQ(fk.exit_code, 0) << fk.errors;
    std::string rows = "t_s,air1\n";
    const json steps = json::parse(read_text(report))["steps"];
    for (std::size_t i = 0; i < steps.size(); ++i)
      rows += std::to_string(i) + "," + steps[i]["actuation"]["air1"].dump() + "\n";
    const std::string by_volume = work.write("volumes.csv", rows);
    for (const bool reported : {true, false}) {  // the curve of the scene knows them without a report
      const std::string text = schedule_of(
          by_volume, reported ? std::vector<std::string>{"--pressures", report} : std::vector<std::string>{});
      std::istringstream lines(text);
      std::string line;
      std::getline(lines, line);
      EXPECT_EQ(line, "t_s,regulator1_kPa");
      for (const double kpa : {0.0, 60.0, 120.0}) {
        ASSERT_TRUE(std::getline(lines, line));
        EXPECT_NEAR(std::stod(line.substr(line.find(',') + 1)), kpa, 1e-6) << formulation << ": " << text;
      }
    }
    const ProgramResult twice =
        run_program({"drive", scene, by_pressure, "--hardware", hardware, "--pressures", report, "--dry-run"});
    EXPECT_EQ(twice.exit_code, 2);
    EXPECT_NE(twice.errors.find("its pressures are of no use"), std::string::npos) << twice.errors;
  }
  const std::string both = work.write("both.csv", "t_s,air1_kPa,air1_pressure_kPa\n0,0,0\n1,60,70\n");
  const ProgramResult refused = run_program({"drive", scene, both, "--hardware", hardware, "--dry-run"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("columns 'air1_pressure_kPa' and 'air1_kPa' both say its pressure"), std::string::npos)
      << refused.errors;
}

/// 2,000 mm^3 of syringe on the chamber of the block: by hand.
TEST(DriveCommand, PushesPlungers) {
  const std::string syringes =
      "softkin_hardware: 1\n"
      "atmosphere_kPa: 101.3\n"
      "syringes:\n"
      "  - {actuator: air, axis: X, syringe_mL: 2, dead_volume_mL: 0.25, plunger_area_mm2: 40, max_speed_mm_per_s: "
      "20,\n"
      "     max_acceleration_mm_per_s2: 200}\n";
  const DriveFolder folder(syringes);
  folder.write("commands.csv", "t_s,air,air_pressure_kPa\n0,1,0\n2,1.2,35\n4,1.2,35\n");
  const json report = json::parse(folder.drive({"--dry-run", "--json"}).output);
  const json syringe = report["syringes"]["air"];
  const double chamber = syringe["chamber_mm3"];
  EXPECT_NEAR(chamber, 3 * 4 * 4 * 4, 1e-9);
  // what is left of the air in the syringe under 136.3 kPa
  const double left = (chamber + 2250) * 101.3 / 136.3 - 1.2 * chamber - 250;
  const double plunger = (2000 - left) / 40;
  ASSERT_EQ(syringe["rows"].size(), 3u);
  EXPECT_NEAR(syringe["rows"][1]["plunger_mm"].get<double>(), plunger, 0.5 / 80 + 1e-9);  // whole steps
  EXPECT_NEAR(syringe["rows"][1]["leads_to"].get<double>(), 1.2, 40 * 0.5 / 80 / chamber + 1e-9);
  EXPECT_EQ(syringe["steps"], (json{0, std::llround(80 * plunger)}));
  const ProgramResult dry = folder.drive({"--dry-run"});
  EXPECT_TRUE(has(dry.output, "default: syringe 'air': chamber_mL ")) << dry.output;
  EXPECT_TRUE(
      has(dry.output, "row  t [s]  air [-]  pressure [kPa]  out of the syringe [mL]  plunger [mm]  leads to [-]"))
      << dry.output;
  EXPECT_TRUE(has(dry.output, "; X: syringe 'air', 1 mm of axis per mm of plunger")) << dry.output;
  const std::string gcode = folder / "out/block.gcode";
  EXPECT_EQ(folder.drive({"--gcode", gcode, "--return"}).exit_code, 0);
  EXPECT_EQ(folder.drive({"--gcode", gcode, "--return"}).exit_code, 0);  // it knows its own file
  EXPECT_TRUE(has(read_text(gcode), "G4 P2000\nG1 X0 F")) << read_text(gcode);
  folder.refused({"--schedule", folder / "a.csv"}, "commands no chamber of a regulator");
}

TEST(DriveCommand, RefusesPlungersByLine) {
  const std::string head = "softkin_hardware: 1\nsyringes:\n  - {actuator: air, axis: X, syringe_mL: 2, ";
  const DriveFolder folder(head + "mL_per_mm: 0.04, travel_limits_mm: [0, 9]}\n");
  folder.refused_rows(
      "t_s,air\n0,1\n1,1.2\n",
      ": chamber 'air' is commanded by its volume, and its plunger's place depends on its pressure, too");
  folder.refused_rows("t_s,air,air_pressure_kPa\n0,1,0\n9,1.2,500\n", ":3: syringe 'air': plunger ");
  folder.refused_rows("t_s,air,air_pressure_kPa\n0,1,-100\n", ":2: syringe 'air': pressure -100 kPa (gauge) is not");
  folder.write("commands.csv", "t_s,air,air_pressure_kPa\n0,1,0\n9,1.02,5\n");
  folder.refused_hardware(head + "mL_per_mm: 0.04, travel_limits_mm: [0, 90]}\n",
                          ":3: syringe 'air': a plunger at 90 mm would have pushed out more than the 2 mL");
  folder.refused_hardware(head + "plunger_area_cm2: 0.4}\n", ":3: unknown key 'plunger_area_cm2'");
}

/// Pressures of a map are those of the solver; what it was not made for is refused.
TEST(DriveCommand, TakesThePressuresOfAMap) {
  const DriveFolder folder(one_motor + "chambers: [{actuator: air, limits_kPa: [0, 5000]}]\n", testing::scene_to_map());
  const std::string map = folder / "block.skmap", report = folder / "report.json", schedule = folder / "schedule.csv";
  ASSERT_EQ(run_program({"map", folder.scene, "-o", map, "--check", "5", "--shape-accuracy", "0"}).exit_code, 0);
  folder.write("commands.csv", "t_s,air,tendon\n0,1.1,1\n1,1.2,0.95\n");
  const ProgramResult fk = testing::run_fk(folder.scene, {"--path", folder.commands, "--report", report});
  ASSERT_EQ(fk.exit_code, 0) << fk.errors;
  const ProgramResult result = folder.drive({"--map", map, "--schedule", schedule});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_TRUE(has(result.output, "pressures by the map " + map + ": ")) << result.output;
  const std::vector<std::string> rows = testing::lines_of(read_text(schedule));
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t i = 0; i < 2; ++i) {
    const double kpa = json::parse(read_text(report))["steps"][i]["actuators"]["air"]["pressure_kPa"];
    EXPECT_NEAR(std::stod(rows[i + 1].substr(rows[i + 1].find(',') + 1)), kpa, 2e-3 * kpa) << rows[i + 1];
  }
  const json reported = json::parse(folder.drive({"--map", map, "--dry-run", "--json"}).output);
  EXPECT_EQ(reported["pressures_by_map"]["file"], map);

  folder.refused({"--map", map, "--pressures", report, "--dry-run"}, "use one of them");
  folder.refused({"--map", report, "--dry-run"}, report + ": is no map of softkin");
  folder.refused({"--map", map, "--schedule", map}, "would replace a file that is read");
  folder.write("commands.csv", "t_s,tendon\n0,1\n1,0.9\n");
  folder.refused({"--map", map, "--dry-run"}, "its pressures are of no use: " + folder.commands);
  folder.write("commands.csv", "t_s,air,air_pressure_kPa\n0,1.1,0\n1,1.2,33\n");
  folder.refused({"--map", map, "--dry-run"}, "has the column 'air_pressure_kPa' already");
}

/// A pressure curve of 0.01 per kPa takes precedence over the map's model.
TEST(DriveCommand, CurvesComeBeforeAMap) {
  const std::string scene =
      testing::replaced(testing::scene_to_map(), "control: volume, ", "control: volume, curve: air.yaml, ");
  const DriveFolder folder(one_motor + "chambers: [{actuator: air, limits_kPa: [0, 5000]}]\n", scene);
  folder.write("air.yaml", "softkin_curve: 1\ninput: gauge_pressure_kPa\nloading: [[0, 1], [50, 1.5], [100, 2]]\n");
  const std::string map = folder / "block.skmap";
  ASSERT_EQ(run_program({"map", folder.scene, "-o", map, "--check", "5", "--shape-accuracy", "0"}).exit_code, 0);
  folder.write("commands.csv", "t_s,air\n0,1.1\n1,1.2\n");
  const ProgramResult result = folder.drive({"--map", map, "--dry-run"});
  EXPECT_TRUE(has(result.output, "t_s,air_kPa\n0,10\n1,20\n")) << result.output << result.errors;
}

/// Ratios 1 + 0.002 p - 0.0005 q and 1 + 0.002 q - 0.0005 p, on a grid: 1.06 and 1.135 by Cramer's rule.
TEST(DriveCommand, TakesThePressuresOfCoupledChambers) {
  const std::string example = SOFTKIN_SOURCE_DIR "/examples/three_chamber_actuator/three_chamber_actuator";
  const testing::TemporaryFolder work;
  std::string table = "air1_pressure_kPa,air2_pressure_kPa,air1,air2\n";
  for (const double p : {0.0, 50.0, 120.0})
    for (const double q : {0.0, 60.0, 120.0}) {
      std::ostringstream row;
      row << p << "," << q << "," << 1 + 0.002 * p - 0.0005 * q << "," << 1 + 0.002 * q - 0.0005 * p << "\n";
      table += row.str();
    }
  const std::string measured = work.write("measured.csv", table);
  const auto drive = [&](const std::string& commands, const std::string& pressures) {
    return run_program({"drive", example + ".yaml", work.write("commands.csv", commands), "--hardware",
                        example + ".hardware.yaml", "--pressures", pressures, "--schedule", work / "schedule.csv"});
  };
  const double left = (0.06 * 0.002 + 0.135 * 0.0005) / (0.002 * 0.002 - 0.0005 * 0.0005);
  const double right = (0.135 * 0.002 + 0.06 * 0.0005) / (0.002 * 0.002 - 0.0005 * 0.0005);
  ProgramResult result = drive("t_s,air1,air2\n0,1,1\n1,1.06,1.135\n", measured);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::vector<std::string> rows = testing::lines_of(read_text(work / "schedule.csv"));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1].rfind("0,", 0), 0u);
  double time = 0, p = 0, q = 0;
  ASSERT_EQ(std::sscanf(rows[2].c_str(), "%lf,%lf,%lf", &time, &p, &q), 3) << rows[2];
  EXPECT_NEAR(p, left, 1e-6);
  EXPECT_NEAR(q, right, 1e-6);
  const auto refused = [&](const std::string& commands, const std::string& message) {
    result = drive(commands, measured);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_TRUE(has(result.errors, message)) << result.errors;
  };
  refused("t_s,air1,air2\n0,1,1\n1,1.3,1\n", "commands.csv:3: no pressures within " + measured + " lead to its ratios");
  refused("t_s,air1,air2,air3\n0,1,1,1\n", measured + ": it is of chambers 'air1', 'air2', but " +
                                               (work / "commands.csv") + " commands 'air1', 'air2', 'air3' by volume");
  refused("t_s,air1,air1_pressure_kPa\n0,1,0\n", "its pressures are of no use");
}

TEST(DriveCommand, RowsOutsideTheMapAreRefused) {
  const DriveFolder folder(one_motor + "chambers: [{actuator: air, limits_kPa: [0, 5000]}]\n", testing::scene_to_map());
  const std::string map = folder / "block.skmap";
  ASSERT_EQ(run_program({"map", folder.scene, "-o", map, "--check", "5", "--shape-accuracy", "0"}).exit_code, 0);
  testing::cut_map(map, 1.3, true);
  folder.write("commands.csv", "t_s,air\n0,1.1\n1,1.2\n");
  EXPECT_EQ(folder.drive({"--map", map, "--dry-run"}).exit_code, 0);
  folder.write("commands.csv", "t_s,air\n0,1.1\n1,1.2\n2,1.4\n");
  folder.refused({"--map", map, "--dry-run"}, folder.commands + ":4: this row is outside the map " + map);
}

TEST(DriveCommand, RefusesRowsByLine) {
  const DriveFolder folder;
  folder.refused_rows("", ": has no header");
  folder.refused_rows("t_s,tendon\n0,1\n1,1.21\n", ":3: column 'tendon': 1.21 is outside its range, 0.5 to 1.2 [-]");
  folder.refused_rows("t_s,tendon\n0,1\n1,nan\n", ":3: column 'tendon' must hold a finite number");
  folder.refused_rows("t_s,tendon\n0,1\n1\n", ":3: the row has 1 cells");
  folder.refused_rows("t_s,tendon\n1,1\n1,1\n", ":3: t_s must increase");
  folder.refused_rows("t_ms,tendon\n0,1\n", ": column 't_ms': no actuator 't_ms'");
  folder.refused_rows("t_s,tendon_mm\n0,20\n",
                      ": column 'tendon_mm': actuator 'tendon' takes a ratio without unit: its column is 'tendon'");
  folder.refused_rows("t_s,tendon,tendon_pressure_kPa\n0,1,3\n", ": column 'tendon_pressure_kPa': no actuator");
  folder.refused_rows("t_s,tendon\n0,1\n1,0.5\n",
                      ":3: tendon 'tendon': 10 mm/s to reach this row is above its limit of 8 mm/s (");
  folder.refused_rows("t_s,tendon\n0,1\n0.008,0.999\n",
                      ":3: tendon 'tendon': a change of speed by 2.5 mm/s on the way to this row takes 625 mm/s^2");
  folder.refused_rows("t_s,air\n0,1\n", ": chamber 'air' is commanded by its volume");
}

TEST(DriveCommand, RefusesHardwareByLine) {
  const DriveFolder folder;
  const std::string head = "softkin_hardware: 1\ntendons:\n";
  folder.refused_hardware(head + "  - {actuator: tendon, axis: X, backlash_um: 500}\n",
                          ":3: unknown key 'backlash_um'");
  folder.refused_hardware(head + "  - {actuator: tendom, axis: X}\n",
                          ":3: the scene has no actuator 'tendom'; did you mean 'tendon'?");
  folder.refused_hardware(head + "  - {actuator: air, axis: X}\n", ":3: actuator 'air' stands in 'tendons'");
  folder.refused_hardware("softkin_hardware: 1\n", ": actuator 'tendon', which ");
  folder.refused_hardware(head + "  - {actuator: tendon, axis: X, length_limits_mm: [17, 21]}\n", "");
  fs::remove(folder / "block.hardware.yaml");
  folder.refused({"--dry-run"}, (folder / "block.hardware.yaml") + ": no such file; describe motors and regulators");
  folder.refused({"--dry-run", "--hardware", folder / "no.yaml"}, "no.yaml: no such file");
}

TEST(DriveCommand, RefusesOptions) {
  const DriveFolder folder;
  folder.refused({}, "nothing is to be done: give --dry-run");
  folder.refused({"--dry-run", "--port", "/dev/null"}, "--dry-run sends nothing, and --port sends");
  folder.refused({"--dry-run", "--log", folder / "log"}, "--log is of what is sent and received: it needs --port");
  folder.refused({"--port", "/dev/null", "--gcode", folder / "a.gcode"}, "port /dev/null: is no serial port");
  folder.refused({"--port", folder / "no", "--log", folder / "log"}, "no: No such file or directory");
  folder.refused({"--dry-run", "--baud", "0"}, "--baud: must be an integer from 1200 to 4000000 baud, not 0");
  folder.refused({"--dry-run", "--boot-wait", "-1"}, "--boot-wait: must be 0 to 600 s, not -1");
  folder.refused({"--schedule", folder / "a.csv"}, "commands no chamber");
  folder.refused({"--gcode", folder.commands}, "would replace a file that is read");
  folder.refused({"--gcode", folder / "block.hardware.yaml"}, "would replace a file that is read");
}

TEST(DriveCommand, SendsToABoard) {
  const DriveFolder folder;
  testing::LineFaults faults;
  faults.fraction = 0.02;
  FaultyMarlin board(faults);
  const std::string log = folder / "out/drive.log";
  const ProgramResult result = folder.drive({"--port", board.port(), "--boot-wait", "0", "--log", log});
  board.end();
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_TRUE(has(result.output, "finished after line 4 of 4: the position is known; the motors stand at X 1.500 mm\n"))
      << result.output;
  ASSERT_EQ(board.motions().size(), 3u);
  EXPECT_EQ(board.motions()[1].at('X'), 4);
  EXPECT_EQ(board.motions()[2].at('X'), 1.5);
  const std::string text = read_text(log);
  EXPECT_TRUE(has(text, " s > N10000 M110 N10000*")) << text;
  EXPECT_TRUE(has(text, " G1 X4 F120*"));
  EXPECT_TRUE(has(text, " s < ok"));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(line.size() > 35 && line[10] == 'T' && line[23] == 'Z') << line;
}

TEST(DriveCommand, SaysWhereAStreamEnded) {
  const DriveFolder folder;
  testing::LineFaults faults;
  faults.reboot_after_moves = 2;
  FaultyMarlin board(faults);
  const ProgramResult result = folder.drive({"--port", board.port(), "--boot-wait", "0", "--json"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(has(result.errors,
                  "the board has booted anew (it sent 'start'): the position is unknown; the board "
                  "accepted lines up to 1 (" +
                      folder.commands + ":3) of 4, and perhaps those up to 2; bring the motors home"))
      << result.errors;
  const json stream = json::parse(result.output)["stream"];
  EXPECT_EQ(stream["end"], "rebooted");
  EXPECT_EQ(stream["position_known"], false);
  EXPECT_EQ(stream["acknowledged"], 1);
  EXPECT_EQ(stream["sent"], 2);
}

TEST(DriveCommand, CtrlCStopsWithTheMovesDone) {
  const DriveFolder folder;
  std::string rows = "tendon\n";
  for (int i = 0; i < 2000; ++i) rows += i % 2 ? "0.9\n" : "0.8\n";
  folder.write("commands.csv", rows);
  for (const int interrupts : {1, 2}) {
    testing::LineFaults faults;
    faults.busy = 1;  // every move takes 20 ms
    faults.delay_s = 0.02;
    FaultyMarlin board(faults);
    testing::StartedProgram program(
        folder, {"drive", folder.scene, folder.commands, "--port", board.port(), "--boot-wait", "0"});
    ASSERT_TRUE(program.wait_until([&] { return board.moves() >= 5; }));
    program.send(SIGINT);
    if (interrupts == 2) {
      ::usleep(2000);  // signals of one kind that wait are one
      program.send(SIGINT);
    }
    const ProgramResult result = program.wait();
    board.end();
    EXPECT_EQ(result.exit_code, 1) << result.errors;
    EXPECT_LT(board.motions().size(), 500u);
    EXPECT_TRUE(has(result.errors, "stopped ")) << result.errors;
    if (interrupts == 1) {
      EXPECT_TRUE(has(result.errors, "stopped after line ")) << result.errors;
      EXPECT_TRUE(has(result.errors, "the motors stand at X ")) << result.errors;
    }
  }
}

TEST(DriveCommand, CtrlZPausesAndGoesOn) {
  const DriveFolder folder;
  std::string rows = "tendon\n";
  for (int i = 0; i < 40; ++i) rows += i % 2 ? "0.9\n" : "0.8\n";
  folder.write("commands.csv", rows);
  testing::LineFaults faults;
  faults.busy = 1;
  faults.delay_s = 0.02;
  FaultyMarlin board(faults);
  testing::StartedProgram program(folder,
                                  {"drive", folder.scene, folder.commands, "--port", board.port(), "--boot-wait", "0"});
  ASSERT_TRUE(program.wait_until([&] { return board.moves() >= 5; }));
  program.send(SIGTSTP);
  ASSERT_TRUE(program.wait_until([&] { return has(read_text(folder / "stderr.txt"), "paused: Ctrl-Z continues"); }));
  ::usleep(300'000);  // the move in flight ends
  const long paused = board.moves();
  ::usleep(100'000);
  EXPECT_EQ(board.moves(), paused);
  EXPECT_LT(paused, 30);
  program.send(SIGTSTP);
  EXPECT_EQ(program.wait().exit_code, 0);
}

}  // namespace
}  // namespace softkin
