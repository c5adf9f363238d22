#include <gtest/gtest.h>

#include <cmath>
#include <softkin/model/names.hpp>

#include "model/compile_testing.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

constexpr std::array<bool, 3> every{true, true, true}, along_x{true, false, false}, along_y{false, true, false},
    along_z{false, false, true};

RobotSpec free_block() {
  RobotSpec spec = block_robot(block_mesh({2, 2, 2}, {20, 20, 20}));
  spec.fixed.clear();
  return spec;
}

FixedSpec hold(std::vector<Index> vertices, std::array<bool, 3> axes) {
  return {shaped(VertexList{std::move(vertices)}), axes};
}

// Vertices of the block: x + 3 y + 9 z, in steps of 10 mm.
TEST(Anchoring, SaysHowAPartCanMove) {
  const auto fix = [](std::vector<FixedSpec> fixed) { return [=](RobotSpec& spec) { spec.fixed = fixed; }; };
  RobotSpec good = free_block();
  good.fixed = {hold({0}, every), hold({2}, {false, true, true}), hold({6}, along_z)};
  expect_refused(good,
                 {
                     {"nothing", fix({}),
                      "block: the robot of 27 vertices around (10, 10, 10) mm can move along x, y and z and turn about "
                      "x, y and z"},
                     {"feet", fix({{named("z_low"), along_z}}), "mm can move along x and y and turn about z:"},
                     {"vertex", fix({hold({4}, every)}), "mm can turn about x, y and z:"},
                     {"edge", fix({hold({0, 3, 6}, every)}), "mm can turn about y:"},
                     {"edge away from the axes", fix({hold({2, 11, 20}, every)}), "mm can turn about z:"},
                     {"two walls", fix({{named("x_low"), along_x}, {named("y_low"), along_y}}), "mm can move along z:"},
                     {"one short", fix({hold({0}, every), hold({2}, {false, true, true})}), "mm can turn about x:"},
                     {"feet and a pin", fix({{named("z_low"), along_z}, hold({4}, every)}), "mm can turn about z:"},
                     {"diagonal", fix({hold({0, 13, 26}, every)}), "0.57735"},
                 });
}

TEST(Anchoring, FeetAndTwoHeldVerticesSuffice) {
  RobotSpec spec = free_block();
  spec.fixed = {{named("z_low"), along_z}, hold({0}, every), hold({2}, along_y)};
  const Model model = compile(spec);
  EXPECT_EQ(model.held.fixed[0], every);
  EXPECT_EQ(model.held.fixed[2], (std::array<bool, 3>{false, true, true}));
  EXPECT_EQ(model.held.fixed[8], along_z);
  EXPECT_EQ(model.held.fixed[9], (std::array<bool, 3>{false, false, false}));
}

/// Two blocks of one cell with a gap of 10 mm between x = 10 and x = 20; the first is fixed at x = 0.
RobotSpec two_blocks() {
  RobotSpec spec = block_robot(block_mesh({3, 1, 1}, {30, 10, 10}));
  spec.voids.push_back(shaped(Box{{10, 0, 0}, {20, 10, 10}}));
  return spec;
}

TEST(Anchoring, EveryPartMustBeHeld) {
  EXPECT_NE(refusal(two_blocks()).find("a part of 8 vertices around (25, 5, 5) mm can move along x, y and z and turn"),
            std::string::npos);
  RobotSpec rigid = two_blocks();
  rigid.rigid.push_back({shaped(Box{{10, 0, 0}, {20, 10, 10}}), "link"});
  EXPECT_EQ(refusal(rigid), "");
  EXPECT_EQ(compile(rigid).rigid[0].vertices.size(), 8u);
  RobotSpec tied = two_blocks();
  tied.actuators.push_back(cable({at(2, 5, 9), at(10, 5, 9), at(20, 5, 9), at(28, 5, 9)}));
  tied.actuators[0].as<CableSpec>()->apexes = {at(10, 5, 1)};
  EXPECT_EQ(refusal(tied), "");
}

TEST(Rigid, RegionsAreHeldByAFaceOrNotAtAll) {
  RobotSpec good = free_block();
  good.fixed = {{named("x_low"), every}};
  good.rigid = {{named("x_high", 3), "leg"}};
  const auto fix = [](std::vector<Index> vertices, std::array<bool, 3> axes) {
    return [=](RobotSpec& spec) { spec.fixed.push_back(hold(vertices, axes)); };
  };
  expect_refused(good, {
                           {"one", fix({2}, along_z),
                            "robot.yaml:3: rigid region 'leg' is held along z at fewer than three non-collinear "
                            "vertices: hold a face of it or none"},
                           {"a line", fix({2, 5, 8}, along_y), "rigid region 'leg' is held along y at fewer than"},
                           {"mixed",
                            [](RobotSpec& spec) {
                              spec.fixed.push_back(hold({2, 5, 11}, along_y));
                              spec.fixed.push_back(hold({2, 5}, along_x));
                            },
                            "is held along x at fewer than"},
                       });
  RobotSpec face = good;
  face.fixed.push_back(hold({2, 5, 11}, along_z));
  EXPECT_EQ(refusal(face), "");
  RobotSpec whole = good;
  whole.fixed.push_back(hold({2, 5, 11}, every));
  whole.fixed.push_back(hold({20}, along_z));
  EXPECT_EQ(refusal(whole), "");
}

RotationSpec about_z(double degrees = 0, std::optional<Vec3> about = {}) {
  return {{0, 0, 2}, degrees, about};
}

