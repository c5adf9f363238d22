#include <softkin/core/error.hpp>

#include "statics/magnetic_samples.hpp"
#include "statics/sensitivity_samples.hpp"

/// Derivatives of equilibria by numbers of the robot, against differences of equilibria.

namespace softkin {

namespace {

using namespace testing;

/// A number of a robot: adds to it.
struct Number {
  const char* name;
  std::function<void(RobotSpec&, double)> add;
  double size;  // what it is of the order of
};

Model changed(const RobotSpec& spec, const Number& number, double by) {
  RobotSpec other = spec;
  number.add(other, by);
  return compile(other);
}

/// The robots with a little more and a little less of each number.
struct Beside {
  std::vector<Model> models;
  std::vector<Perturbed> perturbed;

  Beside(const RobotSpec& spec, const std::vector<Number>& numbers) {
    models.reserve(2 * numbers.size());
    for (const Number& number : numbers) {
      const double half = 1e-5 * number.size;
      const Model& more = models.emplace_back(changed(spec, number, half));
      const Model& less = models.emplace_back(changed(spec, number, -half));
      perturbed.push_back({more, less, 2 * half});
    }
  }
};

/// Fourth-order differences of the equilibria of four other robots.
struct NumberDifference : Difference {
  Points reactions;
};

NumberDifference difference_by(const RobotSpec& spec, const Number& number, const State& at) {
  const double step = 3e-3 * number.size, h = 1 / (12 * step);
  NumberDifference sum{{Points::Zero(at.positions.rows(), 3), Eigen::VectorXd::Zero(at.actuation.size())},
                       Points::Zero(at.positions.rows(), 3)};
  for (const auto& [steps, weight] : {std::pair{-2, h}, std::pair{-1, -8 * h}, std::pair{1, 8 * h}, std::pair{2, -h}}) {
    const Model model = changed(spec, number, steps * step);
    State start;
    start.positions = has_friction(model) ? model.rest : at.positions;  // friction depends on the path
    const Statics statics(model);
    const Equilibrium found = statics.solve(at.actuation, start, tight(1e-10));
    EXPECT_EQ(found.report.status, Status::converged) << number.name << ": " << found.report.remark;
    sum.positions += weight * found.state.positions;
    sum.multipliers += weight * found.state.multipliers;
    sum.reactions += weight * statics.measured(found.state).reactions;
  }
  return sum;
}

void expect_derivatives(const RobotSpec& spec, const Actuation& actuation, const std::vector<Number>& numbers,
                        double tolerance = 1e-6) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, actuation, tight(1e-10));
  const Beside beside(spec, numbers);
  const ParameterSensitivity slopes = Perturbations(statics, beside.perturbed).at(found.state, {}, 1e-8, true);
  ASSERT_TRUE(slopes.regular);
  for (std::size_t p = 0; p < numbers.size(); ++p) {
    const NumberDifference expected = difference_by(spec, numbers[p], found.state);
    EXPECT_GT(expected.positions.cwiseAbs().maxCoeff() * numbers[p].size, 1e-6) << numbers[p].name;
    EXPECT_LT(off_by(slopes.positions[p], expected.positions), tolerance) << numbers[p].name;
    EXPECT_LE((slopes.reactions[p] - expected.reactions).cwiseAbs().maxCoeff(),
              10 * tolerance * expected.reactions.cwiseAbs().maxCoeff() + 1e-8 / numbers[p].size)
        << numbers[p].name;
    const Eigen::VectorXd multipliers = slopes.multipliers.col(p);
    EXPECT_LE((multipliers - expected.multipliers).cwiseAbs().maxCoeff(),
              tolerance * expected.multipliers.cwiseAbs().maxCoeff() + 1e-9 / numbers[p].size)
        << numbers[p].name;
  }
}

/// Compares the gradient of a weighted sum over the shape, with a few asymmetric weights, with differences of
/// equilibria.
void expect_gradients(const RobotSpec& spec, const Actuation& actuation, const std::vector<Number>& numbers,
                      double tolerance = 1e-6) {
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, actuation, tight(1e-10));
  const Beside beside(spec, numbers);
  Points weights(model.rest.rows(), 3);
  for (Eigen::Index i = 0; i < weights.size(); ++i) weights.data()[i] = std::sin(1 + 0.7 * static_cast<double>(i));
  const Eigen::VectorXd by_loads = Eigen::VectorXd::LinSpaced(actuation.size(), 0.5, -1.5);
  const Eigen::MatrixXd slopes = Perturbations(statics, beside.perturbed)
                                     .gradients(found.state, {{weights, {}}, {{}, by_loads}, {weights, by_loads}});
  ASSERT_EQ(slopes.cols(), static_cast<Eigen::Index>(numbers.size()));
  for (std::size_t p = 0; p < numbers.size(); ++p) {
    const NumberDifference by = difference_by(spec, numbers[p], found.state);
    const double places = weights.cwiseProduct(by.positions).sum(), loads = by_loads.dot(by.multipliers);
    const double size = by.positions.cwiseAbs().sum(), load_size = by.multipliers.cwiseAbs().sum();
    const auto row = slopes.col(p);
    EXPECT_NEAR(row[0], places, tolerance * size) << numbers[p].name;
    EXPECT_NEAR(row[1], loads, tolerance * load_size + 1e-9 / numbers[p].size) << numbers[p].name;
    EXPECT_NEAR(row[2], row[0] + row[1], 1e-7 * (size + load_size)) << numbers[p].name;
  }
}

