#include <Eigen/Geometry>
#include <numbers>
#include <softkin/model/joined.hpp>
#include <softkin/model/layer.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

/// Sheets on faces and on surfaces: areas, directions, refusals.

namespace softkin {

namespace {

using namespace testing;

LayerSpec paper(const std::string& region = "z_low") {
  LayerSpec layer;
  layer.name = "paper";
  layer.where = RegionRef{region, line(8)};
  layer.thickness_mm = 0.1;
  layer.e1 = layer.e2 = 100;
  layer.g12 = 40;
  layer.nu12 = 0.25;
  layer.origin = line(7);
  return layer;
}

RobotSpec sheeted_block(bool quadratic = false, Split split = Split::six) {
  RobotSpec spec = physical_robot(block_mesh({5, 3, 2}, {30, 12, 10}, split));
  spec.mesh_options.quadratic = quadratic;
  return spec;
}

RobotSpec with(RobotSpec spec, const LayerSpec& layer) {
  spec.layers.push_back(std::make_shared<const LayerSpec>(layer));
  return spec;
}

double area_of(const Layer& layer) {
  double area = 0;
  for (const LayerPlace& place : layer.places) area += place.area_mm2;
  return area;
}

}  // namespace

TEST(CompileLayers, HaveTheAreaAndTheDirectionsOfTheirFaces) {
  for (const bool quadratic : {false, true}) {
    LayerSpec spec = paper("y_high");
    spec.direction = Vec3(1, 5, 1);  // laid onto the face: along x and z
    const Model model = compile(with(sheeted_block(quadratic), spec));
    ASSERT_EQ(model.reinforcement.layers.size(), 1u);
    const Layer& layer = *model.reinforcement.layers[0];
    EXPECT_NEAR(area_of(layer), 300, 1e-9);
    EXPECT_EQ(layer.faces.size(), 20u);
    EXPECT_TRUE(layer.bends.empty());
    for (const LayerPlace& place : layer.places) {
      Eigen::Matrix<double, 3, 2> f = Eigen::Matrix<double, 3, 2>::Zero();
      for (std::size_t i = 0; i < place.vertices.size(); ++i)
        f += vertex_at(model.rest, place.vertices[i]) * place.slopes[i].transpose();
      EXPECT_LT((f.col(0) - Vec3(1, 0, 1).normalized()).norm(), 1e-12);
      EXPECT_LT((f.transpose() * f - Eigen::Matrix2d::Identity()).norm(), 1e-12);
    }
  }
}

TEST(CompileLayers, BendInEveryTriangle) {
  LayerSpec spec = paper();
  spec.bending = true;
  const Model model = compile(with(sheeted_block(true), spec));
  const Layer& layer = *model.reinforcement.layers[0];
  EXPECT_EQ(layer.bends.size(), 3u * 30u);
  EXPECT_EQ(layer.joints.size(), 2u * 37u);  // inner edges: (3 * 30 - 16) / 2
  for (const LayerJoint& joint : layer.joints) EXPECT_NEAR(joint.joint.angle, 0, 1e-15);
  double length = 0;
  for (const LayerJoint& joint : layer.joints) length += joint.joint.length;
  EXPECT_NEAR(length, 2 * 30 + 4 * 12 + 15 * std::hypot(6, 4), 1e-9);
}

TEST(CompileLayers, TurnFreelyWhereTheyAreFoldedAndAreClampedByWhatIsHeld) {
  RobotSpec robot = sheeted_block(true);
  LayerSpec around = paper("all");  // the whole surface: its edges are folded by 90 degrees, and hold
  around.bending = true;
  const Model whole = compile(with(robot, around));
  const auto folded = [](const Layer& layer) {
    return std::count_if(layer.joints.begin(), layer.joints.end(),
                         [](const LayerJoint& joint) { return std::abs(joint.joint.angle) > 1.5; });
  };
  EXPECT_EQ(folded(*whole.reinforcement.layers[0]), 2 * 4 * (5 + 3 + 2));
  LayerSpec spec = paper();
  spec.bending = true;
  robot.fixed = {{{Selector(Box{{-1, -1, -1}, {6, 20, 20}}), {}}, {true, true, true}}};
  const Model clamped = compile(with(robot, spec));
  const Layer& layer = *clamped.reinforcement.layers[0];
  EXPECT_EQ(layer.bends.size(), 3u * 24u);
  EXPECT_EQ(std::count_if(layer.joints.begin(), layer.joints.end(),
                          [](const LayerJoint& joint) { return joint.joint.fraction[0] == 1; }),
            2 * 3);
}

TEST(CompileLayers, OfASurfaceHaveItsArea) {
  LayerSpec spec = paper();
  TriangleSurface surface;
  surface.vertices.resize(4, 3);
  surface.vertices << 1, 1, 4.5, 28, 1, 4.5, 28, 11, 4.5, 1, 11, 4.5;
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  spec.where = surface;
  for (const bool quadratic : {false, true}) {
    const Model model = compile(with(sheeted_block(quadratic), spec));
    EXPECT_NEAR(area_of(*model.reinforcement.layers[0]), 270, 1e-9);
    EXPECT_GT(model.reinforcement.layers[0]->places.size(), 60u);
    EXPECT_TRUE(model.reinforcement.layers[0]->faces.empty());
  }
}

TEST(CompileLayers, WeighWhatTheirDensitySays) {
  LayerSpec spec = paper();
  spec.density = 900;
  for (const bool quadratic : {false, true}) {
    RobotSpec robot = with(sheeted_block(quadratic), spec);
    robot.loads.gravity = {0, 0, -9.81};
    const Vec3 weight = compile(robot).loads.dead.colwise().sum().transpose();
    EXPECT_LT((weight - Vec3(0, 0, -9.81 * 900e-9 * 0.1 * 360)).norm(), 1e-12);
  }
}

TEST(CompileLayers, FollowTheirRobots) {
  LayerSpec spec = paper();
  spec.direction = Vec3(1, 0, 0);
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()).toRotationMatrix();
  const RobotSpec bare = sheeted_block(), dressed = with(sheeted_block(), spec);
  const Model model = compile(
      joined({{"a", bare, {}, line(3)}, {"b", dressed, {turn, {100, 0, 0}}, line(4)}}, {"two.yaml", {}, {}, {}}));
  ASSERT_EQ(model.reinforcement.layers.size(), 1u);
  EXPECT_EQ(model.reinforcement.layers[0]->name, "b.paper");
  for (const LayerPlace& place : model.reinforcement.layers[0]->places) {
    Vec3 along = Vec3::Zero();
    for (std::size_t i = 0; i < place.vertices.size(); ++i)
      along += vertex_at(model.rest, place.vertices[i]) * place.slopes[i][0];
    EXPECT_LT((along - Vec3(0, 1, 0)).norm(), 1e-12);
  }
}

