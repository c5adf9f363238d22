#include <Eigen/Geometry>
#include <functional>
#include <softkin/model/layer.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/statics/deformation.hpp>

#include "model/quadratic_mesh.hpp"
#include "statics/physical_samples.hpp"

/// Reactions of supports that close a chamber: the pressure on the plate or the plane of symmetry acts on the support,
/// not on the robot.

namespace softkin {

namespace {

using namespace testing;

constexpr double kilopascal = 1e-3;  // in MPa
const Vec3 tube_size(24, 12, 12);

bool in_tube(const Vec3& p) {
  return p.x() < 16 && std::abs(p.y() - 6) < 2 && std::abs(p.z() - 6) < 2;
}

RegionRef in_box(const Vec3& low, const Vec3& high) {
  return {Box{low, high}, {}};
}

/// A square tube whose bore of 4 x 4 mm ends at the plate x = 0 that holds it, `refine` elements across the wall.
RobotSpec bored_tube(int refine, bool quadratic, Split split = Split::six) {
  Mesh mesh = block_mesh({3 * refine, 3 * refine, 3 * refine}, tube_size, split);
  add_volume_region(mesh, "bore", in_tube);
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.mesh_options.quadratic = quadratic;
  spec.actuators = {by_load(air("bore"))};
  return spec;
}

/// The same pressure as a load on the faces of the bore, between these corners.
RobotSpec by_tractions(RobotSpec spec, double kilopascals, const Vec3& low, const Vec3& high) {
  spec.actuators.clear();
  spec.voids = {{std::string("bore"), {}}};
  spec.loads.tractions = {{"air", in_box(low, high), true, {0, 0, 0}, kilopascals}};
  return spec;
}

/// Force, and moment about the origin.
struct Wrench {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();

  void add(const Vec3& at, const Vec3& pull) {
    force += pull;
    moment += at.cross(pull);
  }
  void add(const Reaction& reaction) {
    add(reaction.center, reaction.force);
    moment += reaction.moment;
  }
};

/// visit(a place of the face as it is, its area vector)
template <class Visit>
void each_piece(const CavityFace& face, const Points& positions, const Visit& visit) {
  const std::vector<Index> nodes = nodes_of(face);
  if (nodes.size() == 3) {
    const Vec3 a = vertex_at(positions, nodes[0]), b = vertex_at(positions, nodes[1]),
               c = vertex_at(positions, nodes[2]);
    return visit((a + b + c) / 3, Vec3((b - a).cross(c - a) / 2));
  }
  for (const TrianglePoint& p : triangle_rule()) {
    Vec3 at = Vec3::Zero(), u = at, v = at;
    for (int i = 0; i < 6; ++i) {
      at += p.shape[i] * vertex_at(positions, nodes[i]);
      u += p.along_u[i] * vertex_at(positions, nodes[i]);
      v += p.along_v[i] * vertex_at(positions, nodes[i]);
    }
    visit(at, Vec3(p.weight * u.cross(v)));
  }
}

/// A robot in equilibrium, and the faces of its chambers by whether elements are behind them.
struct Standing {
  Model model;
  Statics statics;
  Equilibrium found;
  std::vector<Reaction> held;

  Standing(const RobotSpec& spec, const Actuation& actuation)
      : model(compile(spec)), statics(model), found(solve_converged(statics, actuation)) {
    held = reactions(model, found.state.positions, statics.measured(found.state));
  }
  explicit Standing(const RobotSpec& spec) : Standing(spec, compile(spec).rest_actuation()) {}

  [[nodiscard]] const Points& shape() const { return found.state.positions; }

  /// Faces of elements and sheets, by brute force.
  [[nodiscard]] bool is_material(const CavityFace& face) const {
    const auto has = [&](const auto& element) {
      return std::all_of(face.corners.begin(), face.corners.end(),
                         [&](Index v) { return std::find(element.begin(), element.end(), v) != element.end(); });
    };
    const Elements& of = model.elements;
    const auto& layers = model.reinforcement.layers;
    return std::any_of(of.tetrahedra.begin(), of.tetrahedra.end(), has) ||
           std::any_of(of.prisms.begin(), of.prisms.end(), has) ||
           std::any_of(layers.begin(), layers.end(), [&](const auto& layer) {
             return std::any_of(layer->faces.begin(), layer->faces.end(),
                                [&](const CavityFace& other) { return has(other.corners); });
           });
  }

