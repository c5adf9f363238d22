#include <random>
#include <softkin/model/families.hpp>
#include <softkin/model/growth.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/statics/physical/contact_steps.hpp>

#include "statics/contact_scenes.hpp"
#include "statics/difference.hpp"
#include "statics/magnetic_samples.hpp"
#include "statics/physical_equations.hpp"
#include "statics/pillows.hpp"

/// Compares all terms of all kinds of robots with differences: gradient, stiffness, derivatives by commands and load
/// factor.

namespace softkin {

namespace {

using namespace testing;
using physical::Term;

constexpr int all_terms = 12;

/// Tetrahedra and prisms of two materials, a layer that is stretched, another one under voltage.
RobotSpec layered_robot() {
  RobotSpec spec = physical_robot(mixed_robot(true).mesh);
  spec.actuators = mixed_robot(true).actuators;
  for (const char* side : {"y_low", "y_high"}) spec.fixed.push_back({{std::string(side), {}}, {false, true, false}});
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 2, -9.81};
  return spec;
}

RobotSpec charged_sheet() {
  RobotSpec spec = physical_robot(block_mesh({4, 3, 1}, {8, 6, 0.5}, Split::prisms));
  spec.materials[0].elastic = elastic(Law::neo_hookean, 0.2, 0.45);
  spec.materials[0].permittivity = 4.7;
  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "all"}, 0, 20, true);
  skin.control = Control::load;
  skin.rest = 0;
  skin.as<DeaSpec>()->prestretch = 1.1;
  spec.actuators = {skin};
  return spec;
}

RobotSpec magnetic_robot(Magnetisation magnetisation, bool quadratic) {
  RobotSpec spec = physical_robot(block_mesh({2, 1, 1}, {20, 8, 6}));
  spec.mesh_options.quadratic = quadratic;
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 0, -9.81};
  magnetise(spec, {120, -40, 70}, magnetisation);
  add_uniform(spec);
  add_field(spec, {"coil", two_loops({5, 0, 20})}, {FieldCommand::current});
  add_field(spec, {"magnet", DipoleField{{10, -30, 12}, {0.1, 0.3, -0.2}}},
            {FieldCommand::position_x, FieldCommand::moment_z});
  return spec;
}

/// Pressures and tractions that follow the surface, on triangles, curved faces and quads.
RobotSpec loaded_robot(bool quadratic) {
  RobotSpec spec = quadratic ? physical_robot(block_mesh({2, 1, 1}, {20, 8, 6})) : layered_robot();
  spec.mesh_options.quadratic = quadratic;
  spec.loads.tractions = {{"wind", {std::string("x_high"), {}}, true, {30, -20, 10}, 0},
                          {"water", {std::string("z_low"), {}}, true, {0, 0, 0}, 25},
                          {"air", {std::string("z_high"), {}}, true, {0, 0, 0}, -15},
                          {"more", {std::string("z_low"), {}}, true, {0, 0, 0}, 5, std::array<double, 2>{-20, 20}}};
  return spec;
}

/// A moment on a rigid end, one component of it commanded.
RobotSpec turned_robot(bool quadratic) {
  RobotSpec spec = physical_robot(block_mesh({2, 1, 1}, {20, 8, 6}));
  spec.mesh_options.quadratic = quadratic;
  spec.rigid = {{{std::string("x_high"), {}}, "end"}};
  spec.loads.forces = {{"tool",
                        {std::string("x_high"), {}},
                        {0, 0, 0},
                        std::nullopt,
                        {300, -200, 50},
                        std::array<Vec3, 2>{Vec3(300, -900, 50), Vec3(300, 900, 50)}}};
  return spec;
}

