#include <gtest/gtest.h>

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
  EXPECT_EQ(model.fixed[0], every);
  EXPECT_EQ(model.fixed[2], (std::array<bool, 3>{false, true, true}));
  EXPECT_EQ(model.fixed[8], along_z);
  EXPECT_EQ(model.fixed[9], (std::array<bool, 3>{false, false, false}));
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
  tied.actuators[0].apexes = {at(10, 5, 1)};
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