  /// Of the pressures of chambers: on the robot, or on what closes them.
  [[nodiscard]] Wrench pressed(bool robot) const {
    Wrench sum;
    for (std::size_t a = 0; a < model.actuators.size(); ++a) {
      const auto* chamber = model.actuators[a].as<ChamberDrive>();
      if (chamber == nullptr) continue;
      const double pressure = kilopascal * found.state.multipliers[static_cast<Index>(a)];
      for (const CavityFace& face : chamber->cavity)
        if (is_material(face) == robot)
          each_piece(face, shape(), [&](const Vec3& at, const Vec3& area) { sum.add(at, pressure * area); });
    }
    return sum;
  }

  /// All that acts on the robot: reactions, pressures on material, dead loads.
  [[nodiscard]] Wrench all() const {
    Wrench sum = pressed(true);
    for (const Reaction& each : held) sum.add(each);
    for (Index v = 0; v < model.loads.dead.rows(); ++v)
      sum.add(vertex_at(shape(), v), model.loads.dead.row(v).transpose());
    return sum;
  }

  /// Of all supports, by the chambers that they close.
  [[nodiscard]] Wrench on_supports() const {
    Wrench sum;
    for (const Reaction& each : held)
      for (const ChamberForce& chamber : each.chambers) {
        sum.add(each.center, chamber.force);
        sum.moment += chamber.moment;
      }
    return sum;
  }
};

/// The reactions, the pressures on the walls and the dead loads are in equilibrium, and the pressures on what supports
/// close are those on the faces without elements.
void expect_balance(const Standing& robot) {
  double size = 0;
  for (const Reaction& each : robot.held) size += each.force.norm();
  const Wrench all = robot.all(), pressed = robot.pressed(false), reported = robot.on_supports();
  EXPECT_LT(all.force.norm(), 1e-8 * size);
  EXPECT_LT(all.moment.norm(), 1e-8 * size * robot.model.diagonal_mm);
  EXPECT_GT(pressed.force.norm(), 1e-2 * size);
  EXPECT_LT((reported.force - pressed.force).norm(), 1e-12 * pressed.force.norm());
  EXPECT_LT((reported.moment - pressed.moment).norm(), 1e-12 * pressed.force.norm() * robot.model.diagonal_mm);
}

/// A quarter of a closed tube between two planes of symmetry, on a plate without friction.
RobotSpec quarter_tube(int refine, bool quadratic) {
  Mesh mesh = block_mesh({3 * refine, 2 * refine, 2 * refine}, {24, 8, 8});
  add_volume_region(mesh, "bore", [](const Vec3& p) { return p.x() < 16 && p.y() < 4 && p.z() < 4; });
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.mesh_options.quadratic = quadratic;
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{std::string("y_low"), {}}, {false, true, false}},
                {{std::string("z_low"), {}}, {false, false, true}}};
  spec.actuators = {by_load(air("bore"))};
  return spec;
}

/// The chamber by the faces around it, the opening's among them, of a bore of prisms, whose sides are quads.
void name_wall(RobotSpec& spec) {
  std::vector<Prism> bore;
  for (const Region& region : spec.mesh.regions)
    if (region.name == "bore")
      for (const Index p : region.prisms) bore.push_back(spec.mesh.prisms[p]);
  const Boundary boundary = boundary_of({}, bore);
  Region wall;
  wall.name = "wall";
  wall.dimension = 2;
  for (const Triangle& t : boundary.triangles) {
    wall.triangles.push_back(std::ssize(spec.mesh.triangles));
    spec.mesh.triangles.push_back(t);
  }
  for (const Quad& q : boundary.quads) {
    wall.quads.push_back(std::ssize(spec.mesh.quads));
    spec.mesh.quads.push_back(q);
  }
  spec.mesh.regions.push_back(wall);
  spec.voids = {{std::string("bore"), {}}};
  spec.actuators[0].as<PneumaticSpec>()->region.reset();
  spec.actuators[0].as<PneumaticSpec>()->wall = "wall";
}

/// With gas, whose amount is commanded.
void seal(ActuatorSpec& spec) {
  spec.control = Control::filling;
  spec.low = 0.01;
  spec.high = 10;
  spec.as<PneumaticSpec>()->filling = FillingSpec{.dead_mL = 0.1};
}

void add_weight(RobotSpec& spec) {
  spec.materials[0].density = 1200;
  spec.loads.gravity = {0.7, -9.81, 3};
}

}  // namespace

