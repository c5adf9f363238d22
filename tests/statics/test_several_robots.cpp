#include <Eigen/Geometry>
#include <softkin/model/joined.hpp>

#include "statics/contact_scenes.hpp"
#include "statics/physical_samples.hpp"

/// Robots that do not touch answer together as each does alone, and those that touch as the parts of one mesh do.

namespace softkin {

namespace {

using namespace testing;

Placement turned_place(double angle, const Vec3& axis, const Vec3& to) {
  return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), to};
}

Placement upside_down(const Vec3& to) {
  Placement place;
  place.rotation = Vec3(1, -1, -1).asDiagonal();
  place.translation = to;
  return place;
}

RobotSpec together(const RobotSpec& spec, const std::vector<Placement>& places) {
  std::vector<PlacedRobot> robots;
  for (std::size_t i = 0; i < places.size(); ++i) robots.push_back({"r" + std::to_string(i), spec, places[i], {}});
  return joined(robots, {"all", {}, {}, {}});
}

/// Solves a robot alone with each actuation and as many of it together, one at each place. close: over the diagonal
void expect_alike(const RobotSpec& spec, const std::vector<Placement>& places, const std::vector<Actuation>& requested,
                  double close = 1e-9) {
  const Model alone = compile(spec), all = compile(together(spec, places));
  const Statics one(alone), whole(all);
  Actuation every(alone.actuators.size() * places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    every.segment(static_cast<Index>(i) * requested[i].size(), requested[i].size()) = requested[i];
  const Equilibrium found = whole.solve(every, {all.rest}, tight());
  ASSERT_EQ(found.report.status, Status::converged) << found.report.remark;
  const Index count = alone.rest.rows();
  ASSERT_EQ(all.rest.rows(), count * static_cast<Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Equilibrium expected = one.solve(requested[i], {alone.rest}, tight());
    ASSERT_EQ(expected.report.status, Status::converged) << expected.report.remark;
    const Points& shape = expected.state.positions;
    EXPECT_GT((shape - alone.rest).rowwise().norm().maxCoeff(), 0.02 * alone.diagonal_mm);
    const Points moved = (shape * places[i].rotation.transpose()).rowwise() + places[i].translation.transpose();
    const Points there = found.state.positions.middleRows(static_cast<Index>(i) * count, count);
    EXPECT_LT((there - moved).rowwise().norm().maxCoeff(), close * alone.diagonal_mm) << "robot " << i;
  }
}

const std::vector<Placement>& three_places() {
  static const std::vector<Placement> places{
      {Mat3::Identity(), Vec3(0, -20, 0)}, upside_down({0, 20, 0}), turned_place(2.2, {1, 2, -1}, {100, -50, 20})};
  return places;
}

}  // namespace

/// A finger with a chamber, a cable, a rigid end and a force at it, held by a shape.
TEST(SeveralRobots, PhysicalFingersAnswerAsEachAlone) {
  RobotSpec spec = bending_finger();
  spec.fixed = {{{Selector(Box{{-1, -1, -1}, {0, 20, 20}}), {}}}};
  spec.rigid.push_back({{Selector(Halfspace{{59, 0, 0}, {1, 0, 0}}), {}}, "rigid_1"});
  spec.actuators.push_back(cable("tendon", {{0, 6, 14}, {30, 6, 14}, {58, 6, 14}}));
  spec.loads.forces.push_back({"push", {Vec3(55, 6, 8), {}}, Vec3(0, 0.002, -0.004)});
  expect_alike(spec, three_places(), {values({1.6, 0.97}), values({1.3, 0.99}), values({1.5, 0.98})});
}