/// Threads across tetrahedra of either order and prisms.
RobotSpec threaded_robot(bool quadratic) {
  RobotSpec spec = quadratic ? physical_robot(block_mesh({2, 1, 1}, {20, 8, 6})) : layered_robot();
  spec.mesh_options.quadratic = quadratic;
  const Vec3 size = spec.mesh.vertices.colwise().maxCoeff().transpose();
  FibreSpec thread;
  thread.name = "thread";
  thread.path = std::vector<Vec3>{0.02 * size, Vec3(0.9 * size.x(), 0.7 * size.y(), 0.95 * size.z())};
  thread.stiffness_N = 3;
  FibreSpec slack = thread;
  slack.name = "slack";
  slack.tension_only = true;
  slack.path = std::vector<Vec3>{Vec3(0.1 * size.x(), 0.9 * size.y(), 0.1 * size.z()), 0.8 * size, 0.5 * size};
  spec.fibres = {thread, slack};
  return spec;
}

/// A sheet that bends, and one that wrinkles, on tetrahedra of either order.
RobotSpec sheeted_robot(bool quadratic) {
  RobotSpec spec = physical_robot(block_mesh({2, 2, 1}, {20, 12, 6}));
  spec.mesh_options.quadratic = quadratic;
  for (const bool bending : {false, true}) {
    LayerSpec layer;
    layer.name = bending ? "plate" : "cloth";
    layer.where = RegionRef{std::string(bending ? "z_high" : "z_low"), {}};
    layer.thickness_mm = 0.8;
    layer.e1 = 6;
    layer.e2 = 2;
    layer.g12 = 1.5;
    layer.nu12 = 0.2;
    layer.direction = Vec3(1, 0.4, 0);
    layer.bending = bending && quadratic;
    layer.tension_only = !bending;
    spec.layers.push_back(std::make_shared<const LayerSpec>(layer));
  }
  return spec;
}

/// Elements of either kind that grow, in all directions by a temperature and along one by a stretch.
RobotSpec growing_robot(Split split, bool quadratic) {
  RobotSpec spec = physical_robot(block_mesh({3, 2, 1}, {20, 8, 6}, split));
  spec.mesh_options.quadratic = quadratic;
  spec.regions = {{"left", Selector(Box{{-1, -1, -1}, {7, 9, 7}}), {}},
                  {"right", Selector(Box{{13, -1, -1}, {21, 9, 7}}), {}}};
  GrowthPart warm{"left"}, along{"right"};
  warm.temperature = TemperatureSpec{20, 3e-3, {}};
  along.direction = DirectionSpec{.uniform = {1, 2, -1}};
  along.keeps_volume = true;
  ActuatorSpec first = actuator("warm", GrowthSpec{{warm}}, 0, 100, true);
  first.control = Control::load;
  first.rest = 20;
  const ActuatorSpec second = actuator("along", GrowthSpec{{along}}, 0.7, 1.4, true);
  spec.actuators = {first, second};
  return spec;
}

/// In a liquid, whole or in part.
RobotSpec submerged_robot(Split split, bool quadratic, double level) {
  RobotSpec spec = physical_robot(block_mesh({3, 2, 1}, {20, 8, 6}, split));
  spec.mesh_options.quadratic = quadratic;
  spec.materials[0].density = 1100;
  spec.loads.gravity = {2000, -3000, -9000};
  spec.loads.liquid_around = LiquidAroundSpec{1300, {0, 0, level}, {}};
  return spec;
}

/// The same around a chamber that ends at a plate which turns: the surface is open, and its rim can move.
RobotSpec submerged_open(Split split, bool quadratic, double level) {
  RobotSpec spec = submerged_robot(split, quadratic, level);
  if (split == Split::prisms) return spec;
  spec.mesh = block_mesh({4, 3, 3}, {20, 9, 9}, split);
  add_volume_region(spec.mesh, "chamber", [](const Vec3& p) {
    return p.x() < 10 && std::abs(p.y() - 4.5) < 1.5 && std::abs(p.z() - 4.5) < 1.5;
  });
  ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 2, true);
  spec.actuators = {air};
  spec.fixed[0].rotation = RotationSpec{{0, 1, 0}, 0, Vec3(0, 0, 0)};
  return spec;
}

