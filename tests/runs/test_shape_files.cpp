#include <gtest/gtest.h>

#include <algorithm>
#include <softkin/io/mesh/vtk.hpp>
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
  write_shape(path, model, model.rest, deformation_of(model, model.rest), true);
  return path;
}

TEST(ShapeFiles, ObstaclesAreTrianglesOfTheirName) {
  for (const int order : {1, 2}) {
    const Model model = block_model(surrounded_scene(floor_and_box, order));
    const TemporaryFolder folder;
    const std::string path = written(folder, "a.vtu", model);
    EXPECT_EQ(read_vtu_points(path), model.rest);  // a start
    const Mesh mesh = read_vtu(path);
    EXPECT_EQ(mesh.tetrahedra.size(), model.tetrahedra.size());
    EXPECT_EQ(mesh.edge_nodes.size(), model.edge_nodes.size());
    ASSERT_EQ(mesh.triangles.size(), 12u);
    const auto kerb = std::find_if(mesh.regions.begin(), mesh.regions.end(),
                                   [](const Region& region) { return region.name == "kerb"; });
    ASSERT_NE(kerb, mesh.regions.end());
    EXPECT_EQ(kerb->triangles.size(), 12u);
    EXPECT_NEAR(enclosed_volume(mesh.vertices, mesh.triangles), 1000, 1e-9);
    for (const Region& region : mesh.regions) EXPECT_NE(region.name, "floor");
  }
}

TEST(ShapeFiles, PicturesAreOfTheRobotAlone) {
  const Model bare = block_model(surrounded_scene("")), model = block_model(surrounded_scene(floor_and_box));
  EXPECT_GT(model.rest.rows(), bare.rest.rows());
  EXPECT_EQ(image_png(model, model.rest, {}, "robot"), image_png(bare, bare.rest, {}, "robot"));
}

}  // namespace
}  // namespace softkin::runs