RobotSpec loaded_finger() {
  RobotSpec spec = bending_finger();
  spec.actuators.push_back(cable("tendon", {{2, 6, 14}, {31.4, 6.3, 13.2}, {58, 6, 14}}));
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 0, -9.81};
  spec.loads.forces.push_back({"payload", {std::string("x_high"), {}}, {0.002, 0, -0.01}});
  spec.loads.tractions = {{"water", {std::string("y_high"), {}}, true, {0, 0, 0}, 0.5}};
  add_volume_region(spec.mesh, "root", [](const Vec3& p) { return p.x() < 20; });
  MaterialSpec root = spec.materials[0];
  root.region = "root";
  root.elastic = elastic(Law::yeoh, 1.4, 0.45);
  root.elastic->c20 = 0.02;
  spec.materials.push_back(root);
  spec.fixed[0].displacement = {0, 0, 1};
  return spec;
}

const std::vector<Number> numbers_of_finger{
    {"youngs_modulus", [](RobotSpec& s, double by) { *s.materials[0].elastic->youngs_modulus += by; }, 1},
    {"poisson_ratio", [](RobotSpec& s, double by) { *s.materials[0].elastic->poisson_ratio += by; }, 0.1},
    {"c10", [](RobotSpec& s, double by) { *s.materials[1].elastic->c10 += by; }, 0.2},
    {"c20", [](RobotSpec& s, double by) { *s.materials[1].elastic->c20 += by; }, 0.02},
    {"density", [](RobotSpec& s, double by) { s.materials[0].density += by; }, 1000},
    {"gravity", [](RobotSpec& s, double by) { s.loads.gravity.y() += by; }, 5},
    {"payload", [](RobotSpec& s, double by) { s.loads.forces[0].force.z() += by; }, 0.01},
    {"pressure", [](RobotSpec& s, double by) { s.loads.tractions[0].pressure_kPa += by; }, 0.5},
    {"displacement", [](RobotSpec& s, double by) { s.fixed[0].displacement.z() += by; }, 1},
    {"cable",
     [](RobotSpec& s, double by) { std::get<Vec3>(s.actuators[1].as<CableSpec>()->points[1].point).z() += by; }, 1}};

}  // namespace

TEST(Parameters, OfARobotDrivenByVolumeAndLength) {
  expect_derivatives(loaded_finger(), values({1.4, 0.93}), numbers_of_finger);
}

TEST(Parameters, OfARobotDrivenByPressureAndTension) {
  RobotSpec spec = loaded_finger();
  for (ActuatorSpec& actuator : spec.actuators) actuator = by_load(actuator);
  std::vector<Number> numbers = numbers_of_finger;
  numbers.push_back({"factor", [](RobotSpec& s, double by) { s.actuators[1].factor += by; }, 1});
  numbers.push_back({"offset", [](RobotSpec& s, double by) { s.actuators[0].offset += by; }, 5});
  expect_derivatives(spec, values({20, 0.2}), numbers);
}

TEST(Parameters, ByTheAdjoint) {
  expect_gradients(loaded_finger(), values({1.4, 0.93}), numbers_of_finger);
  RobotSpec spec = loaded_finger();
  for (ActuatorSpec& actuator : spec.actuators) actuator = by_load(actuator);
  std::vector<Number> numbers = numbers_of_finger;
  numbers.push_back({"factor", [](RobotSpec& s, double by) { s.actuators[1].factor += by; }, 1});
  expect_gradients(spec, values({20, 0.2}), numbers);
}