/// Two families of fibres, one of them dispersed.
RobotSpec fibrous_robot(Split split, bool quadratic) {
  RobotSpec spec = physical_robot(block_mesh({3, 2, 1}, {20, 8, 6}, split));
  spec.mesh_options.quadratic = quadratic;
  FamilySpec first{0.7, 2.5, 0.1, {.uniform = {1, 1, 0.2}}}, second{0.3, 0, 0, {.uniform = {0, 1, -1}}};
  spec.materials[0].families = std::make_shared<const FamiliesSpec>(FamiliesSpec{{first, second}});
  return spec;
}

/// The terms of a robot in a shape that is no equilibrium.
struct TermsSample : PhysicalEquations {
  TermsSample(const RobotSpec& spec, double shake, const Vec3& move) : PhysicalEquations(compile(spec)) {
    active.resize(system.actuators());
    load_state = {model.rest_actuation(), 0.7, 0.4};
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> within(0.05, 0.2);
    for (Index a = 0; a < system.actuators(); ++a) {
      const double low = model.actuators[a].low, high = model.actuators[a].high;
      const double reach = std::min({high - load_state.actuation[a], 1.0});
      load_state.actuation[a] += (reach > 0 ? reach : low - load_state.actuation[a]) * within(engine);
    }
    at.positions = model.rest + noise(model.rest.rows(), shake, 1);
    at.positions.rowwise() += move.transpose();
    system.placement().hold({load_state.actuation, 0, 0}, at.positions);
    at.multipliers = Eigen::VectorXd::Zero(system.actuators());
    work.fading.force = noise(model.rest.rows(), 1, 9);
    (void)renew_friction(system, at.positions, {at.positions, at.positions}, at, work, team);
    along = noise(model.rest.rows(), 1, 7);
  }

  struct Found {
    double energy = 0;
    Points gradient;
  };
  Found found(std::size_t term, const physical::LoadState& wanted, const Points& shape) {
    Found all{0, Points::Zero(shape.rows(), 3)};
    Term::Sum sum{all.gradient};
    physical::Iterate there = at;
    there.positions = shape;
    system.terms()[term]->evaluate(there, wanted, *work.terms[term], sum, team);
    EXPECT_FALSE(sum.forbidden);
    all.energy = sum.energy;
    return all;
  }
  Points gradient(std::size_t term, const physical::LoadState& wanted) {
    return found(term, wanted, at.positions).gradient;
  }

  /// Of one term alone.
  Points stiffness_times_motion(std::size_t term) {
    system.evaluate(at, load_state, active, work, balance, team);
    system.assemble(at, load_state, balance, physical::System::Stiffness::exact, work, team);
    LargeVector<double> slots(work.stiffness.slots.size()), blocks;
    std::fill(slots.begin(), slots.end(), 0.0);
    system.terms()[term]->stiffness(at, load_state, false, *work.terms[term], slots, team);
    work.stiffness.layout->pattern.gather(slots, blocks, team);
    Points product;
    work.stiffness.layout->pattern.multiply(blocks, along, product, team);
    if (!system.terms()[term]->conservative())
      system.terms()[term]->add_response(at, along, *work.terms[term], product);
    return product;
  }

  Points along;
};

void expect_near(const Points& exact, const Points& slope, double fraction, const std::string& what) {
  EXPECT_LT((slope - exact).norm(), fraction * exact.norm() + 1e-9) << what;
}

/// Sizes of what was compared, by term: nothing that can not fail.
using Seen = std::array<std::array<double, 4>, all_terms>;

