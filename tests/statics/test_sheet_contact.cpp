#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/physical_equations.hpp"
#include "statics/physical_samples.hpp"
#include "statics/pillows.hpp"

/// Robots of layers alone that touch what stands around them, and themselves.

namespace softkin {

namespace {

using namespace testing;

constexpr double radius = 100, pressure_kPa = 1;

ObstacleSpec plate(const std::string& name, double z, double normal) {
  ObstacleSpec spec;
  spec.name = name;
  spec.shape = Halfspace{{0, 0, z}, {0, 0, normal}};
  spec.motion[2] = true;
  return spec;
}

RegionRef one_vertex(Index v) {
  return {Selector(VertexList{{v}}), {}};
}

/// Two discs of film whose rim stays in its plane, between two plates.
RobotSpec squeezed_pillow(const Pillow& made, double height) {
  RobotSpec spec = film_robot(made);
  spec.fixed = {{{Selector(VertexList{made.rim}), {}}, {false, false, true}},
                {one_vertex(made.bottom), {true, true, false}},
                {one_vertex(made.rim[0]), {false, true, false}}};
  spec.contact.emplace();
  spec.contact->distance_mm = 0.1;
  spec.contact->self = false;
  spec.contact->obstacles = {plate("above", height / 2, -1), plate("below", -height / 2, 1)};
  return spec;
}

/// Two inextensible discs, inflated between plates: the film has no hoop tension, so that a meridian's tension times
/// its distance x from the axis is constant, and sin(slope) = (x^2 - a^2) / (r^2 - a^2) outside of the flat middle of
/// radius a, where a plate carries the pressure.
struct SqueezedMylar {
  double flat = 0, volume = 0;  // a [mm], [mm^3]

  explicit SqueezedMylar(double height) {
    double low = 0, high = 1, length = 1;  // a over the largest x
    for (int i = 0; i < 60; ++i) {
      flat = (low + high) / 2;
      double half = 0;
      integrate(length, half);
      (half / length > height / 2 / radius ? low : high) = flat;
    }
    flat *= radius / length;
    volume *= std::pow(radius / length, 3);
  }

  [[nodiscard]] double force_N() const { return 1e-3 * pressure_kPa * std::numbers::pi * flat * flat; }

 private:
  /// Of a meridian, and half of the height.
  void integrate(double& length, double& half) {
    constexpr int steps = 2000;
    length = flat;
    half = volume = 0;
    for (int i = 0; i < steps; ++i) {
      const double width = std::numbers::pi / 2 / steps, slope = (i + 0.5) * width;
      const double x = std::sqrt(flat * flat + (1 - flat * flat) * std::sin(slope));
      const double path = (1 - flat * flat) / (2 * x) * width, rise = path * std::sin(slope);
      length += path;
      half += rise;
      volume += 2 * std::numbers::pi * x * x * rise;
    }
  }
};

/// What the parts of a pair do to each other: the force that b exerts on a [N], and how near they are [mm].
PairForces pair_of(const Model& model, const Statics& statics, const Equilibrium& found, const std::string& a,
                   const std::string& b) {
  const ElementDeformation measured = statics.measured(found.state);
  for (const PairForces& pair : measured.contacts->pairs)
    if (model.contact.parts[pair.a].name == a && model.contact.parts[pair.b].name == b) return pair;
  ADD_FAILURE() << a << " and " << b << " do not touch";
  return {};
}

Actuation inflated(const Model& model, double kPa = pressure_kPa) {
  Actuation commands = model.rest_actuation();
  commands[0] = kPa;
  return commands;
}

}  // namespace

TEST(SheetContact, PlatesBearThePressureOfWhatLiesOnThem) {
  const Pillow made = pillow(disc(radius, 8));
  for (const double height : {84.0, 60.0, 36.0}) {
    const Model model = compile(squeezed_pillow(made, height));
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, inflated(model));
    const SqueezedMylar known(height);
    const PairForces above = pair_of(model, statics, found, "robot", "above"),
                     below = pair_of(model, statics, found, "robot", "below");
    EXPECT_NEAR(above.normal_N, known.force_N(), 0.02 * known.force_N() + 0.05) << height;
    EXPECT_NEAR(above.force.z(), -above.normal_N, 1e-9 * above.normal_N);
    EXPECT_NEAR(below.normal_N, above.normal_N, 1e-4 * above.normal_N);
    EXPECT_NEAR(above.pressure_kPa, pressure_kPa, 0.02 * pressure_kPa);
    EXPECT_NEAR(enclosed_volume(found.state.positions, model.actuators[0].as<ChamberDrive>()->cavity), known.volume,
                0.03 * known.volume);
    EXPECT_GT(above.gap_mm, 0);
  }
}