TEST(Parameters, OfATendonThatRubs) {
  RobotSpec spec = physical_robot(block_mesh({8, 1, 2}, {80, 6, 8}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::neo_hookean, 3, 0.4);
  const ActuatorSpec by_length = cable("tendon", {{0, 3, 7}, {80, 3, 7}});
  spec.actuators = {by_load(by_length)};
  spec.actuators[0].as<CableSpec>()->spacing = 11;
  spec.actuators[0].as<CableSpec>()->friction = 0.2;
  spec.actuators[0].as<CableSpec>()->sheath_friction = 0.1;
  spec.actuators[0].as<CableSpec>()->sheath_turns_degrees = 180;
  const std::vector<Number> numbers{
      {"youngs_modulus", [](RobotSpec& s, double by) { *s.materials[0].elastic->youngs_modulus += by; }, 1},
      {"friction", [](RobotSpec& s, double by) { s.actuators[0].as<CableSpec>()->friction += by; }, 0.2},
      {"sheath_friction", [](RobotSpec& s, double by) { s.actuators[0].as<CableSpec>()->sheath_friction += by; }, 0.1},
      {"factor", [](RobotSpec& s, double by) { s.actuators[0].factor += by; }, 1},
      {"cable",
       [](RobotSpec& s, double by) { std::get<Vec3>(s.actuators[0].as<CableSpec>()->points[0].point).z() += by; }, 1}};
  expect_derivatives(spec, values({3}), numbers);
  expect_gradients(spec, values({3}), {numbers[0], numbers[1]});
  const Model model = compile(spec);
  const Statics statics(model);
  const State at = solve_converged(statics, values({3}), tight(1e-10)).state;
  EXPECT_TRUE(statics.reciprocal_moves(at, {Points::Ones(at.positions.rows(), 3)}).empty());  // no adjoint of itself
  spec.actuators[0].control = by_length.control;
  spec.actuators[0].low = by_length.low;
  spec.actuators[0].high = by_length.high;
  spec.actuators[0].rest = by_length.rest;
  expect_derivatives(spec, values({0.95}), {numbers[1]});  // by length the others change the tension alone
}

TEST(Parameters, OfLayersUnderVoltage) {
  RobotSpec spec = physical_robot(block_mesh({6, 2, 2}, {24, 6, 1}, Split::prisms));
  spec.materials[0].elastic = elastic(Law::gent, 0.2, 0.45);
  spec.materials[0].elastic->jm = 3;
  spec.materials[0].permittivity = 4.7;
  add_volume_region(spec.mesh, "upper", [](const Vec3& p) { return p.z() > 0.5; });
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "upper"}, 0, 20, true);
  skin.control = Control::load;
  skin.rest = 0;
  skin.as<DeaSpec>()->prestretch = 1.1;
  spec.actuators = {skin};
  expect_differences_at(spec, values({8}));
  expect_derivatives(
      spec, values({8}),
      {{"permittivity", [](RobotSpec& s, double by) { *s.materials[0].permittivity += by; }, 4},
       {"prestretch", [](RobotSpec& s, double by) { s.actuators[0].as<DeaSpec>()->prestretch += by; }, 0.1},
       {"shear_modulus", [](RobotSpec& s, double by) { *s.materials[0].elastic->shear_modulus += by; }, 0.07}});
  constexpr double rounding = 3e-6;  // of the differences, as it changes little
  expect_derivatives(spec, values({8}), {{"jm", [](RobotSpec& s, double by) { *s.materials[0].elastic->jm += by; }, 3}},
                     rounding);
}

TEST(Parameters, OfMagnetsInFields) {
  RobotSpec spec = physical_robot(block_mesh({6, 1, 1}, {30, 6, 2}));
  magnetise(spec, {120, 0, 30}, Magnetisation::turns);
  add_uniform(spec);
  const auto remanence = [](RobotSpec& s, double by) {
    RobotSpec other = s;
    magnetise(other, {120, 0, 30 + by}, Magnetisation::turns);
    s.materials[0].remanence = other.materials[0].remanence;
  };
  expect_derivatives(spec, values({0, 0, 8}), {{"remanence", remanence, 30}});
}

TEST(Parameters, AreRefusedWhereMoreThanNumbersDiffers) {
  const RobotSpec spec = bending_finger();
  RobotSpec held = spec;
  held.fixed.push_back({{std::string("x_high"), {}}, {false, true, false}});
  const Model model = compile(spec), other = compile(held), moved = compile([&] {
                                                              RobotSpec s = spec;
                                                              s.mesh.vertices *= 1.01;
                                                              return s;
                                                            }());
  const Statics statics(model);
  EXPECT_THROW(Perturbations(statics, {{other, model, 1}}), InvalidInput);
  EXPECT_THROW(Perturbations(statics, {{moved, model, 1}}), InvalidInput);
  EXPECT_THROW(Perturbations(statics, {{model, model, 0}}), InvalidInput);
  EXPECT_THROW(Statics(other, statics), InvalidInput);
  const Model shapes = compile(finger_robot(true));
  EXPECT_THROW(Perturbations(Statics(shapes), {}), InvalidInput);
}

/// A robot that uses another one's sparsity patterns has the same equilibria.
TEST(Parameters, ARobotThatSharesPatternsHasTheSameEquilibria) {
  const RobotSpec spec = loaded_finger();
  RobotSpec softer = spec;
  *softer.materials[0].elastic->youngs_modulus = 0.7;
  const Model model = compile(spec), other = compile(softer);
  const Statics statics(model), alone(other), sharing(other, statics);
  const Equilibrium expected = solve_converged(alone, values({1.4, 0.93})),
                    found = solve_converged(sharing, values({1.4, 0.93}));
  EXPECT_LT(distance(found.state.positions, expected.state.positions), 1e-8);
  EXPECT_GT(distance(solve_converged(statics, values({1.4, 0.93})).state.positions, expected.state.positions), 0.01);
}

}  // namespace softkin