/// The force in the wall of a tube is that on its end, p A, whatever the mesh; there is no moment.
TEST(Reactions, OfATubeOnAPlateIsTheForceInItsWall) {
  constexpr double pressure = 20, area = 16;
  for (const bool quadratic : {false, true})
    for (const int refine : {1, 2}) {
      SCOPED_TRACE(std::to_string(refine) + (quadratic ? " cells, order 2" : " cells, order 1"));
      const Standing robot(bored_tube(refine, quadratic), values({pressure}));
      const Vec3 expected(-kilopascal * pressure * area, 0, 0);
      ASSERT_EQ(robot.held.size(), 1u);
      EXPECT_LT((robot.held[0].force - expected).norm(), 1e-9);
      EXPECT_LT(robot.held[0].moment.norm(), 1e-8);
      ASSERT_EQ(robot.held[0].chambers.size(), 1u);
      EXPECT_EQ(robot.held[0].chambers[0].actuator, 0);
      EXPECT_LT((robot.held[0].chambers[0].force - expected).norm(), 1e-12);
      EXPECT_LT(robot.held[0].chambers[0].moment.norm(), 1e-12);
      expect_balance(robot);
    }
}

/// At every vertex, and of every support, they are those of the same pressure as a load on the walls.
TEST(Reactions, AreThoseOfTheSamePressureAsTractions) {
  constexpr double pressure = 30;
  for (const bool quadratic : {false, true})
    for (RobotSpec spec :
         {bored_tube(1, quadratic), bored_tube(2, quadratic), quarter_tube(1, quadratic), quarter_tube(2, quadratic)}) {
      add_weight(spec);
      const double low = spec.fixed.size() == 1 ? 3.9 : -0.1, high = spec.fixed.size() == 1 ? 8.1 : 4.1;
      const Standing chamber(spec, values({pressure})),
          walls(by_tractions(spec, pressure, {-0.1, low, low}, {16.1, high, high}));
      EXPECT_LT(distance(chamber.shape(), walls.shape()), 1e-7);
      const Points at_chamber = chamber.statics.measured(chamber.found.state).reactions,
                   at_walls = walls.statics.measured(walls.found.state).reactions;
      const double size = chamber.held[0].force.norm();
      EXPECT_LT((at_chamber - at_walls).cwiseAbs().maxCoeff(), 1e-8 * size);
      for (std::size_t s = 0; s < chamber.held.size(); ++s) {
        EXPECT_LT((chamber.held[s].force - walls.held[s].force).norm(), 1e-8 * size);
        EXPECT_LT((chamber.held[s].moment - walls.held[s].moment).norm(), 1e-7 * size * chamber.model.diagonal_mm);
        EXPECT_TRUE(walls.held[s].chambers.empty());
      }
      expect_balance(chamber);
    }
}

/// Each plane of symmetry carries what the pressure in the cut bore exerts against it; the axial one is p A.
TEST(Reactions, OfPlanesOfSymmetryDoNotDependOnTheMesh) {
  constexpr double pressure = 30;
  for (const bool quadratic : {false, true})
    for (const int refine : {1, 2}) {
      const Standing robot(quarter_tube(refine, quadratic), values({pressure}));
      expect_balance(robot);
      ASSERT_EQ(robot.held.size(), 3u);
      double largest = 0;  // the bore widens
      for (int axis = 0; axis < 3; ++axis) {
        const Reaction& plane = robot.held[axis];
        ASSERT_EQ(plane.chambers.size(), 1u) << axis;
        // the walls and the caps of the bore are a closed surface
        EXPECT_LT((plane.force - plane.chambers[0].force).norm(), 1e-8) << axis;
        largest = std::max(largest, plane.force.norm());
        for (int other = 0; other < 3; ++other)
          if (other != axis) EXPECT_EQ(plane.force[other], 0) << axis << other;
      }
      EXPECT_GT(largest, kilopascal * pressure * 64);
      EXPECT_LT(largest, 1.15 * kilopascal * pressure * 64);
    }
}