TEST(CompileLayers, ChangeTheFingerprint) {
  LayerSpec spec = paper();
  const std::string one = fingerprint_of(compile(with(sheeted_block(), spec)));
  EXPECT_NE(one, fingerprint_of(compile(sheeted_block())));
  spec.thickness_mm *= 2;
  EXPECT_NE(one, fingerprint_of(compile(with(sheeted_block(), spec))));
}

TEST(CompileLayers, RefuseWhatMakesNoSense) {
  const auto refused = [](const LayerSpec& spec, const std::string& fragment,
                          const RobotSpec& robot = sheeted_block()) {
    try {
      (void)compile(with(robot, spec));
      ADD_FAILURE() << fragment;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(fragment), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(":7"), std::string::npos) << error.what();
    }
  };
  LayerSpec spec = paper();
  spec.thickness_mm = 0;
  refused(spec, "needs a thickness above 0");
  spec = paper();
  spec.e1 = std::nan("");
  refused(spec, "needs a Young's modulus along");
  spec = paper();
  spec.nu12 = 1.2;
  refused(spec, "its square must be below e1 / e2, 1");
  spec = paper();
  spec.direction = Vec3(0, 0, 1);
  refused(spec, "stands across one of its faces");
  refused(paper("x_low"), "has quadrilaterals", sheeted_block(false, Split::prisms));
  spec = paper();
  spec.where = RegionRef{Selector(VertexList{{0, 1}}), line(7)};
  refused(spec, "holds no face of the body");
  spec = paper();
  spec.density = -1;
  refused(spec, "needs a density of 0 or more");
  spec = paper();
  TriangleSurface far;
  far.vertices.resize(3, 3);
  far.vertices << 0, 0, 90, 30, 0, 90, 30, 12, 90;
  far.triangles = {{0, 1, 2}};
  spec.where = far;
  refused(spec, "mm from the body");
  spec.bending = true;
  refused(spec, "bends, which takes faces of the mesh");
  spec = paper();
  spec.bending = true;
  refused(spec, "takes a mesh of order 2");
  spec = paper();
  refused(spec, "there are two layers 'paper'", with(sheeted_block(), spec));
}

TEST(CompileLayers, AreLeftOutOfTargetShapes) {
  RobotSpec spec = with(sheeted_block(), paper());
  spec.formulation = Formulation::target_shape;
  spec.materials[0].shape_ratio = 1;
  const Model model = compile(spec);
  EXPECT_TRUE(model.reinforcement.layers.empty());
  ASSERT_FALSE(model.notes.empty());
  EXPECT_NE(model.notes.back().find("layer is left out"), std::string::npos);
}

}  // namespace softkin
