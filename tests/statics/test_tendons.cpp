#include <Eigen/Geometry>
#include <softkin/core/error.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/sensitivity_samples.hpp"

/// Cables with friction where they bend.

namespace softkin {

namespace {

using namespace testing;

constexpr double modulus_MPa = 0.2, area_mm2 = 100, free_mm = 30;

/// A bar whose first half stands still and holds pins, between which a tendon zigzags before it runs along the axis to
/// the end of the other half, which is a spring that moves along the axis alone.
RobotSpec capstan(double height_mm, double friction, bool by_length = false) {
  Mesh mesh = block_mesh({12, 2, 2}, {60, 10, 10});
  std::vector<Index> still, sliding;
  for (Index v = 0; v < mesh.vertices.rows(); ++v) (mesh.vertices(v, 0) <= 30 + 1e-9 ? still : sliding).push_back(v);
  add_vertex_region(mesh, "stand", still);
  add_vertex_region(mesh, "slide", sliding);
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.materials[0].elastic = elastic(Law::corotational, modulus_MPa, 0);
  spec.fixed = {{{std::string("stand"), {}}}, {{std::string("slide"), {}}, {false, true, true}}};
  spec.rigid = {{{std::string("x_high"), {}}, "cap"}};
  spec.markers = {{"end", {std::string("x_high"), {}}}};
  std::vector<Vec3> points{{2, 5, 5}};
  for (int i = 0; i < 4; ++i) points.emplace_back(6 + 5 * i, 5, 5 + (i % 2 == 0 ? height_mm : -height_mm));
  points.emplace_back(28, 5, 5);
  points.emplace_back(60, 5, 5);
  ActuatorSpec tendon = cable("tendon", points);
  spec.actuators = {by_length ? tendon : by_load(tendon, 0, 20)};
  spec.actuators[0].as<CableSpec>()->friction = friction;
  return spec;
}

/// Sum of the angles by which a polyline turns.
double wrapped(const std::vector<Vec3>& points) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    sum += std::acos(
        std::clamp((points[i] - points[i - 1]).normalized().dot((points[i + 1] - points[i]).normalized()), -1.0, 1.0));
  return sum;
}

double wrapped(const Actuator& actuator, const Points& positions) {
  std::vector<Vec3> points;
  for (const EmbeddedPoint& point : actuator.as<CableDrive>()->points) points.push_back(point.at(positions));
  return wrapped(points);
}

/// What presses the free half together, by how much shorter it is.
double end_force(const Model& model, const Equilibrium& found) {
  return modulus_MPa * area_mm2 * (60 - marker_at(model, found)[0]) / free_mm;
}

Equilibrium pulled(const Statics& statics, const Equilibrium& from, double command) {
  const Equilibrium found = statics.solve(values({command}), from.state, tight());
  EXPECT_EQ(found.report.status, Status::converged) << command << ": " << found.report.remark;
  return found;
}

/// What a capstan leaves of a tension that goes to and fro.
class Eytelwein {
 public:
  explicit Eytelwein(double exponent) : max_(std::exp(-exponent)) {}
  double end(double tension) {
    end_ = std::clamp(end_, tension * max_, tension / max_);
    return end_;
  }

 private:
  double max_, end_ = 0;
};

/// An arm that a tendon through its whole length bends.
RobotSpec arm(double friction, bool quadratic = true) {
  RobotSpec spec = physical_robot(quadratic ? block_mesh({10, 1, 2}, {80, 6, 8}) : block_mesh({20, 2, 4}, {80, 6, 8}));
  spec.mesh_options.quadratic = quadratic;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 3, 0.4);
  spec.markers = {{"tip", {std::string("x_high"), {}}}};
  ActuatorSpec tendon = by_load(cable("upper", {{0, 3, 7}, {80, 3, 7}}), 0, 10);
  tendon.as<CableSpec>()->spacing = 8;
  tendon.as<CableSpec>()->friction = friction;
  spec.actuators = {tendon};
  return spec;
}

}  // namespace

