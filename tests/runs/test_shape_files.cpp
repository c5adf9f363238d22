#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/runs/obstacle_picture.hpp>
#include <softkin/runs/shape_files.hpp>
#include <softkin/statics/deformation.hpp>

#include "small_runs.hpp"

namespace softkin::runs {
namespace {

using namespace testing;

/// A block, and what surrounds it.
std::string surrounded_scene(const std::string& obstacles, int order = 1) {
  return "softkin: 1\nmesh: {file: block.msh, order: " + std::to_string(order) +
         "}\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\nvoid: [chamber]\nfixed: [{region: base}]\n"
         "markers: [{name: tip, region: tip}]\n" +
         obstacles;
}

const char* const floor_and_box =
    "obstacles:\n"
    "  - {name: floor, halfspace: {point: [0, 0, -1], normal: [0, 0, 1]}}\n"
    "  - {name: kerb, box: [[20, 0, 0], [30, 10, 10]]}\n";

std::string written(const TemporaryFolder& folder, const std::string& name, const Model& model) {
  const std::string path = folder / name;
  write_shape(path, model, {model.rest}, deformation_of(model, model.rest), true);
  return path;
}

TEST(ShapeFiles, ObstaclesAreTrianglesOfTheirName) {
  for (const int order : {1, 2}) {
    const Model model = block_model(surrounded_scene(floor_and_box, order));
    const TemporaryFolder folder;
    const std::string path = written(folder, "a.vtu", model);
    EXPECT_EQ(read_vtu_points(path), model.rest);  // a start
    const Mesh mesh = read_vtu(path);
    EXPECT_EQ(mesh.tetrahedra.size(), model.elements.tetrahedra.size());
    EXPECT_EQ(mesh.edge_nodes.size(), model.elements.edge_nodes.size());
    ASSERT_EQ(mesh.triangles.size(), 12u);
    const auto kerb = std::find_if(mesh.regions.begin(), mesh.regions.end(),
                                   [](const Region& region) { return region.name == "kerb"; });
    ASSERT_NE(kerb, mesh.regions.end());
    EXPECT_EQ(kerb->triangles.size(), 12u);
    EXPECT_NEAR(enclosed_volume(mesh.vertices, mesh.triangles), 1000, 1e-9);
    for (const Region& region : mesh.regions) EXPECT_NE(region.name, "floor");
  }
}

/// A state is restored bit by bit, with anchors of friction and the history of the material.
TEST(ShapeFiles, AStateIsReadAsItWasWritten) {
  const Model model = block_model(surrounded_scene("", 1));
  const TemporaryFolder folder;
  State state{model.rest};
  state.positions(3, 1) += 1.0 / 3;
  state.actuation = state.multipliers = Eigen::VectorXd::Constant(model.actuators.size(), 0.1);
  state.load_factor = 1.0 / 7;
  state.anchors = {{4, 1, 2, Vec3(0.2, 0.3, 0.5), 1e-3}, {5, 0, 7, Vec3(1, 0, 0), 0}};
  state.history = std::make_shared<const ViscousHistory>(ViscousHistory{{1, 1.1, 0.9, 0.01, 0, 1.0 / 3}});
  state.elapsed_s = 0.25;
  write_shape(folder / "a.vtu", model, state, deformation_of(model, state.positions), true);
  const State read = read_state(folder / "a.vtu", model);
  EXPECT_EQ(read.positions, state.positions);
  EXPECT_EQ(read.actuation, state.actuation);
  EXPECT_EQ(read.multipliers, state.multipliers);
  EXPECT_EQ(read.load_factor, state.load_factor);
  EXPECT_EQ(read.elapsed_s, state.elapsed_s);
  EXPECT_EQ(read.history->strains, state.history->strains);
  ASSERT_EQ(read.anchors.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.anchors[i].vertex, state.anchors[i].vertex);
    EXPECT_EQ(read.anchors[i].part, state.anchors[i].part);
    EXPECT_EQ(read.anchors[i].triangle, state.anchors[i].triangle);
    EXPECT_EQ(read.anchors[i].weights, state.anchors[i].weights);
    EXPECT_EQ(read.anchors[i].slipped_mm, state.anchors[i].slipped_mm);
  }
  EXPECT_EQ(read_vtu(folder / "a.vtu").tetrahedra.size(), model.elements.tetrahedra.size());
  state.load_factor = -1;  // of nothing known
  write_shape(folder / "b.vtu", model, state, deformation_of(model, state.positions), false);
  EXPECT_LT(read_state(folder / "b.vtu", model).load_factor, 0);
  Model other = model;
  other.rest(2, 0) += 0.1;
  EXPECT_THROW((void)read_state(folder / "a.vtu", other), InvalidInput);
}

double area_of(const PictureLayer& layer) {
  double sum = 0;
  for (const auto& [a, b, c] : layer.triangles) {
    const Vec3 at = vertex_at(layer.points, a);
    sum += 0.5 * (vertex_at(layer.points, b) - at).cross(vertex_at(layer.points, c) - at).norm();
  }
  return sum;
}

TEST(ShapeFiles, PicturesShowObstaclesNearTheRobot) {
  const Bounds robot(Vec3::Zero(), Vec3(12, 12, 12));  // its diagonal is 20.8 mm
  const auto layer_of = [&](const std::string& obstacle) {
    const Model model = block_model(surrounded_scene("obstacles: [" + obstacle + "]\n"));
    return obstacle_layer(model, model.rest, robot);
  };
  const auto box = layer_of("{name: a, box: [[14, 0, 0], [15, 10, 10]]}");
  ASSERT_TRUE(box.has_value());
  EXPECT_LT(box->opacity, 1);
  EXPECT_NEAR(area_of(*box), 2 * 100 + 4 * 10, 1e-9);
  // a bar of 1000 mm is cut off half a diagonal away from the robot
  const auto bar = layer_of("{name: a, box: [[14, 0, 0], [1014, 10, 10]]}");
  ASSERT_TRUE(bar.has_value());
  const double end = 12 + robot.diagonal().norm() / 2;
  EXPECT_NEAR(bar->points.col(0).maxCoeff(), end, 1e-9);
  EXPECT_NEAR(area_of(*bar), 100 + 4 * 10 * (end - 14), 1e-9);
  // a square with half a side of 1.2 times that of the robot
  const auto floor = layer_of("{name: a, halfspace: {point: [500, 300, -1], normal: [0, 0, 1]}}");
  ASSERT_TRUE(floor.has_value());
  EXPECT_NEAR(area_of(*floor), std::pow(1.2 * 12, 2), 1e-9);
  EXPECT_TRUE((floor->points.col(2).array() == -1).all());
  EXPECT_NEAR(floor->points.col(0).mean(), 6, 1e-9);
  const auto slope = layer_of("{name: a, halfspace: {point: [0, 0, -6], normal: [1, 0, 2]}}");
  ASSERT_TRUE(slope.has_value());
  for (Index i = 0; i < slope->points.rows(); ++i)
    EXPECT_NEAR(vertex_at(slope->points, i).dot(Vec3(1, 0, 2)), -12, 1e-9);
  EXPECT_FALSE(layer_of("{name: a, box: [[50, 0, 0], [60, 10, 10]]}").has_value());
  EXPECT_FALSE(layer_of("{name: a, halfspace: {point: [0, 0, -40], normal: [0, 0, 1]}}").has_value());

  const Model bare = block_model(surrounded_scene("")), model = block_model(surrounded_scene(floor_and_box));
  EXPECT_FALSE(obstacle_layer(bare, bare.rest, robot).has_value());
  EXPECT_FALSE(body_layer(model, model.rest).has_value());
  const Model grasped = block_model(surrounded_scene("bodies: [{name: a, box: [[14, 0, 0], [24, 10, 10]]}]\n"));
  const auto body = body_layer(grasped, grasped.rest);
  ASSERT_TRUE(body.has_value());
  EXPECT_NEAR(area_of(*body), 600, 1e-9);
  EXPECT_NE(image_png(model, model.rest, {}, "robot"), image_png(bare, bare.rest, {}, "robot"));
}

}  // namespace
}  // namespace softkin::runs