/// Whatever fills the chamber, however the robot is made and held.
TEST(Reactions, BalanceTheLoadsWhateverClosesTheChamber) {
  struct Case {
    std::string name;
    std::function<void(RobotSpec&)> change;
    double command = 25;
    int refine = 1;
  };
  const std::vector<Case> cases{
      {"by its volume", [](RobotSpec& s) { s.actuators = {air("bore")}; }, 1.2},
      {"sealed gas", [](RobotSpec& s) { seal(s.actuators[0]); }, 0.5},
      {"a factor and an offset",
       [](RobotSpec& s) {
         s.actuators[0].factor = 0.8;
         s.actuators[0].offset = 2;
       }},
      {"mixed elements", [](RobotSpec& s) { s.materials[0].mixed = true; }},
      {"two supports that share the opening",
       [](RobotSpec& s) {
         s.fixed = {{in_box({-1, -1, -1}, {0.1, 13, 6.1}), {true, true, true}},
                    {in_box({-1, -1, 5.9}, {0.1, 13, 13}), {true, true, true}}};
       }},
      {"vertices of the opening that no entry names",
       [](RobotSpec& s) {
         s.fixed = {{in_box({-1, -1, -1}, {0.1, 4.1, 13}), {true, true, true}},
                    {in_box({-1, 3.9, -1}, {0.1, 13, 4.1}), {true, true, true}},
                    {in_box({-1, 3.9, 7.9}, {0.1, 13, 13}), {true, true, true}},
                    {in_box({-1, 7.9, -1}, {0.1, 13, 13}), {true, true, true}}};
       },
       25, 2},
      {"a plate that turns about its axis",
       [](RobotSpec& s) {
         s.fixed[0].rotation = RotationSpec{{1, 0, 0}, 0, {}};
       }},
      {"a rigid flange",
       [](RobotSpec& s) {
         s.rigid.push_back({in_box({-1, -1, -1}, {8.1, 13, 13}), "flange"});
       }},
      {"a sheet on the wall",
       [](RobotSpec& s) {
         LayerSpec sheet{.name = "sheet", .where = RegionRef{std::string("y_high"), {}}, .thickness_mm = 0.1};
         sheet.e1 = sheet.e2 = 20;
         sheet.g12 = 8;
         sheet.nu12 = 0.25;
         s.layers = {std::make_shared<const LayerSpec>(sheet)};
       }},
      {"an end that is held, too", [](RobotSpec& s) {
         s.fixed.push_back({{std::string("x_high"), {}}, {false, true, true}, {0, 0.5, 0}});
       }}};
  for (const bool quadratic : {false, true})
    for (const Case& each : cases) {
      SCOPED_TRACE(each.name + (quadratic ? ", order 2" : ", order 1"));
      RobotSpec spec = bored_tube(each.refine, quadratic);
      add_weight(spec);
      each.change(spec);
      const Model model = compile(spec);
      Actuation actuation = model.rest_actuation();
      actuation[0] = each.command;
      if (actuation.size() > 1) actuation[1] = 0;
      expect_balance(Standing(spec, actuation));
    }
  RobotSpec prisms = bored_tube(2, false, Split::prisms);
  name_wall(prisms);
  expect_balance(Standing(prisms, values({25})));
}

/// A sheet over the opening is of the robot: its pressure is passed on by the reaction.
TEST(Reactions, ASheetOverTheOpeningIsOfTheRobot) {
  RobotSpec spec = bored_tube(2, false);
  Region lid;
  lid.name = "lid";
  lid.dimension = 2;
  for (std::size_t t = 0; t < spec.mesh.triangles.size(); ++t) {
    const Triangle& corners = spec.mesh.triangles[t];
    if (std::all_of(corners.begin(), corners.end(), [&](Index v) {
          const Vec3 p = vertex_at(spec.mesh.vertices, v);
          return p.x() == 0 && std::abs(p.y() - 6) < 2.1 && std::abs(p.z() - 6) < 2.1;
        }))
      lid.triangles.push_back(static_cast<Index>(t));
  }
  spec.mesh.regions.push_back(lid);
  LayerSpec sheet{.name = "lid", .where = RegionRef{std::string("lid"), {}}, .thickness_mm = 0.1};
  sheet.e1 = sheet.e2 = 20;
  sheet.g12 = 8;
  sheet.nu12 = 0.25;
  spec.layers = {std::make_shared<const LayerSpec>(sheet)};
  const Standing robot(spec, values({20}));
  EXPECT_TRUE(robot.held[0].chambers.empty());
  EXPECT_LT(robot.held[0].force.norm(), 1e-9);  // the wall's tension and the pressure on the same sheet cancel
  EXPECT_LT(robot.all().force.norm(), 1e-9);
}