/// Five angles, to and fro: the limits of the band, and what the loop encloses.
TEST(Tendons, CapstanToAndFro) {
  for (const double height : {0.5, 1.0, 2.0, 3.0, 4.0}) {
    const Model model = compile(capstan(height, 0.3));
    const Statics statics(model);
    const double exponent = 0.3 * wrapped(model.actuators[0], model.rest);
    Eytelwein expected(exponent);
    Equilibrium found = solve_converged(statics, values({0}));
    double loop = 0, loop_expected = 0, last_end = 0, last_expected = 0, last = 0;
    std::vector<double> commands;
    for (int i = 1; i <= 12; ++i) commands.push_back(0.5 * i);
    for (int i = 11; i >= 0; --i) commands.push_back(0.5 * i + 0.02);
    for (const double command : commands) {
      found = pulled(statics, found, command);
      const double end = end_force(model, found), wanted = expected.end(command);
      const auto tendon = statics.measured(found.state).tendons.at(0);
      ASSERT_TRUE(tendon);
      EXPECT_NEAR(tendon->end_N, end, 1e-6 * end) << command;
      // exact when it slips; when it sticks it yields by the creep, 1e-4 of its length
      const double creeps = 2 * 1e-4 * model.actuators[0].rest_measure * modulus_MPa * area_mm2 / free_mm;
      EXPECT_NEAR(end, wanted, tendon->sticks > 0 ? creeps + 1e-3 * wanted : 1e-3 * wanted)
          << height << ", " << command;
      loop += 0.5 * (end + last_end) * (command - last);
      loop_expected += 0.5 * (wanted + last_expected) * (command - last);
      last_end = end;
      last_expected = wanted;
      last = command;
    }
    EXPECT_NEAR(loop, loop_expected, 0.01 * std::abs(loop_expected)) << height;
  }
}

/// Before anything slips farther than the creep, tensions are in the middle of the band.
TEST(Tendons, BeginInTheMiddle) {
  const Model model = compile(capstan(3, 0.3));
  const Statics statics(model);
  const double exponent = 0.3 * wrapped(model.actuators[0], model.rest), creep = 1e-4 * model.actuators[0].rest_measure;
  for (const double tension : {1e-4, 1e-3, 3e-3}) {
    const double found = end_force(model, solve_converged(statics, values({tension})));
    double low = 0, high = tension;  // of F = T exp(-mu theta y), by the slip of the spring that F presses
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high), slip = middle * free_mm / (modulus_MPa * area_mm2) / creep;
      (middle < tension * std::exp(-exponent * std::min(slip, 1.0)) ? low : high) = middle;
    }
    EXPECT_NEAR(found, low, 2e-4 * low) << tension;
  }
}

/// The same under length control: the tension at the motor is then a result.
TEST(Tendons, CapstanByLength) {
  const Model by_load_model = compile(capstan(3, 0.3)), model = compile(capstan(3, 0.3, true));
  const Statics by_load(by_load_model), statics(model);
  const double factor = std::exp(0.3 * wrapped(model.actuators[0], model.rest));
  Equilibrium found = solve_converged(statics, values({1}));
  for (const double ratio : {0.99, 0.97, 0.95}) {
    found = pulled(statics, found, ratio);
    EXPECT_NEAR(found.state.multipliers[0], factor * end_force(model, found), 1e-3 * found.state.multipliers[0]);
  }
  const Equilibrium same = solve_converged(by_load, values({found.state.multipliers[0]}));
  EXPECT_LT(distance(same.state.positions, found.state.positions), 1e-5);
  const double end = end_force(model, found);
  found = pulled(statics, found, 0.952);  // farther back than the creep
  EXPECT_LT(end_force(model, found), end);
  EXPECT_NEAR(found.state.multipliers[0], end_force(model, found) / factor, 1e-3 * found.state.multipliers[0]);
}

/// A sheath outside of the robot turns by an angle that does not change.
TEST(Tendons, Sheath) {
  RobotSpec spec = capstan(1, 0);
  spec.actuators[0].as<CableSpec>()->sheath_friction = 0.1;
  spec.actuators[0].as<CableSpec>()->sheath_turns_degrees = 270;
  const Model model = compile(spec);
  const Statics statics(model);
  Equilibrium found = solve_converged(statics, values({0}));
  Eytelwein expected(0.1 * 1.5 * 3.14159265358979);
  for (const double command : {3.0, 6.0, 5.0, 2.0, 1.0}) {
    found = pulled(statics, found, command);
    EXPECT_NEAR(end_force(model, found), expected.end(command), 0.012 * command) << command;
  }
}