/// Compares the derivatives of every term with differences.
///
/// fraction  relative tolerance of the stiffness
void expect_derivatives(const RobotSpec& spec, double shake, const Vec3& move, double reach, Seen& seen,
                        double fraction = 1e-4) {
  TermsSample sample(spec, shake, move);
  physical::LoadState towards = sample.load_state;  // all commands and the load factor change by the same ratio
  constexpr double little = 1e-5;
  for (Index a = 0; a < towards.actuation.size(); ++a) towards.actuation[a] *= 1 + little;
  towards.load_factor *= 1 + little;
  towards.fading *= 1 - little;
  const std::size_t count = sample.system.terms().size();
  for (std::size_t t = 0; t < count; ++t) {
    const Term& term = *sample.system.terms()[t];
    Term::Scratch& scratch = *sample.work.terms[t];
    const std::string what = typeid(term).name();
    const auto shape = [&](double path) { return Points(sample.at.positions + path * reach * sample.along); };
    const auto high = sample.found(t, sample.load_state, shape(1)), low = sample.found(t, sample.load_state, shape(-1));
    const Points exact = sample.gradient(t, sample.load_state);
    if (term.conservative()) {
      EXPECT_NEAR(exact.cwiseProduct(sample.along).sum(), (high.energy - low.energy) / (2 * reach),
                  1e-5 * exact.norm() * sample.along.norm() + 1e-9)
          << what;
    }
    const Points stiff = sample.stiffness_times_motion(t);
    expect_near(stiff, (high.gradient - low.gradient) / (2 * reach), fraction, what + ": stiffness");
    double by_commands = 0;
    for (Index a = 0; a < towards.actuation.size(); ++a) {
      Points slope = Points::Zero(exact.rows(), 3);
      term.add_derivative(a, sample.load_state, sample.at.positions, scratch, slope, sample.team);
      physical::LoadState more = sample.load_state, less = sample.load_state;
      const double part = 1e-5 * std::max(1e-2, std::abs(more.actuation[a]));
      more.actuation[a] += part;
      less.actuation[a] -= part;
      const bool moves = sample.model.actuators[a].is<MotionCommand>();
      if (!moves)
        expect_near(slope, (sample.gradient(t, more) - sample.gradient(t, less)) / (2 * part), 1e-5,
                    what + ": by " + sample.model.actuators[a].name);
      by_commands += slope.norm();
    }
    Points change = Points::Zero(exact.rows(), 3);
    term.add_change(sample.load_state, towards, sample.at.positions, scratch, change, sample.team);
    const Points changed = sample.gradient(t, towards) - sample.gradient(t, sample.load_state);
    EXPECT_LE((change - changed).norm(), 2e-4 * change.norm() + 1e-12 * exact.norm()) << what;
    const std::array<double, 4> sizes{exact.norm(), stiff.norm(), by_commands, change.norm()};
    const bool contact = count > 4 && t == count - 1 && sample.system.contact();
    const bool fibres = t == 4 && !sample.model.reinforcement.fibres.empty();
    const bool liquid = dynamic_cast<const physical::Hydrostatics*>(&term) != nullptr,
               families = dynamic_cast<const physical::FibreFamilies*>(&term) != nullptr,
               layers = dynamic_cast<const physical::Layers*>(&term) != nullptr,
               moments = dynamic_cast<const physical::Moments*>(&term) != nullptr;
    auto& of_term = seen[moments                ? 11
                         : layers               ? 10
                         : families             ? 9
                         : liquid               ? 8
                         : contact              ? 7
                         : !term.conservative() ? 6
                         : fibres               ? 5
                                                : t];
    for (std::size_t i = 0; i < sizes.size(); ++i) of_term[i] = std::max(of_term[i], sizes[i]);
  }
}

}  // namespace

/// Of film that bulges by less than 1 mm on either side, over a plate that it feels.
RobotSpec film_over_plate() {
  RobotSpec spec = film_robot(pillow(disc(20, 3)));
  spec.contact = contact_below(0.8);
  ObstacleSpec plate;
  plate.name = "plate";
  plate.shape = Halfspace{{0, 0, -1}, {0, 0, 1}};
  spec.contact->obstacles = {plate};
  return spec;
}

