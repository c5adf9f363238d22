#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/model.hpp>

#include "support/degenerate_scenes.hpp"
#include "support/exact_crossing.hpp"
#include "support/points_in_body.hpp"
#include "support/two_bodies.hpp"

namespace softkin::testing {
namespace {

std::vector<DegenerateCase> all_cases() {
  std::vector<DegenerateCase> cases;
  for (int i = 0; i < static_cast<int>(DegenerateCase::count); ++i) cases.push_back(static_cast<DegenerateCase>(i));
  return cases;
}

constexpr double gap = 0.125, press = 3;

std::size_t crossings_at(const DegenerateScene& scene, double down) {
  const Mesh& mesh = scene.robot.mesh;
  return crossings(moved_from(scene.upper, mesh.vertices, {0, 0, -down}), boundary_of(mesh.tetrahedra, {}).triangles)
      .size();
}

}  // namespace

TEST(DegenerateScenes, CompileToTwoBodiesThatAreHeld) {
  std::set<std::string> names;
  for (const DegenerateCase kind : all_cases()) {
    DegenerateScene scene = degenerate_scene(kind, gap, press);
    SCOPED_TRACE(scene.robot.name);
    names.insert(scene.robot.name);
    const Model model = compile(scene.robot);
    EXPECT_LE(model.elements.tetrahedra.size(), 300u);
    EXPECT_EQ(model.elements.tetrahedra.size(), scene.robot.mesh.tetrahedra.size());
    ASSERT_EQ(model.held.supports.size(), 2u);
    for (const Index v : model.held.supports[0].vertices) EXPECT_LT(v, scene.upper);
    for (const Index v : model.held.supports[1].vertices) {
      EXPECT_GE(v, scene.upper);
      EXPECT_DOUBLE_EQ(model.held.at(v, 2), model.rest(v, 2) - press);
      EXPECT_EQ(model.rest(v, 2), model.rest.col(2).maxCoeff());
    }
    for (const Tetrahedron& t : model.elements.tetrahedra) EXPECT_EQ(t[0] < scene.upper, t[3] < scene.upper);
    scene.robot.mesh_options.quadratic = true;
    // wedges and spikes of few elements may be round ones
    for (const std::string& warning : compile(scene.robot).warnings)
      EXPECT_EQ(warning.rfind("The edges are straight", 0), 0u) << warning;
  }
  EXPECT_EQ(names.size(), 11u);
}

/// In exact alignment: the first touch is at the gap to 2^-40 mm.
TEST(DegenerateScenes, TouchAtTheGapAndCrossBeyond) {
  for (const DegenerateCase kind : all_cases()) {
    const DegenerateScene scene = degenerate_scene(kind, gap, press);
    SCOPED_TRACE(scene.robot.name);
    EXPECT_EQ(crossings_at(scene, 0), 0u);
    EXPECT_EQ(crossings_at(scene, gap - 0x1p-40), 0u);
    EXPECT_GT(crossings_at(scene, gap), 0u);
    EXPECT_GT(crossings_at(scene, 2 * gap), 0u);
    const Mesh& mesh = scene.robot.mesh;
    EXPECT_EQ(covered_faces(mesh.vertices, mesh.tetrahedra).size(), 0u);
  }
}

TEST(DegenerateScenes, AreFoundCoveredWhereFacesEnter) {
  for (const DegenerateCase kind : all_cases()) {
    const DegenerateScene scene = degenerate_scene(kind, gap, press);
    const Mesh& mesh = scene.robot.mesh;
    const Points entered = moved_from(scene.upper, mesh.vertices, {0.1, 0.2, -gap - 9});
    EXPECT_GT(covered_faces(entered, mesh.tetrahedra).size(), 0u) << scene.robot.name;
  }
}

TEST(DegenerateScenes, MoveAsTheyAreTold) {
  std::size_t sliding = 0;
  for (const DegenerateCase kind : all_cases()) {
    const Vec3 move = degenerate_scene(kind, 1, 2).robot.fixed[1].displacement;
    EXPECT_EQ(move.z(), -2);
    EXPECT_EQ(move.y(), 0);
    sliding += move.x() == 2 ? 1 : 0;
  }
  EXPECT_EQ(sliding, 3u);
  for (const double bad : {0.0, -1.0, 5.0, std::nan("")})
    EXPECT_THROW((void)degenerate_scene(DegenerateCase::spikes, bad, 1), std::invalid_argument);
  EXPECT_THROW((void)degenerate_scene(DegenerateCase::count, 1, 1), std::invalid_argument);
}

}  // namespace softkin::testing