/// Where an arm bends, its tendon turns in it; going on, back, and on again.
TEST(Tendons, TensionsFallAlongABentArm) {
  for (const bool quadratic : {true, false}) {
    const Model model = compile(arm(0.2, quadratic)), smooth = compile(arm(0, quadratic));
    const Statics statics(model), without(smooth);
    const double free = marker_at(smooth, solve_converged(without, values({2})))[2];
    Equilibrium found = solve_converged(statics, values({0}));
    double on = 0, back = 0;
    for (const double tension : {0.5, 1.0, 1.5, 2.0, 2.5, 3.0}) {
      found = pulled(statics, found, tension);
      if (tension == 2.0) on = marker_at(model, found)[2];
      const auto tendon = statics.measured(found.state).tendons.at(0);
      const double exponent = 0.2 * wrapped(model.actuators[0], found.state.positions);
      EXPECT_EQ(tendon->sticks, 0);
      EXPECT_NEAR(tendon->end_N, tension * std::exp(-exponent), 1e-3 * tension);
    }
    const Points farthest = found.state.positions;
    found = pulled(statics, found, 2.9);
    EXPECT_LT(distance(found.state.positions, farthest), 1.0);  // far less than without friction
    for (const double tension : {2.0, 1.0, 0.5, 1.0, 2.0}) {
      found = pulled(statics, found, tension);
      if (tension == 2.0 && back == 0) back = marker_at(model, found)[2];
    }
    const double again = marker_at(model, found)[2];
    EXPECT_GT(std::abs(back - free), 0.1);
    EXPECT_LT((on - free) * (back - free), 0) << "friction lags, on the way and back";
    EXPECT_NEAR(again, on, 0.2 * std::abs(on - back));
  }
}

/// Asked for again and again, what sticks stays.
TEST(Tendons, StayWhereTheyStick) {
  const Model model = compile(arm(0.2));
  const Statics statics(model);
  Equilibrium found = solve_converged(statics, values({3}));
  EXPECT_EQ(statics.measured(pulled(statics, found, 2.95).state).tendons.at(0)->sticks, 1);
  found = pulled(statics, found, 2.8);
  const Points first = found.state.positions;
  for (int i = 0; i < 20; ++i) {
    found = pulled(statics, found, 2.81);
    found = pulled(statics, found, 2.8);
  }
  EXPECT_LT(distance(found.state.positions, first), 2e-3);
}

/// Steps of different lengths on the same path lead to the same shape.
TEST(Tendons, StepsDoNotMatter) {
  const Model model = compile(arm(0.3));
  const Statics statics(model);
  const Equilibrium once = pulled(statics, solve_converged(statics, values({3})), 1.0);
  Equilibrium found = solve_converged(statics, values({0}));
  for (int i = 1; i <= 12; ++i) found = pulled(statics, found, 0.25 * i);
  for (int i = 1; i <= 16; ++i) found = pulled(statics, found, 3 - 0.125 * i);
  EXPECT_LT(distance(found.state.positions, once.state.positions), 0.02);
}

/// Derivatives are those of going on.
TEST(Tendons, Derivatives) {
  for (const bool by_length : {false, true}) {
    RobotSpec spec = arm(0.2);
    if (by_length) {
      spec.actuators[0].control = Control::ratio;
      spec.actuators[0].low = 0.5;
      spec.actuators[0].high = 1;
      spec.actuators[0].rest = 1;
    }
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, values({by_length ? 0.95 : 2.0}));
    const Sensitivity derivative = statics.sensitivity(found.state);
    ASSERT_TRUE(derivative.regular);
    const Difference difference = one_sided(statics, found.state, 0, by_length ? -1e-3 : 1e-2);
    EXPECT_LT(off_by(derivative.positions[0], difference.positions), 1e-5);
    EXPECT_LT(off_by(derivative.multipliers, difference.multipliers), 1e-5);
  }
}

TEST(Tendons, RefusesANegativeFriction) {
  EXPECT_THROW((void)compile(capstan(1, -0.1)), InvalidInput);
}

}  // namespace softkin
