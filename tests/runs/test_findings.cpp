#include <gtest/gtest.h>

#include <algorithm>
#include <softkin/runs/findings.hpp>

#include "small_runs.hpp"

/// Findings that a shape yields about unintended input.

namespace softkin::runs {
namespace {

/// A block with a Young's modulus [MPa] that is driven by a pressure [kPa].
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

template <class Kind>
const Kind* find(const std::vector<Finding>& all) {
  for (const Finding& each : all)
    if (const auto* is = std::get_if<Kind>(&each)) return is;
  return nullptr;
}

TEST(Findings, NothingMovesWhereTheModulusIsInPascal) {
  const Model wrong = pressed_block("600000"), right = pressed_block("0.6");
  const StepRecord unmoved = at_pressure(wrong, 50), moved = at_pressure(right, 50);
  const std::vector<Finding> of_unmoved = findings(wrong, unmoved), of_moved = findings(right, moved),
                             of_rest = findings(wrong, at_pressure(wrong, 0));
  const auto* motionless = find<finding::Motionless>(of_unmoved);
  ASSERT_NE(motionless, nullptr);
  EXPECT_EQ(motionless->largest_mm, unmoved.largest_displacement_mm);
  // linear: a millionth of the displacement at a millionth of the modulus, except for the large strains there
  EXPECT_NEAR(unmoved.largest_displacement_mm / (1e-6 * moved.largest_displacement_mm), 1, 0.3);
  EXPECT_EQ(find<finding::Motionless>(of_moved), nullptr);
  EXPECT_EQ(find<finding::Motionless>(of_rest), nullptr);  // nothing was commanded
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
  const std::vector<Finding> usual = findings(model, record);
  EXPECT_FALSE(find<finding::FarStrained>(usual) || find<finding::FarMoved>(usual) || find<SelfOverlap>(usual));
  record.strain.greatest = 6.42;
  record.largest_displacement_mm = 3.1 * model.diagonal_mm;
  record.self_overlap = {7, 0.25, {1, 2, 3}};
  const std::vector<Finding> found = findings(model, record);
  ASSERT_TRUE(find<finding::FarStrained>(found) && find<finding::FarMoved>(found) && find<SelfOverlap>(found));
  EXPECT_EQ(find<finding::FarStrained>(found)->greatest, 6.42);
  EXPECT_EQ(find<finding::FarMoved>(found)->largest_mm, record.largest_displacement_mm);
  EXPECT_EQ(find<finding::FarMoved>(found)->diagonal_mm, model.diagonal_mm);
  EXPECT_EQ(find<SelfOverlap>(found)->points, 7u);
  EXPECT_EQ(find<SelfOverlap>(found)->where, Vec3(1, 2, 3));
}

}  // namespace
}  // namespace softkin::runs
