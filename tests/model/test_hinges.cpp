#include <softkin/core/error.hpp>
#include <softkin/model/model.hpp>

#include <gtest/gtest.h>

#include "model/physical_robots.hpp"

namespace softkin {
namespace {

using testing::block_mesh;
using testing::physical_robot;

/// Returns two cubes of 10 mm that have only the given vertices in common, on the second's face x = 10.
RobotSpec two_cubes(const std::vector<std::pair<double, double>>& shared) {
  Mesh mesh = block_mesh({1, 1, 1}, {10, 10, 10});
  const Mesh other = block_mesh({1, 1, 1}, {10, 10, 10});
  std::vector<Index> number;
  for (Index v = 0; v < other.vertices.rows(); ++v) {
    const Vec3 at = other.vertices.row(v).transpose() + Vec3(10, 0, 0);
    const bool common = std::any_of(shared.begin(), shared.end(),
                                    [&](const auto& yz) { return (at - Vec3(10, yz.first, yz.second)).norm() < 1e-9; });
    if (common) {
      Index same = 0;
      (mesh.vertices.rowwise() - at.transpose()).rowwise().norm().minCoeff(&same);
      number.push_back(same);
      continue;
    }
    number.push_back(mesh.vertices.rows());
    mesh.vertices.conservativeResize(mesh.vertices.rows() + 1, 3);
    mesh.vertices.bottomRows(1) = at.transpose() + Eigen::RowVector3d(common ? 0 : 1e-3, 0, 0);
  }
  for (const Tetrahedron& t : other.tetrahedra)
    mesh.tetrahedra.push_back({number[t[0]], number[t[1]], number[t[2]], number[t[3]]});
  return physical_robot(std::move(mesh));
}

std::string refusal_of(const RobotSpec& spec) {
  try {
    (void)compile(spec);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(Hinges, APartOnAVertexOrAnEdgeIsRefused) {
  const std::string vertex = refusal_of(two_cubes({{0, 0}})), edge = refusal_of(two_cubes({{0, 0}, {10, 0}}));
  EXPECT_NE(vertex.find("a part of 8 vertices around (15"), std::string::npos) << vertex;
  EXPECT_NE(vertex.find("hangs on vertex 1 (from 0) and can turn there"), std::string::npos) << vertex;
  EXPECT_NE(edge.find("hangs on the edge of vertices 1 and 3 (from 0)"), std::string::npos) << edge;
}

TEST(Hinges, ThreeVerticesOrAnotherSupportHoldIt) {
  EXPECT_EQ(refusal_of(two_cubes({{0, 0}, {10, 0}, {0, 10}})), "");
  RobotSpec held = two_cubes({{0, 0}, {10, 0}});
  held.fixed.push_back({{Box{{19, -1, 9}, {21, 11, 11}}, {}}, {false, false, true}});
  EXPECT_EQ(refusal_of(held), "") << "an edge holds all turns but one, the support at the far edge that one";
}

TEST(Hinges, ARigidRegionJoinsWhatItHolds) {
  RobotSpec spec = two_cubes({{0, 0}});
  spec.rigid.push_back({{Box{{9, -1, -1}, {11, 11, 11}}, {}}, "plate"});
  EXPECT_EQ(refusal_of(spec), "");
}

TEST(Hinges, PrismsAreJoinedBySides) {
  EXPECT_EQ(refusal_of(physical_robot(block_mesh({3, 2, 2}, {30, 20, 20}, testing::Split::prisms))), "");
}

}  // namespace
}  // namespace softkin