TEST(SheetContact, WhatIsPressedFollowsTheRateOfForceWithThePlate) {
  const Pillow made = pillow(disc(radius, 6));
  const Model model = compile(squeezed_pillow(made, 60));
  const Statics statics(model);
  Actuation commands = inflated(model);
  const Equilibrium before = solve_converged(statics, commands);
  commands[1] = -4;  // above
  const Equilibrium found = statics.solve(commands, before.state, {}, {});
  ASSERT_EQ(found.report.status, Status::converged);
  const auto volume = [&](const Equilibrium& at) {
    return enclosed_volume(at.state.positions, model.actuators[0].as<ChamberDrive>()->cavity);
  };
  // film that hardly stretches keeps no energy: what the plate does, the gas gets
  const double mean = (pair_of(model, statics, before, "robot", "above").normal_N +
                       pair_of(model, statics, found, "robot", "above").normal_N) /
                      2;
  EXPECT_NEAR(1e-3 * pressure_kPa * (volume(before) - volume(found)), mean * 4, 0.02 * mean * 4);
}

TEST(SheetContact, NothingRunsThroughWhatLiesFlat) {
  const Pillow made = pillow(disc(radius, 4));
  const Model model = compile(squeezed_pillow(made, 60));
  Actuation commands = inflated(model);
  commands[1] = -40;  // to beyond the rim, which is held
  const Statics statics(model);
  const Equilibrium found = statics.solve(commands, statics.rest(), {}, {});
  EXPECT_NE(found.report.status, Status::converged);
  EXPECT_LT(found.report.reached, 0.8);
}

TEST(SheetContact, PillowsThatPressEachOtherAreFlatAsOnAPlate) {
  // mirror images: what is between them is as a plate is; the other plate is too far away to be touched
  constexpr double apart = 60;
  const Pillow made = pillow(disc(radius, 6));
  const Index count = made.mesh.vertices.rows();
  RobotSpec spec = film_robot(made);
  spec.mesh.vertices.conservativeResize(2 * count, 3);
  spec.mesh.vertices.bottomRows(count) = made.mesh.vertices.rowwise() + Eigen::RowVector3d(0, 0, apart);
  Region lower{"lower", 2, {}, {}, {}, {}, {}}, upper{"upper", 2, {}, {}, {}, {}, {}};
  const std::size_t faces = made.mesh.triangles.size();
  for (std::size_t t = 0; t < faces; ++t) {
    const Triangle of = made.mesh.triangles[t];
    spec.mesh.triangles.push_back({of[0] + count, of[1] + count, of[2] + count});
    lower.triangles.push_back(t);
    upper.triangles.push_back(faces + t);
  }
  spec.mesh.regions = {lower, upper};
  spec.fixed.clear();
  for (const Index shift : {Index{0}, count}) {
    VertexList rim;
    for (const Index v : made.rim) rim.vertices.push_back(v + shift);
    spec.fixed.push_back({{Selector(rim), {}}, {false, false, true}});
    spec.fixed.push_back({one_vertex(made.bottom + shift), {true, true, false}});
    spec.fixed.push_back({one_vertex(made.rim[0] + shift), {false, true, false}});
  }
  spec.actuators[0].name = "lower";
  spec.actuators[0].as<PneumaticSpec>()->wall = "lower";
  spec.actuators.push_back(spec.actuators[0]);
  spec.actuators[1].name = "upper";
  spec.actuators[1].as<PneumaticSpec>()->wall = "upper";
  spec.contact.emplace();
  spec.contact->distance_mm = 0.1;
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, Actuation::Constant(2, pressure_kPa));

  RobotSpec single = squeezed_pillow(made, apart);
  single.contact->obstacles.resize(1);
  const Model alone = compile(single);
  const Statics alone_statics(alone);
  const Equilibrium like = solve_converged(alone_statics, inflated(alone));
  const PairForces on_plate = pair_of(alone, alone_statics, like, "robot", "above");
  const PairForces between = pair_of(model, statics, found, "robot", "robot");
  EXPECT_GT(on_plate.normal_N, 5);
  EXPECT_NEAR(between.normal_N, on_plate.normal_N, 0.01 * on_plate.normal_N);
  for (std::size_t a = 0; a < 2; ++a)
    EXPECT_NEAR(enclosed_volume(found.state.positions, model.actuators[a].as<ChamberDrive>()->cavity),
                enclosed_volume(like.state.positions, alone.actuators[0].as<ChamberDrive>()->cavity),
                0.002 * enclosed_volume(like.state.positions, alone.actuators[0].as<ChamberDrive>()->cavity));
}