TEST(SeveralRobots, OfOrderTwo) {
  RobotSpec spec = physical_robot(block_mesh({4, 1, 1}, {40, 8, 8}));
  spec.mesh_options.quadratic = true;
  // shapes choose nodes of edges whose ends they do not hold
  spec.fixed = {{{Selector(Halfspace{{6, 0, 0}, {-1, 0, 0}}), {}}}};
  spec.loads.forces.push_back({"push", {std::string("x_high"), {}}, Vec3(0, 0.02, -0.04)});
  expect_alike(spec, three_places(), {Actuation(0), Actuation(0), Actuation(0)});
}

/// A plane of symmetry and a displacement, under quarter turns.
TEST(SeveralRobots, SupportsAlongSomeAxesAndPulled) {
  RobotSpec spec = physical_robot(block_mesh({4, 2, 2}, {40, 16, 16}));
  spec.fixed = {{{std::string("x_low"), {}}, {true, false, false}},
                {{std::string("y_low"), {}}, {false, true, false}},
                {{std::string("z_low"), {}}, {false, false, true}},
                {{std::string("x_high"), {}}, {true, false, false}, Vec3(4, 0, 0)}};
  Placement about_z = turned_place(0, {0, 0, 1}, {0, 100, 0});
  about_z.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  expect_alike(spec, {{}, upside_down({0, 50, 5}), about_z}, {Actuation(0), Actuation(0), Actuation(0)});
}

/// Chambers that are the empty space of their robot's body.
TEST(SeveralRobots, ChambersThatAreEmptySpaces) {
  RobotSpec spec = robot_with_bags({"bag"});
  spec.actuators[0].as<PneumaticSpec>()->surface.reset();
  expect_alike(spec, three_places(), {values({1.8}), values({2}), values({1.5})});
}

TEST(SeveralRobots, ChambersOfSurfaces) {
  RobotSpec spec = robot_with_bags({"bag"});
  spec.actuators[0].as<PneumaticSpec>()->surface =
      box_surface({13.9, 6.1, 12.2}, {23.7, 5.8, 5.6});  // no vertex on a face of elements
  // how finely a surface is cut where it passes through elements goes by the size of all
  expect_alike(spec, three_places(), {values({1.8}), values({2}), values({1.5})}, 1e-4);
}

/// With prisms of a dea, a chamber and a cable.
TEST(SeveralRobots, TargetShapesAnswerAsEachAlone) {
  expect_alike(mixed_robot(true), three_places(),
               {values({1.2, 1.3, 0.9}), values({1, 1.2, 0.95}), values({1.3, 1, 0.9})});
}

namespace {

/// The blocks of StackedBlocks, each a robot of its own.
RobotSpec two_robots(const StackedBlocks& blocks) {
  const auto block = [&](const std::array<int, 3>& cells, int top) {
    const Mesh mesh = layered_mesh(cells, Vec3::Constant(StackedBlocks::size), Split::six, Split::six);
    RobotSpec spec = physical_robot(blocks.quadratic ? elevated(mesh) : mesh);
    const Points& at = spec.mesh.vertices;
    spec.fixed = {plane_support(at, 2, top * StackedBlocks::size, -top * blocks.press), plane_support(at, 0, 0),
                  plane_support(at, 1, 0)};
    return spec;
  };
  Placement above;
  above.translation = Vec3(0, 0, StackedBlocks::size + blocks.gap);
  RobotSpec both =
      joined({{"lower", block({3, 3, 2}, 0), {}, {}}, {"upper", block({4, 4, 2}, 1), above, {}}}, {"all", {}, {}, {}});
  both.contact = contact_below(blocks.distance);
  return both;
}

const Reaction& reaction_named(const Model& model, const std::vector<Reaction>& all, const std::string& name) {
  const auto found = std::find_if(model.held.supports.begin(), model.held.supports.end(),
                                  [&](const Support& support) { return support.name == name; });
  return all[found - model.held.supports.begin()];
}

}  // namespace