TEST(Terms, DerivativesAreThoseOfTheEnergies) {
  Seen seen{};
  expect_derivatives(layered_robot(), 0.1, Vec3::Zero(), 1e-5, seen);
  for (const auto& [split, quadratic] :
       {std::pair{Split::six, false}, std::pair{Split::six, true}, std::pair{Split::prisms, false}})
    expect_derivatives(growing_robot(split, quadratic), 0.1, Vec3::Zero(), 1e-5, seen);
  expect_derivatives(charged_sheet(), 0.01, Vec3::Zero(), 1e-6, seen);
  for (const Magnetisation magnetisation : both_magnetisations)
    for (const bool quadratic : {false, true})
      expect_derivatives(magnetic_robot(magnetisation, quadratic), 0.1, Vec3::Zero(), 1e-4, seen);
  for (const bool quadratic : {false, true}) {
    expect_derivatives(loaded_robot(quadratic), 0.1, Vec3::Zero(), 1e-4, seen);
    expect_derivatives(turned_robot(quadratic), 0.1, Vec3::Zero(), 1e-4, seen);
  }
  for (const bool quadratic : {false, true})
    expect_derivatives(threaded_robot(quadratic), 0.1, Vec3::Zero(), 1e-5, seen);
  for (const bool quadratic : {false, true})
    expect_derivatives(sheeted_robot(quadratic), 0.1, Vec3::Zero(), 1e-6, seen);
  expect_derivatives(film_robot(pillow(disc(20, 3))), 0.5, Vec3::Zero(), 1e-6, seen);
  expect_derivatives(film_over_plate(), 0.5, Vec3::Zero(), 1e-6, seen);
  expect_derivatives(body_on_floor({10, 10, 10}, 0.3), 1e-3, {0, 0, -0.03}, 2e-8, seen);
  for (const bool quadratic : {false, true})
    expect_derivatives(block_on_rough_floor(0.3, {0.2, 0, -0.03}, 2, quadratic), 1e-3, {0.01, 0, -0.03}, 2e-8, seen);
  for (const auto& [split, quadratic] :
       {std::pair{Split::six, false}, std::pair{Split::six, true}, std::pair{Split::prisms, false}}) {
    for (const double level : {50.0, 2.6}) {
      const double fraction = quadratic && level < 6 ? 5e-4 : 1e-5;  // curved faces are cut nearly where they should be
      expect_derivatives(submerged_robot(split, quadratic, level), 0.1, Vec3::Zero(), 1e-5, seen, fraction);
      expect_derivatives(submerged_open(split, quadratic, level), 0.1, Vec3::Zero(), 1e-5, seen, fraction);
    }
    expect_derivatives(fibrous_robot(split, quadratic), 0.1, Vec3::Zero(), 1e-5, seen);
  }
  // body, dead and fading loads, loads on bodies, magnets, fibres, tractions, contact, liquids, families of fibres,
  // layers, moments: gradient, stiffness, derivatives by commands, by load factor
  const std::array<std::array<bool, 4>, all_terms> has{{{true, true, true, true},
                                                        {true, false, false, true},
                                                        {true, false, false, true},
                                                        {true, true, true, true},
                                                        {true, true, true, true},
                                                        {true, true, false, false},
                                                        {true, true, true, true},
                                                        {true, true, false, false},
                                                        {true, true, false, true},
                                                        {true, true, false, false},
                                                        {true, true, false, false},
                                                        {true, true, true, true}}};
  for (std::size_t t = 0; t < has.size(); ++t)
    for (std::size_t i = 0; i < has[t].size(); ++i) EXPECT_EQ(seen[t][i] > 1e-12, has[t][i]) << t << " " << i;
}

}  // namespace softkin
