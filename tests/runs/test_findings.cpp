#include <gtest/gtest.h>

#include <algorithm>
#include <softkin/runs/records.hpp>

#include "small_runs.hpp"

/// What a shape tells of an input that was not meant.

namespace softkin::runs {
namespace {

using Kind = Finding::Kind;

/// A block of so many MPa that is driven by a pressure [kPa].
Model pressed_block(const std::string& modulus) {
  return testing::block_model(
      "softkin: 1\nmesh: {file: block.msh}\n"
      "materials: [{youngs_modulus: " +
      modulus +
      ", poisson_ratio: 0.3}]\n"
      "fixed: [{region: base}]\n"
      "actuators: [{name: air, kind: pneumatic, region: chamber, control: pressure, range: [0, 50]}]\n"
      "markers: [{name: tip, region: tip}]\n");
}

StepRecord at_pressure(const Model& model, double pressure_kPa) {
  const Statics statics(model);
  const Equilibrium found = statics.solve(Actuation::Constant(1, pressure_kPa), statics.rest(), testing::one_thread());
  EXPECT_EQ(found.report.status, Status::converged);
  return step_record(model, found, deformation_of(model, found.state.positions));
}

const Finding* find(const std::vector<Finding>& all, Kind kind) {
  for (const Finding& each : all)
    if (each.kind == kind) return &each;
  return nullptr;
}

TEST(Findings, NothingMovesWhereTheModulusIsInPascal) {
  const Model wrong = pressed_block("600000"), right = pressed_block("0.6");
  const StepRecord unmoved = at_pressure(wrong, 50), moved = at_pressure(right, 50);
  const std::vector<Finding> of_unmoved = findings(wrong, unmoved), of_moved = findings(right, moved),
                             of_rest = findings(wrong, at_pressure(wrong, 0));
  const Finding* motionless = find(of_unmoved, Kind::motionless);
  ASSERT_NE(motionless, nullptr);
  EXPECT_EQ(motionless->values.at(0), unmoved.largest_displacement_mm);
  // linear: a millionth of what moves at a millionth of the modulus, but for the large strains there
  EXPECT_NEAR(unmoved.largest_displacement_mm / (1e-6 * moved.largest_displacement_mm), 1, 0.3);
  EXPECT_EQ(find(of_moved, Kind::motionless), nullptr);
  EXPECT_EQ(find(of_rest, Kind::motionless), nullptr);  // nothing was asked for
  const auto doubted = [](const Model& model) {
    return std::any_of(model.warnings.begin(), model.warnings.end(), [](const std::string& warning) {
      return warning.find("taken as Pa it would be 0.6 MPa") != std::string::npos;
    });
  };
  EXPECT_TRUE(doubted(wrong));
  EXPECT_FALSE(doubted(right));
}

TEST(Findings, WhatStrainsAndMovesBeyondAnyRobotIsTold) {
  const Model model = pressed_block("0.6");
  StepRecord record = at_pressure(model, 20);
  const auto has = [&](Kind kind) { return find(findings(model, record), kind) != nullptr; };
  EXPECT_FALSE(has(Kind::far_strained) || has(Kind::far_moved) || has(Kind::self_overlap));
  record.strain.greatest = 6.42;
  record.largest_displacement_mm = 3.1 * model.diagonal_mm;
  record.self_overlap = {7, 0.25, {1, 2, 3}};
  const std::vector<Finding> found = findings(model, record);
  ASSERT_TRUE(find(found, Kind::far_strained) && find(found, Kind::far_moved) && find(found, Kind::self_overlap));
  EXPECT_EQ(find(found, Kind::far_strained)->values, std::vector<double>{6.42});
  EXPECT_EQ(find(found, Kind::far_moved)->values,
            (std::vector<double>{record.largest_displacement_mm, model.diagonal_mm}));
  EXPECT_EQ(find(found, Kind::self_overlap)->values, (std::vector<double>{7, 0.25, 1, 2, 3}));
}

}  // namespace
}  // namespace softkin::runs