TEST(SeveralRobots, ThatPressEachOtherAreInBalance) {
  for (const bool quadratic : {false, true}) {
    const StackedBlocks blocks{0.1, 0.3, 1.5, quadratic};
    RobotSpec spec = two_robots(blocks);
    spec.contact->self = false;  // holds of each alone
    const Model model = compile(spec), one = compile(blocks.robot());
    const Statics statics(model);
    const Equilibrium found = solve_converged(statics, {}, tight());
    const ElementDeformation measured = statics.measured(found.state);
    ASSERT_TRUE(measured.contacts.has_value());
    ASSERT_EQ(measured.contacts->pairs.size(), 1u);
    const PairForces& pair = measured.contacts->pairs[0];
    EXPECT_EQ(model.contact.label(pair.a), "robot 'lower'");
    EXPECT_EQ(model.contact.label(pair.b), "robot 'upper'");
    const std::vector<Reaction> all = reactions(model, found.state.positions, measured);
    const Reaction &below = reaction_named(model, all, "lower.fixed_1"),
                   &above = reaction_named(model, all, "upper.fixed_1");
    const double load = below.force.z();
    EXPECT_GT(load, 10);  // E 1 MPa, 3 % of strain on 400 mm^2
    EXPECT_NEAR(above.force.z(), -load, 1e-9 * load);
    EXPECT_NEAR(pair.force.z(), -load, 1e-9 * load);  // of the upper on the lower
    EXPECT_NEAR(pair.normal_N, load, 0.01 * load);
    Vec3 moment = pair.moment + pair.center.cross(pair.force);
    for (std::size_t s = 0; s < all.size(); ++s)
      if (model.held.supports[s].name.starts_with("lower."))
        moment += all[s].moment + all[s].center.cross(all[s].force);
    EXPECT_LT(moment.norm(), 1e-8 * load * StackedBlocks::size);
    // two blocks of one mesh, which may touch itself
    const Statics single(one);
    const Equilibrium alone = solve_converged(single, {}, tight());
    EXPECT_NEAR(reaction_of(one, single, alone, 0).z(), load, 1e-8 * load);
    ASSERT_EQ(alone.state.positions.rows(), found.state.positions.rows());
    if (quadratic) continue;  // its vertices stand in another order
    EXPECT_LT((alone.state.positions - found.state.positions).rowwise().norm().maxCoeff(), 1e-8);
  }
}

/// Nearer at rest than surfaces of one robot may be.
TEST(SeveralRobots, ThatStandCloseToEachOtherPressFromTheStart) {
  const StackedBlocks blocks{0.1, 0.05, 0};
  const Model model = compile(two_robots(blocks));
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, {}, tight());
  const double load = reaction_of(model, statics, found, 0).z();
  double below = 0, above = 2 * StackedBlocks::size;
  for (Index v = 0; v < model.rest.rows(); ++v) {
    const double height = found.state.positions(v, 2);
    if (model.rest(v, 2) > StackedBlocks::size)
      above = std::min(above, height);
    else
      below = std::max(below, height);
  }
  EXPECT_GT(load, 0.1);
  EXPECT_GT(above - below, blocks.gap);
  EXPECT_LT(above - below, blocks.distance);
  EXPECT_THROW((void)Statics(compile(blocks.robot())), InvalidInput);
}

TEST(SeveralRobots, ThatTouchOrCrossAtRestAreRefused) {
  const auto refusal_of_gap = [](double gap) -> std::string {
    try {
      (void)Statics(compile(two_robots({0.1, gap, 0})));
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal_of_gap(1e-3), "");
  for (const double gap : {0.0, -0.5}) {
    const std::string message = refusal_of_gap(gap);
    EXPECT_NE(message.find("robot 'lower' and robot 'upper' touch or cross at rest, at ("), std::string::npos)
        << message;
    EXPECT_NE(message.find("mm: move one of the robots away"), std::string::npos) << message;
    EXPECT_EQ(message.find("by about 0.5 mm or more") != std::string::npos, gap < 0) << message;
  }
}

}  // namespace softkin