/// A bore that is no mesh but a surface, which the elements around it carry.
TEST(Reactions, OfASurfaceThatEndsAtAPlate) {
  constexpr double pressure = 20, area = 16;
  for (const bool symmetric : {false, true})
    for (const bool quadratic : {false, true})
      for (const int across : {1, 2}) {
        SCOPED_TRACE(std::to_string(across) + (quadratic ? ", order 2" : ", order 1"));
        RobotSpec spec = bored_tube(1, quadratic);
        spec.mesh = block_mesh({3 * across, 3, 3}, tube_size);
        add_volume_region(spec.mesh, "bore", in_tube);
        spec.voids = {{std::string("bore"), {}}};
        spec.actuators[0].as<PneumaticSpec>()->region.reset();
        spec.actuators[0].as<PneumaticSpec>()->surface = box_surface({0, 4, 4}, {16, 4, 4});
        if (symmetric)
          spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                        {{VertexList{{0}}, {}}, {false, true, true}},
                        {{VertexList{{grid_vertex({3 * across, 3, 3}, 0, 3, 0)}}, {}}, {false, false, true}}};
        const Standing robot(spec, values({pressure}));
        ASSERT_FALSE(robot.model.actuators[0].as<ChamberDrive>()->surface.empty());
        ASSERT_EQ(robot.held[0].chambers.size(), 1u);
        const double widened = symmetric ? robot.held[0].chambers[0].force.norm() / (kilopascal * pressure * area) : 1;
        EXPECT_NEAR(robot.held[0].chambers[0].force.x(), -kilopascal * pressure * area * widened, 1e-12);
        EXPECT_GE(widened, 1);
        EXPECT_LT(widened, 1.1);
        Vec3 sum = Vec3::Zero();
        for (const Reaction& each : robot.held) sum += each.force;
        EXPECT_LT((sum - robot.held[0].chambers[0].force).norm(), 1e-9);
      }
}

/// Of commands, by central differences of the reactions at equilibria beside.
TEST(Reactions, DerivativesByCommandsEqualDifferences) {
  const auto at_gas = [](RobotSpec spec) {
    seal(spec.actuators[0]);
    return spec;
  };
  RobotSpec turned = bored_tube(1, false);
  turned.fixed[0].rotation = RotationSpec{{1, 0.2, 0}, 0, {}};
  RobotSpec by_volume = quarter_tube(1, false);
  by_volume.actuators = {air("bore")};
  struct Case {
    RobotSpec spec;
    std::vector<double> at;
    double reach;
  };
  for (const Case& each : {Case{quarter_tube(1, true), {30}, 0.1}, Case{at_gas(quarter_tube(1, false)), {0.6}, 1e-3},
                           Case{by_volume, {1.3}, 1e-3}, Case{turned, {25, 4}, 0.05}}) {
    const Model model = compile(each.spec);
    const Statics statics(model);
    const Actuation at = Eigen::Map<const Eigen::VectorXd>(each.at.data(), std::ssize(each.at));
    const Equilibrium found = solve_converged(statics, at);
    std::vector<Actuation> changes;
    for (Index a = 0; a < at.size(); ++a) changes.emplace_back(Actuation::Unit(at.size(), a));
    const ParameterSensitivity exact = statics.sensitivity_along(found.state, changes, tight(), 1e-10, true);
    ASSERT_TRUE(exact.regular);
    for (Index a = 0; a < at.size(); ++a) {
      const auto beside = [&](double change) {
        return statics.measured(statics.solve(at + change * changes[a], found.state, tight(1e-11)).state).reactions;
      };
      const double h = each.reach;
      const Points expected = (8 * (beside(h) - beside(-h)) - (beside(2 * h) - beside(-2 * h))) / (12 * h);
      EXPECT_LT((exact.reactions[a] - expected).norm(), 1e-6 * expected.norm()) << a;
    }
  }
}

/// Of numbers of the robot: of its modulus, the gain of its valve, and its weight.
TEST(Reactions, DerivativesByNumbersEqualDifferences) {
  RobotSpec spec = quarter_tube(1, false);
  add_weight(spec);
  spec.actuators[0].offset = 1;
  const std::vector<std::function<void(RobotSpec&, double)>> numbers{
      [](RobotSpec& s, double by) { *s.materials[0].elastic->youngs_modulus += by; },
      [](RobotSpec& s, double by) { s.actuators[0].factor += by; },
      [](RobotSpec& s, double by) { s.loads.gravity.x() += by; }};
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({30}));
  for (const auto& number : numbers) {
    const auto with = [&](double by) {
      RobotSpec other = spec;
      number(other, by);
      return compile(other);
    };
    const Model more = with(1e-5), less = with(-1e-5);
    const Perturbations perturbations(statics, {{more, less, 2e-5}});
    const ParameterSensitivity exact = perturbations.at(found.state, tight(), 1e-10, true);
    ASSERT_TRUE(exact.regular);
    const auto at = [&](double by) {
      const Model other = with(by);
      const Statics of(other);
      return of.measured(solve_converged(of, values({30}), tight(1e-11)).state).reactions;
    };
    constexpr double h = 1e-3;
    const Points expected = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
    EXPECT_LT((exact.reactions[0] - expected).norm(), 1e-6 * expected.norm());
  }
}

}  // namespace softkin
