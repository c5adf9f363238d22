#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/physical/magnets.hpp>

#include "statics/difference.hpp"
#include "statics/magnetic_samples.hpp"

/// Energy, forces and stiffness of a magnetic body by differences; loads and symmetry.

namespace softkin {

namespace {

using namespace testing;

enum class ElementKind { linear, quadratic, prisms };

RobotSpec magnetic_robot(ElementKind elements, Magnetisation magnetisation) {
  const Split split = elements == ElementKind::prisms ? Split::prisms : Split::six;
  RobotSpec spec = physical_robot(block_mesh({2, 1, 1}, {20, 8, 6}, split));
  spec.mesh_options.quadratic = elements == ElementKind::quadratic;
  magnetise(spec, {120, -40, 70}, magnetisation);
  return spec;
}

/// Every kind of source.
RobotSpec in_all_fields(ElementKind elements, Magnetisation magnetisation) {
  RobotSpec spec = magnetic_robot(elements, magnetisation);
  add_uniform(spec);
  add_field(spec, {"coil", two_loops({5, 0, 20})}, {FieldCommand::current});
  const auto wave = [](const Vec3& p) {
    return Vec3(std::sin(0.1 * p.x()), std::cos(0.2 * p.y()), 0.1 * p.z() * p.x());
  };
  add_field(spec, {"grid", sampled(wave, {-10, -10, -10}, {30, 20, 20}, {6, 6, 6})}, {FieldCommand::current});
  add_field(spec, {"magnet", DipoleField{{10, -30, 12}, {0.1, 0.3, -0.2}}},
            {FieldCommand::position_x, FieldCommand::position_y, FieldCommand::position_z, FieldCommand::moment_x,
             FieldCommand::moment_y, FieldCommand::moment_z});
  return spec;
}

struct MagneticSample {
  explicit MagneticSample(const RobotSpec& spec) : model(compile(spec)), body(model), team(1) {
    body.add_cliques(cliques);
    magnets = std::make_unique<physical::Magnets>(model, body.element_slots());
    positions = model.rest + noise(model.rest.rows(), 0.3, 3);
    load_state.actuation = model.rest_actuation();
  }

  [[nodiscard]] Points gradient(const physical::LoadState& at, const Points& shape, double* energy = nullptr) {
    Points sum = Points::Zero(shape.rows(), 3);
    physical::Term::Sum all{sum};
    magnets->evaluate({shape, {}}, at, none, all, team);
    EXPECT_FALSE(all.left_field);
    if (energy) *energy = all.energy;
    return sum;
  }
  [[nodiscard]] Points gradient(const Points& shape) { return gradient(load_state, shape); }
  [[nodiscard]] double energy(const Points& shape) {
    double value = 0;
    (void)gradient(load_state, shape, &value);
    return value;
  }
  [[nodiscard]] Points stiffness_times(const Points& vectors, bool projected) {
    const linear::BlockPattern pattern(model.rest.rows(), cliques);
    LargeVector<double> slots(9 * static_cast<std::size_t>(cliques.slots.back())), blocks;
    std::fill(slots.begin(), slots.end(), 0.0);
    magnets->stiffness({positions, {}}, load_state, projected, none, slots, team);
    pattern.gather(slots, blocks, team);
    Points product;
    pattern.multiply(blocks, vectors, product, team);
    return product;
  }