TEST(Turns, AreOfWhatIsHeldWholeByOneEntry) {
  RobotSpec good = free_block();
  good.fixed = {{named("z_low"), every}};
  good.fixed[0].rotation = about_z(90, Vec3(1, 2, 3));
  const auto change = [](const std::function<void(FixedSpec&)>& of) {
    return [=](RobotSpec& spec) { of(spec.fixed[0]); };
  };
  const auto also = [](const FixedSpec& fixed) { return [=](RobotSpec& spec) { spec.fixed.push_back(fixed); }; };
  FixedSpec other = hold({18}, every);
  other.rotation = about_z();
  FixedSpec overlapping = hold({0}, every);
  overlapping.rotation = about_z();
  expect_refused(
      good,
      {
          {"roller", change([](FixedSpec& f) {
             f.axes = {true, true, false};
           }),
           "robot.yaml:1: region 'z_low' is turned, but not held along all of x, y and z"},
          {"no axis", change([](FixedSpec& f) { f.rotation->axis = Vec3::Zero(); }), "has no direction"},
          {"infinite axis", change([](FixedSpec& f) { f.rotation->axis[0] = HUGE_VAL; }), "has no direction"},
          {"far", change([](FixedSpec& f) { f.rotation->degrees = 4000; }), "by 4000 degrees: at most 3600 either way"},
          {"nan", change([](FixedSpec& f) { f.rotation->degrees = NAN; }), "at most 3600"},
          {"nowhere", change([](FixedSpec& f) { f.rotation->about = Vec3(0, NAN, 0); }), "a point that is not finite"},
          {"on the axis", also(other), "the list of vertices is turned about an axis on which all of its vertices lie"},
          {"held otherwise", also(hold({0}, along_x)),
           "holds vertex 0 (from 0), which an earlier entry holds, and one of the two turns it"},
          {"turned otherwise", also(overlapping), "and one of the two turns it"},
          {"rigid and otherwise held",
           [](RobotSpec& spec) {
             spec.fixed.push_back(hold({18, 20, 24}, every));
             spec.rigid.push_back({named("y_low", 3), "side"});
             spec.rigid.push_back({named("x_high", 4), "end"});
           },
           "robot.yaml:3: rigid region 'side' is held by 'z_low', which turns it, and by another support"},
          {"name of an actuator",
           [](RobotSpec& spec) {
             spec.actuators.push_back(cable({at(2, 5, 9), at(18, 5, 9)}));
             spec.actuators[0].name = "z_low_turn";
             spec.actuators[0].as<CableSpec>()->apexes = {at(10, 5, 1)};
           },
           "the command 'z_low_turn' has the name of an actuator"},
      });
}

TEST(Turns, AreCommandsInDegrees) {
  RobotSpec spec = free_block();
  spec.fixed = {{named("z_low"), every, Vec3(1, 0, 0)}, hold({18, 20, 24}, every)};
  spec.fixed[0].rotation = about_z(90);
  spec.fixed[1].rotation = about_z(-5, Vec3(1, 2, 3));
  const Model model = compile(spec);
  ASSERT_EQ(model.held.turns.size(), 2u);
  EXPECT_EQ(model.held.turns[0].axis, Vec3(0, 0, 1));
  EXPECT_LT((model.held.turns[0].about - Vec3(10, 10, 0)).norm(), 1e-12);
  EXPECT_EQ(model.held.turns[0].displacement, Vec3(1, 0, 0));
  EXPECT_EQ(model.held.turns[1].about, Vec3(1, 2, 3));
  EXPECT_EQ(model.held.turns[1].vertices, (std::vector<Index>{18, 20, 24}));
  ASSERT_EQ(model.actuators.size(), 2u);
  EXPECT_EQ(command_column(model.actuators[0]), "z_low_turn_deg");
  EXPECT_EQ(command_column(model.actuators[1]), "fixed_2_turn_deg");
  EXPECT_EQ(command_unit(model.actuators[0]), "deg");
  EXPECT_FALSE(drives(model.actuators[0]));
  EXPECT_EQ(model.rest_actuation(), Eigen::VectorXd(Eigen::Vector2d(90, -5)));
  RobotSpec without = spec, elsewhere = spec;
  without.fixed[0].rotation.reset();
  elsewhere.fixed[0].rotation->about = Vec3(0, 10, 0);
  EXPECT_NE(fingerprint_of(compile(without)), fingerprint_of(model));
  EXPECT_NE(fingerprint_of(compile(elsewhere)), fingerprint_of(model));
}

TEST(Rigid, RegionsAreDisjointAndSpanAPlane) {
  RobotSpec good = free_block();
  good.fixed = {{named("x_low"), every}};
  good.rigid = {{named("x_high"), "leg"}};
  const auto rigid = [](const RegionRef& where, const std::string& name) {
    return [=](RobotSpec& spec) { spec.rigid.push_back({where, name}); };
  };
  expect_refused(good,
                 {
                     {"overlap", rigid(named("y_low", 4), "side"),
                      "robot.yaml:4: rigid region 'side' and rigid region 'leg' share vertex 2 (from 0)"},
                     {"nameless", rigid(named("y_low", 4), ""), "region 'y_low' and rigid region 'leg' share"},
                     {"line", rigid(shaped(VertexList{{0, 3, 6}}), "edge"), "rigid region 'edge' needs three vertices"},
                     {"two", rigid(shaped(VertexList{{0, 3}}), ""), "the list of vertices needs three vertices"},
                     {"twice", rigid(shaped(VertexList{{0, 3, 9}}), "leg"), "there are two rigid regions 'leg'"},
                     {"unknown", rigid(named("x_hihg"), "b"), "did you mean 'x_high'?"},
                 });
}

}  // namespace
