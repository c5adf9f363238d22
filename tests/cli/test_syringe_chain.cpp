#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/types.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>

#include "../support/syringe_pump.hpp"
#include "run_program.hpp"

// The whole chain of Section V-C, from a place for the tip to ratios, pressures, plungers and G-code, and back: a
// simulated pump and the robot's own response, in equilibrium where closed air and chambers have one pressure, and the
// shape that results.

namespace softkin {
namespace {

using nlohmann::json;
using testing::ClosedAir;
using testing::ProgramResult;
using testing::read_text;
using testing::run_program;
using testing::TemporaryFolder;

const std::string chamber_folder = SOFTKIN_SOURCE_DIR "/examples/three_chamber_actuator/";
constexpr double plunger_ml_per_mm = 0.9, plunger_steps_per_mm = 400;  // of plunger
const ClosedAir closed_air{21.104692680065, 1.5, 100, 101.3};          // mL; the chamber's by its mesh

/// Three syringes as air has them.
std::string three_syringes() {
  std::string text = "softkin_hardware: 1\natmosphere_kPa: 101.3\nboard: {approach_speed_mm_per_s: 5}\nsyringes:\n";
  for (const auto& [name, axis] : {std::pair("air1", "X"), std::pair("air2", "Y"), std::pair("air3", "Z")})
    text += std::string("  - {actuator: ") + name + ", axis: " + axis +
            ", syringe_mL: 100, dead_volume_mL: 1.5, mL_per_mm: 0.9, lead_mm: 8, travel_limits_mm: [-60, 110]}\n";
  return text;
}

json chain_step(const std::string& report, std::size_t step = 0) {
  return json::parse(read_text(report)).at("steps").at(step);
}

Vec3 chain_tip(const json& step) {
  const auto tip = step.at("markers").at("tip").get<std::array<double, 3>>();
  return {tip[0], tip[1], tip[2]};
}

std::string all_digits(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::string ratio_cells(const Vec3& values) {
  return all_digits(values[0]) + "," + all_digits(values[1]) + "," + all_digits(values[2]);
}

struct Chain : TemporaryFolder {
  std::string scene, formulation;

  void run(const std::vector<std::string>& arguments) const {
    const ProgramResult result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }

  /// Steps of forward kinematics, a row of ratios each.
  [[nodiscard]] std::vector<json> shapes(const std::vector<Vec3>& rows) const {
    std::string text = "air1,air2,air3\n";
    for (const Vec3& row : rows) text += ratio_cells(row) + "\n";
    run({"fk", scene, "--formulation", formulation, "--path", write("trial.csv", text), "--report",
         *this / "trial.json"});
    std::vector<json> steps;
    for (std::size_t i = 0; i < rows.size(); ++i) steps.push_back(chain_step(*this / "trial.json", i));
    return steps;
  }

  /// Ratios and the report's step of inverse kinematics.
  [[nodiscard]] json bring(const Vec3& target) const {
    run({"ik", scene, "--formulation", formulation, "--target", "tip=" + ratio_cells(target), "--report",
         *this / "ik.json"});
    return chain_step(*this / "ik.json");
  }

  /// What the plungers have given [mL] at the end of the G-code for these commands.
  [[nodiscard]] Vec3 pump(const std::string& commands) const {
    run({"drive", scene, write("commands.csv", commands), "--hardware", write("bench.yaml", three_syringes()),
         "--gcode", *this / "bench.gcode"});
    Vec3 given = Vec3::Zero();
    std::istringstream lines(read_text(*this / "bench.gcode"));
    for (std::string line; std::getline(lines, line);) {
      char command = 0;
      double x = 0, y = 0, z = 0;
      if (std::sscanf(line.c_str(), "G%c X%lf Y%lf Z%lf", &command, &x, &y, &z) == 4 && command == '1')
        given = Vec3(x, y, z) * (80 / plunger_steps_per_mm) * plunger_ml_per_mm;
    }
    return given;
  }
};

Vec3 requested_ratios(const json& step) {
  Vec3 ratios;
  for (int i = 0; i < 3; ++i) ratios[i] = step.at("actuation").at("air" + std::to_string(i + 1)).get<double>();
  return ratios;
}

/// Gauge pressures of the physical formulation less those of the air.
Vec3 excess_of(const json& step, const Vec3& ratios, const Vec3& given) {
  Vec3 excess;
  for (int i = 0; i < 3; ++i)
    excess[i] = step.at("actuators").at("air" + std::to_string(i + 1)).at("pressure_kPa").get<double>() +
                closed_air.atmosphere - closed_air.pressure(given[i], ratios[i]);
  return excess;
}

/// The chambers squeeze each other: Newton's method with differences, begun far from the answer.
Vec3 correct_together(const Chain& chain, const Vec3& given) {
  Vec3 ratios(1.1, 1.1, 1.1);
  constexpr double difference = 1e-3;
  for (int iteration = 0; iteration < 12; ++iteration) {
    std::vector<Vec3> rows{ratios};
    for (int i = 0; i < 3; ++i) rows.push_back(ratios + difference * Vec3::Unit(i));
    const std::vector<json> steps = chain.shapes(rows);
    const Vec3 excess = excess_of(steps[0], ratios, given);
    if (excess.cwiseAbs().maxCoeff() < 1e-4) return ratios;
    Mat3 slope;
    for (std::size_t i = 0; i < 3; ++i)
      slope.col(i) = (excess_of(steps[i + 1], rows[i + 1], given) - excess) / difference;
    ratios = (ratios - slope.partialPivLu().solve(excess)).cwiseMax(1.0).cwiseMin(1.6);
  }
  ADD_FAILURE() << "the pump does not settle";
  return ratios;
}

TEST(SyringeChain, ClosesPhysically) {
  Chain chain;
  chain.scene = chamber_folder + "three_chamber_actuator.yaml";
  chain.formulation = "physical";
  const Vec3 target(6, 4, 138.8);
  const json found = chain.bring(target);
  const Vec3 requested = requested_ratios(found);
  std::string commands =
      "air1,air2,air3,air1_pressure_kPa,air2_pressure_kPa,air3_pressure_kPa\n" + ratio_cells(requested);
  for (const char* name : {"air1", "air2", "air3"})
    commands += "," + all_digits(found.at("actuators").at(name).at("pressure_kPa").get<double>());
  const Vec3 given = chain.pump(commands + "\n");
  EXPECT_GT(given.minCoeff(), 10);
  const Vec3 steady = correct_together(chain, given);
  EXPECT_LT((steady.array() / requested.array() - 1).abs().maxCoeff(), 1e-3) << steady.transpose();
  const double error = (chain_tip(chain.shapes({steady})[0]) - target).norm();
  EXPECT_LT(error, 0.1);
  RecordProperty("error_mm", all_digits(error));
}

/// Every chamber uses the shipped curve; drive takes its pressures from there without further input.
TEST(SyringeChain, ClosesByTargetShapes) {
  Chain chain;
  std::string text = read_text(chamber_folder + "three_chamber_actuator.yaml");
  const auto replace = [&text](const std::string& part, const std::string& by) {
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + by.size()))
      text.replace(at, part.size(), by);
  };
  replace("three_chamber_actuator.msh", chamber_folder + "three_chamber_actuator.msh");
  replace("[1.0, 1.6]}", "[1.0, 1.6], curve: " + chamber_folder + "measured/air1.yaml}");
  chain.scene = chain.write("robot.yaml", text);
  chain.formulation = "target-shape";
  const Vec3 target = chain_tip(chain.shapes({Vec3(1.24, 1.02, 1.13)})[0]);
  const Vec3 requested = requested_ratios(chain.bring(target));
  const Vec3 given = chain.pump("air1,air2,air3\n" + ratio_cells(requested) + "\n");
  const ActuatorCurve curve = read_actuator_curve(chamber_folder + "measured/air1.yaml");
  Vec3 steady;
  for (int i = 0; i < 3; ++i)
    steady[i] = testing::equilibrium_ratio(
        closed_air, given[i], [&](double ratio) { return closed_air.atmosphere + curve.loading.ratio.inverse(ratio); },
        1, 1.33);
  EXPECT_LT((steady.array() / requested.array() - 1).abs().maxCoeff(), 1e-3) << steady.transpose();
  const double error = (chain_tip(chain.shapes({steady})[0]) - target).norm();
  EXPECT_LT(error, 0.1);
  RecordProperty("error_mm", all_digits(error));
}

}  // namespace
}  // namespace softkin