TEST(SheetContact, AFilmOnABodyLiftsWhatLiesOnIt) {
  // a film that is welded onto the top of a block along its rim, flat on it at rest: blown up it presses on a plate
  constexpr double top = 5, kPa = 4;
  RobotSpec spec = physical_robot(block_mesh({8, 8, 1}, {80, 80, top}));
  Mesh& mesh = spec.mesh;
  const auto boundary = boundary_triangles(mesh.tetrahedra, {}, mesh.prisms);
  std::map<Index, Index> film_of;
  Region film{"film", 2, {}, {}, {}, {}, {}}, pouch{"pouch", 2, {}, {}, {}, {}, {}};
  std::vector<Triangle> below;
  for (const Triangle& t : boundary)
    if (std::all_of(t.begin(), t.end(), [&](Index v) { return mesh.vertices(v, 2) > top - 1e-9; })) below.push_back(t);
  const auto on_film = [&](Index v) {
    const Vec3 at = vertex_at(mesh.vertices, v);
    if (std::abs(at.x() - 40) > 40 - 1e-9 || std::abs(at.y() - 40) > 40 - 1e-9) return v;
    const auto [known, fresh] = film_of.emplace(v, static_cast<Index>(mesh.vertices.rows()));
    if (fresh) {
      mesh.vertices.conservativeResize(mesh.vertices.rows() + 1, 3);
      mesh.vertices.bottomRows(1) = at.transpose();
    }
    return known->second;
  };
  const auto add = [&](const Triangle& t, Region* region) {
    if (region != nullptr) region->triangles.push_back(mesh.triangles.size());
    pouch.triangles.push_back(mesh.triangles.size());
    mesh.triangles.push_back(t);
  };
  for (const Triangle& t : below) {
    const Triangle on{on_film(t[0]), on_film(t[1]), on_film(t[2])};
    if (on == t) continue;             // in a corner
    add({t[0], t[2], t[1]}, nullptr);  // seen from inside the pouch
    add(on, &film);
  }
  mesh.regions.push_back(film);
  mesh.regions.push_back(pouch);
  spec.layers.push_back(film_layer("film", 0.1, 200));
  spec.fixed = {{{Selector(Box{{-1, -1, -1}, {81, 81, 1e-6}}), {}}, {true, true, true}}};
  ActuatorSpec air;
  air.name = "air";
  air.drive = PneumaticSpec{.wall = "pouch"};
  air.control = Control::load;
  air.low = air.rest = 0;
  air.high = 10;
  spec.actuators = {air};
  spec.contact.emplace();
  spec.contact->distance_mm = 0.05;
  spec.contact->obstacles = {plate("above", top + 6, -1)};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, inflated(model, kPa));
  const PairForces pressed = pair_of(model, statics, found, "robot", "above");
  EXPECT_GT(pressed.normal_N, 1);
  EXPECT_NEAR(pressed.pressure_kPa, kPa, 0.15 * kPa);  // of one vertex
  const Points reactions = statics.measured(found.state).reactions;
  EXPECT_NEAR(reactions.col(2).sum(), pressed.normal_N, 1e-4 * pressed.normal_N);
  EXPECT_LT(found.state.positions.col(2).maxCoeff(), top + 6 + 1e-9);
}

TEST(SheetContact, IsRefusedWhereItCannotBegin) {
  const auto refusal = [](const std::function<void(RobotSpec&)>& change) {
    RobotSpec spec = squeezed_pillow(pillow(disc(50, 3)), 40);
    spec.contact->self = true;  // its sheets lie on each other at rest: there they do not feel each other
    change(spec);
    try {
      (void)Statics(compile(spec));
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal([](RobotSpec&) {}), "accepted");
  const std::string crossed = refusal([](RobotSpec& spec) {
    ObstacleSpec ball;
    ball.name = "ball";
    ball.shape = Sphere{{0, 0, 3}, 5};
    spec.contact->obstacles.push_back(ball);
  });
  EXPECT_NE(crossed.find("robot and obstacle 'ball' touch or cross"), std::string::npos) << crossed;
}

}  // namespace softkin
