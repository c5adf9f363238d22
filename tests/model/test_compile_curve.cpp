#include <gtest/gtest.h>

#include <softkin/model/joined.hpp>
#include <softkin/model/mesh/curved_edges.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/model.hpp>

#include "model/physical_robots.hpp"
#include "model/round_mesh.hpp"

namespace softkin {

namespace {

using namespace testing;

/// A rod of twelve corners, 10 mm radius and 60 mm length, held at one end.
RobotSpec round_rod(bool curved) {
  RobotSpec spec = physical_robot(rod_mesh(12, 1, 6, 10, 60));
  spec.fixed = {{{Halfspace{{1e-6, 0, 0}, {-1, 0, 0}}, {}}}};
  spec.mesh_options.quadratic = true;
  if (curved) spec.mesh_options.curve.emplace().smooth = true;
  return spec;
}

double volume_of(const Model& model) {
  double volume = 0;
  for (const double v : model.elements.tetrahedron_volumes) volume += v;
  return volume;
}

std::string refusal_of_curve(const RobotSpec& spec) {
  try {
    (void)compile(spec);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "taken";
}

bool mentions(const std::vector<std::string>& texts, const std::string& part) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

}  // namespace

TEST(CompileCurve, VolumesAndWeightAreThoseOfTheRoundBody) {
  const double round = std::numbers::pi * 100 * 60;
  RobotSpec spec = round_rod(true);
  spec.materials[0].density = 1000;
  spec.loads.gravity = {0, 0, -10};
  const Model model = compile(spec);
  EXPECT_NEAR(volume_of(model), round, 2e-3 * round);
  EXPECT_NEAR(model.loads.dead.col(2).sum(), -volume_of(model) * 1e-6 * 10, 1e-9);
  EXPECT_TRUE(mentions(model.notes, "'curve' moved ")) << "and says so";
  EXPECT_FALSE(mentions(model.warnings, "The edges are straight"));
}

TEST(CompileCurve, WarnsOfStraightEdgesAndOfNothingElse) {
  EXPECT_TRUE(mentions(compile(round_rod(false)).warnings, "about 5 % too small"));
  RobotSpec block = physical_robot(block_mesh({6, 2, 2}, {60, 10, 10}));
  block.mesh_options.quadratic = true;
  EXPECT_FALSE(mentions(compile(block).warnings, "The edges are straight"));
  RobotSpec own = round_rod(true);  // a mesh that brings its curved edges
  own.mesh = elevated(own.mesh);
  curve_edges(own.mesh, labels_of(own.mesh, own.mesh.regions), *own.mesh_options.curve);
  own.mesh_options.curve.reset();
  EXPECT_FALSE(mentions(compile(own).warnings, "The edges are straight"));
  RobotSpec linear = round_rod(false);
  linear.mesh_options.quadratic = false;
  EXPECT_FALSE(mentions(compile(linear).warnings, "The edges are straight"));
}

/// Nodes on the round surface lie outside of a cylinder through the middles of the straight edges.
TEST(CompileCurve, ShapesChooseAsWithStraightEdges) {
  RobotSpec straight = round_rod(false), curved = round_rod(true);
  for (RobotSpec* spec : {&straight, &curved})
    spec->fixed.push_back({{Cylinder{{50, 0, 0}, {70, 0, 0}, 9.7}, {}}, {false, true, false}});
  const Model one = compile(straight), other = compile(curved);
  EXPECT_EQ(one.held.fixed, other.held.fixed);
  EXPECT_EQ(one.rest.topRows(91), other.rest.topRows(91));
  EXPECT_GT((one.rest - other.rest).cwiseAbs().maxCoeff(), 0.3);
}

TEST(CompileCurve, RefusesWhatCannotBeMeant) {
  RobotSpec spec = round_rod(true);
  spec.mesh_options.curve->surfaces.push_back({Cylinder{{0, 0, 0}, {60, 0, 0}, 12}, {"s.yaml", 7}});
  EXPECT_NE(refusal_of_curve(spec).find("s.yaml:7: no edge of the mesh's surface has both ends on this cylinder"),
            std::string::npos);
  spec = round_rod(true);
  spec.mesh_options.curve->origin = {"s.yaml", 3};
  spec.mesh = elevated(spec.mesh);
  curve_edges(spec.mesh, labels_of(spec.mesh, spec.mesh.regions), *spec.mesh_options.curve);
  EXPECT_NE(refusal_of_curve(spec).find("s.yaml:3: the mesh's edges are curved already"), std::string::npos);
}

TEST(CompileCurve, RobotsAmongSeveralAreAsAlone) {
  const Model alone = compile(round_rod(true));
  CommonSpec common;
  common.name = "pair.yaml";
  PlacedRobot left, right;
  left.name = "left";
  left.robot = round_rod(true);
  right.name = "right";
  right.robot = round_rod(true);
  right.place.translation = {0, 50, 0};
  std::vector<PlacedRobot> robots;
  robots.push_back(std::move(left));
  robots.push_back(std::move(right));
  const Model pair = compile(joined(std::move(robots), common));
  EXPECT_NEAR(volume_of(pair), 2 * volume_of(alone), 1e-9 * volume_of(alone));
  EXPECT_LT((pair.rest.topRows(alone.rest.rows()) - alone.rest).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_TRUE(mentions(pair.notes, "Robot 'right': 'curve' moved "));
  EXPECT_FALSE(mentions(pair.warnings, "The edges are straight"));
}

}  // namespace softkin
