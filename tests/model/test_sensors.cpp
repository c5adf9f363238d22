#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/model/sensor.hpp>

#include "model/block_mesh.hpp"

/// Lengths and angles of sensors against shapes of which they are known.

namespace softkin {

namespace {

using namespace testing;

RobotSpec sensed_block(bool quadratic) {
  RobotSpec spec = block_robot(block_mesh({6, 2, 2}, {30, 8, 10}));
  spec.formulation = Formulation::physical;
  spec.materials[0].shape_ratio.reset();
  spec.materials[0].elastic = ElasticSpec{};
  spec.materials[0].elastic->youngs_modulus = 1;
  spec.materials[0].elastic->poisson_ratio = 0.4;
  spec.mesh_options.quadratic = quadratic;
  const SensorSpec strain{.name = "strain", .kind = SensorKind::length, .points = {{2, 4, 1}, {28, 4, 1}}};
  const SensorSpec bend{
      .name = "bend", .kind = SensorKind::angle, .points = {}, .sections = {"x_low", "x_high"}, .axis = Vec3(0, 2, 0)};
  const SensorSpec tracker{
      .name = "tracker", .kind = SensorKind::direction, .points = {}, .sections = {"x_high"}, .axis = Vec3(3, 0, 4)};
  spec.sensors = {std::make_shared<const SensorSpec>(strain), std::make_shared<const SensorSpec>(bend),
                  std::make_shared<const SensorSpec>(tracker)};
  return spec;
}

/// Bent to an arc about y: x along it, z across.
Points bent(const Points& rest, double angle) {
  Points shape = rest;
  const double radius = 30 / angle;
  for (Index v = 0; v < rest.rows(); ++v) {
    const double turned = rest(v, 0) / radius, r = radius + rest(v, 2) - 5;
    shape.row(v) << r * std::sin(turned), rest(v, 1), r * std::cos(turned) - radius;
  }
  return shape;
}

}  // namespace

TEST(Sensor, LengthAndAngleOfABentBlock) {
  for (const bool quadratic : {false, true}) {
    const Model model = compile(sensed_block(quadratic));
    const Sensor &strain = *model.sensors.at(0), &bend = *model.sensors.at(1);
    EXPECT_NEAR(strain.at(model.rest), 26, 1e-9);
    EXPECT_NEAR(bend.at(model.rest), 0, 1e-9);
    const Points affine = model.rest * Vec3(1.25, 0.9, 1.1).asDiagonal();
    EXPECT_NEAR(strain.at(affine), 1.25 * 26, 1e-9);
    for (const double angle : {0.3, 1.5, -2.0}) {
      const Points shape = bent(model.rest, angle);
      EXPECT_NEAR(bend.at(shape), angle * 180 / std::numbers::pi, 1e-6) << "about y, from x to -z";
      // a thread 4 mm below the middle of the arc; linear elements cut corners
      const double length = 26 * (1 - 4 * angle / 30);
      EXPECT_NEAR(strain.at(shape), length, (quadratic ? 5e-4 : 1e-2) * length);
    }
  }
}

/// Turned and moved as a whole nothing changes.
TEST(Sensor, IsOfTheShapeAlone) {
  const Model model = compile(sensed_block(false));
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Points shape = bent(model.rest, 0.7);
  const Points moved = (shape * turn.transpose()).rowwise() + Vec3(5, -7, 40).transpose();
  for (std::size_t s = 0; s < 2; ++s) EXPECT_NEAR(model.sensors[s]->at(moved), model.sensors[s]->at(shape), 1e-9);
}

/// Of a direction that turns with the end of the block, and with the block as a whole.
TEST(Sensor, DirectionTurnsWithItsRegion) {
  for (const bool quadratic : {false, true}) {
    const Model model = compile(sensed_block(quadratic));
    const Sensor& tracker = *model.sensors.at(2);
    const auto direction = [&](const Points& at) {
      return Vec3(tracker.at(at, 0), tracker.at(at, 1), tracker.at(at, 2));
    };
    EXPECT_LT((direction(model.rest) - Vec3(0.6, 0, 0.8)).norm(), 1e-9);
    const Points shape = bent(model.rest, 0.9);  // about y
    const Vec3 turned = Eigen::AngleAxisd(0.9, Vec3::UnitY()) * Vec3(0.6, 0, 0.8);
    EXPECT_LT((direction(shape) - turned).norm(), 1e-9);
    const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const Points moved = (shape * turn.transpose()).rowwise() + Vec3(5, -7, 40).transpose();
    EXPECT_LT((direction(moved) - turn * turned).norm(), 1e-9);
  }
}

TEST(Sensor, VelocityIsItsDerivative) {
  for (const bool quadratic : {false, true}) {
    const Model model = compile(sensed_block(quadratic));
    const Points shape = bent(model.rest, 0.7);
    Points moves = model.rest;
    for (Index v = 0; v < moves.rows(); ++v)
      moves.row(v) << std::sin(0.3 * v), std::cos(1.1 * v), std::sin(0.7 * v + 1) + 0.05 * model.rest(v, 0);
    for (const auto& sensor : model.sensors)
      for (int component = 0; component < 3; ++component) {
        const double h = 1e-4;
        const auto at = [&](double times) { return sensor->at(shape + times * h * moves, component); };
        const double difference = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
        EXPECT_NEAR(sensor->velocity(shape, moves, component), difference, 1e-8 * std::abs(difference) + 1e-9)
            << sensor->name;
      }
  }
}

TEST(Sensor, Refusals) {
  const auto refused = [](const auto& change, const std::string& why) {
    RobotSpec spec = sensed_block(false);
    SensorSpec strain = *spec.sensors[0], bend = *spec.sensors[1];
    change(strain, bend);
    spec.sensors = {std::make_shared<const SensorSpec>(strain), std::make_shared<const SensorSpec>(bend)};
    try {
      (void)compile(spec);
      ADD_FAILURE() << "not refused: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  refused([](SensorSpec& s, SensorSpec&) { s.points.pop_back(); }, "sensor 'strain' needs at least two points");
  refused([](SensorSpec& s, SensorSpec&) { s.points[1] = {90, 4, 1}; }, "sensor 'strain' runs");
  refused([](SensorSpec&, SensorSpec& b) { b.name = "strain"; }, "there are two sensors 'strain'");
  refused([](SensorSpec&, SensorSpec& b) { b.sections[1] = "x_hihg"; }, "did you mean 'x_high'?");
  refused([](SensorSpec&, SensorSpec& b) { b.sections[1] = "x_low"; }, "is between a section and itself");
  refused([](SensorSpec&, SensorSpec& b) { b.axis = Vec3::Zero(); }, "has an axis without direction");
}

}  // namespace softkin