  Model model;
  physical::Body body;
  Team team;
  linear::Cliques cliques;
  std::unique_ptr<physical::Magnets> magnets;
  physical::Term::Scratch none;
  Points positions;
  physical::LoadState load_state;
};

/// Commands that let one kind of field act.
Actuation commands(const Model& model, const std::string& of, double value) {
  Actuation actuation = model.rest_actuation();
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (model.actuators[a].name.starts_with(of) && !places_dipole(model.actuators[a].as<MagneticDrive>()->command))
      actuation[a] = value + 0.3 * value * static_cast<double>(a);
  return actuation;
}

/// A turn of everything: mesh, supports as they are, remanence and fields.
RobotSpec turned(RobotSpec spec, const Mat3& turn) {
  spec.mesh.vertices = (spec.mesh.vertices * turn.transpose()).eval();
  magnetise(spec, turn * spec.materials[0].remanence->uniform, spec.materials[0].remanence->magnetisation);
  for (ActuatorSpec& actuator : spec.actuators) {
    auto& field = *actuator.as<FieldSpec>();
    FieldSource source = *field.source;
    if (auto* uniform = std::get_if<UniformField>(&source.field)) uniform->direction = turn * uniform->direction;
    if (auto* coil = std::get_if<CoilField>(&source.field))
      for (CoilLoop& loop : coil->loops) {
        loop.center = turn * loop.center;
        loop.axis = turn * loop.axis;
      }
    field.source = std::make_shared<const FieldSource>(source);
  }
  return spec;
}

}  // namespace

TEST(Magnets, ForcesAreMinusTheGradientOfTheEnergy) {
  for (const Magnetisation magnetisation : both_magnetisations)
    for (const ElementKind elements : {ElementKind::linear, ElementKind::quadratic, ElementKind::prisms})
      for (const char* of : {"uniform", "coil", "grid", "magnet"}) {
        MagneticSample sample(in_all_fields(elements, magnetisation));
        sample.load_state.actuation = commands(sample.model, of, 2);
        const Points exact = sample.gradient(sample.positions);
        const Points slope =
            difference([&](const Points& shape) { return sample.energy(shape); }, sample.positions, 1e-3);
        EXPECT_GT(exact.norm(), 1e-6) << of;
        EXPECT_LT((slope - exact).norm(), 1e-6 * exact.norm()) << of << static_cast<int>(elements);
      }
}

TEST(Magnets, StiffnessIsTheSlopeOfTheForces) {
  for (const Magnetisation magnetisation : both_magnetisations)
    for (const ElementKind elements : {ElementKind::linear, ElementKind::quadratic, ElementKind::prisms})
      for (const char* of : {"uniform", "coil", "grid", "magnet"}) {
        MagneticSample sample(in_all_fields(elements, magnetisation));
        sample.load_state.actuation = commands(sample.model, of, 2);
        const Points along = noise(sample.model.rest.rows(), 1, 7);
        const Points exact = sample.stiffness_times(along, false);
        const Points slope =
            change_along([&](const Points& shape) { return sample.gradient(shape); }, sample.positions, along, 1e-4);
        // forces of a uniform field on remanence that stretches with the material do not depend on the shape
        const bool dead = magnetisation == Magnetisation::stretches && std::string(of) == "uniform";
        EXPECT_EQ(exact.norm() < 1e-7, dead) << of;
        EXPECT_LT((slope - exact).norm(), dead ? 1e-9 : 2e-6 * exact.norm()) << of << static_cast<int>(elements);
      }
}

/// The projected stiffness is no smaller than the exact one along any direction, and not negative, for all field
/// directions.
TEST(Magnets, ProjectedStiffnessIsPositive) {
  for (const Magnetisation magnetisation : both_magnetisations)
    for (const char* of : {"magnet", "uniform"})
      for (const double value : {2.0, -2.0}) {
        MagneticSample sample(in_all_fields(ElementKind::quadratic, magnetisation));
        sample.load_state.actuation = commands(sample.model, of, value);
        for (unsigned seed = 1; seed < 10; ++seed) {
          const Points along = noise(sample.model.rest.rows(), 1, seed);
          const double exact = along.cwiseProduct(sample.stiffness_times(along, false)).sum();
          const double positive = along.cwiseProduct(sample.stiffness_times(along, true)).sum();
          EXPECT_GE(positive, std::max(0.0, exact) - 1e-12) << of << value;
        }
      }
}

TEST(Magnets, AUniformFieldPullsAtWhatStretchesWithDeadForces) {
  MagneticSample sample(in_all_fields(ElementKind::quadratic, Magnetisation::stretches));
  sample.load_state = {commands(sample.model, "uniform", 30), 0};
  EXPECT_TRUE(sample.stiffness_times(sample.positions, false).isZero(0));
  EXPECT_EQ(sample.gradient(sample.positions), sample.gradient(sample.model.rest));
}

/// A body that is turned and stretched evenly: of F = R U what turns has the moment R m, what stretches F m.
TEST(Magnets, MomentsTurnAndStretchWithTheBody) {
  const Mat3 turn = Eigen::AngleAxisd(2.3, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  Mat3 stretch;
  stretch << 1.3, 0.2, -0.1, 0.2, 0.8, 0.15, -0.1, 0.15, 0.9;
  const Mat3 deformation = turn * stretch;
  for (const Magnetisation magnetisation : both_magnetisations)
    for (const ElementKind elements : {ElementKind::linear, ElementKind::quadratic, ElementKind::prisms}) {
      MagneticSample sample(in_all_fields(elements, magnetisation));
      sample.load_state = {commands(sample.model, "uniform", 30), 0};
      const Points shape = sample.model.rest * deformation.transpose();
      const Vec3 field = sample.load_state.actuation.head<3>();
      const Mat3& carrier = magnetisation == Magnetisation::turns ? turn : deformation;
      const Vec3 moment = carrier * (inverse_permeability * 20 * 8 * 6 * Vec3(120, -40, 70));
      EXPECT_NEAR(sample.energy(shape), -moment.dot(field), 1e-12 * moment.norm() * field.norm());
      const MagneticLoad load = sample.magnets->load(sample.load_state, shape, sample.team);
      EXPECT_LT(load.force.norm(), 1e-14);
      EXPECT_LT((load.moment - moment.cross(field)).norm(), 1e-12 * load.moment.norm());
      EXPECT_LT((load.center - deformation * Vec3(10, 4, 3)).norm(), 1e-12);
    }
}

/// Where two stretches of one size are mirrored the rotation is not unique; nothing is infinite or no number.
TEST(Magnets, TurnedInsideOutTheyAreFinite) {
  MagneticSample sample(in_all_fields(ElementKind::linear, Magnetisation::turns));
  sample.load_state.actuation = commands(sample.model, "uniform", 2);
  for (const Vec3& scale : {Vec3(1, 1, -1), Vec3(1, 0, 0), Vec3(0, 0, 0), Vec3(-1, -2, -3)}) {
    sample.positions = sample.model.rest * scale.asDiagonal();
    EXPECT_TRUE(sample.gradient(sample.positions).allFinite()) << scale;
    for (const bool projected : {false, true})
      EXPECT_TRUE(sample.stiffness_times(sample.model.rest, projected).allFinite()) << scale;
  }
}

/// Compares derivatives by every command, including those that scale a field.
TEST(Magnets, CommandForcesAreTheSlopesByTheCommands) {
  for (const Magnetisation magnetisation : both_magnetisations) {
    MagneticSample sample(in_all_fields(ElementKind::quadratic, magnetisation));
    sample.load_state = {commands(sample.model, "magnet", 0.2), 0.7};
    sample.load_state.actuation += commands(sample.model, "coil", 1.5) - sample.model.rest_actuation();
    for (Index a = 0; a < std::ssize(sample.model.actuators); ++a) {
      Points exact = Points::Zero(sample.positions.rows(), 3);
      sample.magnets->add_derivative(a, sample.load_state, sample.positions, sample.none, exact, sample.team);
      physical::LoadState high = sample.load_state, low = sample.load_state;
      high.actuation[a] += 1e-3;
      low.actuation[a] -= 1e-3;
      const Points slope = (sample.gradient(high, sample.positions) - sample.gradient(low, sample.positions)) / 2e-3;
      EXPECT_GT(exact.norm(), 1e-9) << a;
      EXPECT_LT((slope - exact).norm(), 1e-6 * exact.norm()) << sample.model.actuators[a].name;
    }
  }
}

TEST(Magnets, TheirEnergyTurnsAndMovesWithTheField) {
  for (const Magnetisation magnetisation : both_magnetisations) {
    RobotSpec spec = magnetic_robot(ElementKind::quadratic, magnetisation);
    add_field(spec, {"uniform", UniformField{{1, 2, 3}}}, {FieldCommand::flux_density});
    add_field(spec, {"coil", two_loops({5, 0, 20})}, {FieldCommand::current});
    const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
    MagneticSample one(spec), other(turned(spec, turn));
    one.load_state.actuation = other.load_state.actuation = values({20, 3});
    const Points shape = one.positions * turn.transpose();
    EXPECT_NEAR(one.energy(one.positions), other.energy(shape), 1e-12 * std::abs(one.energy(one.positions)));
    EXPECT_LT((one.gradient(one.positions) * turn.transpose() - other.gradient(shape)).norm(),
              1e-12 * one.gradient(one.positions).norm());
  }
}

TEST(MagneticRobots, TurningRobotAndFieldTurnsTheAnswer) {
  for (const Magnetisation magnetisation : both_magnetisations) {
    RobotSpec spec = physical_robot(block_mesh({8, 2, 1}, {24, 4, 2}));
    spec.materials[0].elastic->youngs_modulus = 0.1;
    spec.fixed = {{{Box{{-1, -1, -1}, {0.1, 9, 9}}, {}}}};
    magnetise(spec, {100, 30, 0}, magnetisation);
    add_field(spec, {"uniform", UniformField{{0, 1, 3}}}, {FieldCommand::flux_density});
    add_field(spec, {"coil", two_loops({20, 0, 30})}, {FieldCommand::current});
    const Mat3 turn = Eigen::AngleAxisd(2.1, Vec3(3, -2, 1).normalized()).toRotationMatrix();
    RobotSpec other = turned(spec, turn);
    std::vector<Index> base;
    for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
      if (spec.mesh.vertices(v, 0) < 0.1) base.push_back(v);
    other.fixed = {{{VertexList{base}, {}}}};
    const Model first = compile(spec), second = compile(other);
    const Statics one(first), two(second);
    const Actuation actuation = values({12, 0.5});
    const Points shape = solve_converged(one, actuation, tight(1e-11)).state.positions;
    EXPECT_GT(distance(shape, first.rest), 3);
    EXPECT_LT(distance(shape * turn.transpose(), solve_converged(two, actuation, tight(1e-11)).state.positions), 1e-9);
  }
}

/// A magnet on a thin, soft strip turns until it lies along the field, and little is left that would turn it.
TEST(MagneticRobots, AMagnetThatIsFreeToTurnSettlesAlongTheField) {
  for (const Magnetisation magnetisation : both_magnetisations) {
    RobotSpec spec = physical_robot(block_mesh({12, 1, 1}, {24, 4, 1}));
    add_volume_region(spec.mesh, "magnet", [](const Vec3& p) { return p.x() > 16; });
    spec.mesh_options.quadratic = true;
    spec.materials[0].elastic->youngs_modulus = 0.02;
    MaterialSpec magnet = spec.materials[0];
    magnet.region = "magnet";
    magnet.elastic->youngs_modulus = 5;
    RemanenceSpec along;
    along.uniform = {150, 0, 0};
    along.magnetisation = magnetisation;
    magnet.remanence = std::make_shared<const RemanenceSpec>(along);
    spec.materials.push_back(magnet);
    const Vec3 direction = Vec3(0.3, 0, 1).normalized();
    add_field(spec, {"field", UniformField{direction}}, {FieldCommand::flux_density});
    spec.markers = {{"near", {Vec3(17, 2, 0.5), {}}}, {"far", {Vec3(23, 2, 0.5), {}}}};
    const Model model = compile(spec);
    const Statics statics(model);
    double last = 1;
    for (const double flux : {2.0, 20.0, 200.0}) {
      const Equilibrium found = solve_converged(statics, values({flux}));
      const Vec3 lies = (marker_at(model, found, 1) - marker_at(model, found, 0)).normalized();
      const double apart = std::acos(std::min(1.0, lies.dot(direction)));
      EXPECT_LT(apart, 0.35 * last) << flux;
      last = apart;
    }
    EXPECT_LT(last, 0.02);
  }
}

TEST(MagneticRobots, SensitivitiesAreTheSlopesOfSolves) {
  for (const Magnetisation magnetisation : both_magnetisations) {
    RobotSpec spec = magnetic_robot(ElementKind::linear, magnetisation);
    spec.materials[0].elastic->youngs_modulus = 0.05;
    add_uniform(spec);
    add_field(spec, {"coil", two_loops({5, 0, 20})}, {FieldCommand::current});
    add_field(spec, {"magnet", DipoleField{{10, -30, 12}, {0.1, 0.3, -0.2}}},
              {FieldCommand::position_y, FieldCommand::moment_z});
    const Model model = compile(spec);
    const Statics statics(model);
    const Actuation actuation = values({5, -8, 10, 0.6, -28, 0.4});
    const Equilibrium found = solve_converged(statics, actuation, tight(1e-12));
    EXPECT_GT(distance(found.state.positions, model.rest), 0.3);
    const Sensitivity exact = statics.sensitivity(found.state);
    ASSERT_TRUE(exact.regular);
    for (Index a = 0; a < actuation.size(); ++a) {
      const double reach = 2e-4 * std::max(1.0, std::abs(actuation[a]));
      Points sides[2];
      for (int side = 0; side < 2; ++side) {
        Actuation changed = actuation;
        changed[a] += side == 0 ? reach : -reach;
        sides[side] = statics.solve(changed, found.state, tight(1e-12)).state.positions;
      }
      const Points slope = (sides[0] - sides[1]) / (2 * reach);
      EXPECT_LT((slope - exact.positions[a]).norm(), 1e-5 * slope.norm()) << model.actuators[a].name;
    }
  }
}

/// A permanent magnet that is present from the start acts from the start; a robot that leaves its grid is reported.
TEST(MagneticRobots, AWayEndsWhereTheGridDoes) {
  RobotSpec spec = physical_robot(block_mesh({8, 1, 1}, {24, 4, 2}));
  spec.materials[0].elastic->youngs_modulus = 0.05;
  magnetise(spec, {100, 0, 0});
  const auto field = [](const Vec3&) { return Vec3(0, 0, 1); };
  add_field(spec, {"grid", sampled(field, {-5, -5, -5}, {30, 10, 6}, {5, 5, 5})}, {FieldCommand::current});
  const Model model = compile(spec);
  const Statics statics(model);
  EXPECT_EQ(statics.solve(values({1}), statics.rest(), tight()).report.status, Status::converged);
  const Equilibrium found = statics.solve(values({50}), statics.rest(), tight());
  EXPECT_EQ(found.report.status, Status::limit);
  EXPECT_NE(found.report.remark.find("outside its grid"), std::string::npos) << found.report.remark;
  EXPECT_LT(found.state.positions.col(2).maxCoeff(), 7);
}

/// A field bends a strip onto a floor: the strip stays above it, and the forces of floor and base add up to zero, since
/// a uniform field has no resultant force.
TEST(MagneticRobots, AFieldPressesARobotOntoAFloor) {
  RobotSpec spec = physical_robot(block_mesh({12, 2, 1}, {24, 4, 1}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic->youngs_modulus = 0.3;
  magnetise(spec, {100, 0, 0});
  add_field(spec, {"field", UniformField{{0, 0, -1}}}, {FieldCommand::flux_density});
  const Model free = compile(spec);
  constexpr double deep = -4;
  EXPECT_LT(solve_converged(Statics(free), values({8})).state.positions.col(2).minCoeff(), 2 * deep);
  ContactSpec contact;
  contact.distance_mm = 0.05;
  contact.obstacles = {{"floor", Halfspace{{0, 0, deep}, {0, 0, 1}}, std::nullopt, {}}};
  spec.contact = contact;
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({8}));
  const double lowest = found.state.positions.topRows(free.rest.rows()).col(2).minCoeff();
  EXPECT_GT(lowest, deep);
  EXPECT_LT(lowest, deep + 0.05);
  const ElementDeformation measured = statics.measured(found.state);
  ASSERT_TRUE(measured.contacts.has_value());
  ASSERT_EQ(measured.contacts->pairs.size(), 1u);
  const double borne = measured.contacts->pairs[0].normal_N;
  EXPECT_GT(borne, 1e-3);
  const std::vector<Reaction> held = reactions(model, found.state.positions, measured);
  EXPECT_NEAR(held[0].force.z(), -borne, 1e-6 * borne);
  EXPECT_LT(std::hypot(held[0].force.x(), held[0].force.y()), 1e-6 * borne);
}

}  // namespace softkin
