#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "model/quadratic_mesh.hpp"
#include "support/points_in_body.hpp"

namespace softkin::testing {
namespace {

/// Returns a bar of 100 x 12 x 12, rolled up around an axis along y; its radius grows by `away` per lap.
Mesh spiral(Mesh bar, double laps, double away) {
  for (Index v = 0; v < bar.vertices.rows(); ++v) {
    const Vec3 p = vertex_at(bar.vertices, v);
    const double lap = laps * p.x() / 100, angle = 2 * std::numbers::pi * lap, radius = 14 + p.z() + away * lap;
    bar.vertices.row(v) << radius * std::sin(angle), p.y(), radius * std::cos(angle);
  }
  return bar;
}

std::size_t covered_of(const Mesh& mesh) {
  return covered_faces(mesh.vertices, mesh.tetrahedra, mesh.edge_nodes).size();
}

}  // namespace

TEST(PointsInBody, AreNoneOfBodiesThatAreApartFromThemselves) {
  for (const Split split : {Split::five, Split::six}) {
    const Mesh bar = block_mesh({40, 3, 3}, {100, 12, 12}, split);
    EXPECT_EQ(covered_of(bar), 0u);
    EXPECT_EQ(covered_of(spiral(bar, 1.4, 14)), 0u);
    EXPECT_EQ(covered_of(spiral(elevated(block_mesh({20, 2, 2}, {100, 12, 12}, split)), 1.4, 16)), 0u);
  }
  EXPECT_EQ(covered_of(bent(quadratic_block({3, 2, 2}, {3, 2, 2}))), 0u);
  EXPECT_EQ(covered_of(Mesh{}), 0u);
}

/// Laps that are 4 mm too near: the outer side of the first and the inner side of the last are covered where they are
/// over each other, 0.4 of 1.4 laps, by each other.
TEST(PointsInBody, AreFoundWhereLapsLieInEachOther) {
  const Mesh first = spiral(block_mesh({56, 3, 3}, {100, 12, 12}), 1.4, 8);
  const Mesh second = spiral(elevated(block_mesh({28, 3, 3}, {100, 12, 12})), 1.4, 8);
  for (const Mesh* mesh : {&first, &second}) {
    const bool quadratic = !mesh->edge_nodes.empty();
    const std::vector<CoveredFace> found = covered_faces(mesh->vertices, mesh->tetrahedra, mesh->edge_nodes);
    const std::size_t cells_along = 16, per_cell = 6;  // two triangles on each of three cells across
    const std::size_t on_each = cells_along * per_cell * (quadratic ? 2 : 1);
    EXPECT_GE(found.size(), 2 * on_each - 4 * per_cell);
    EXPECT_LE(found.size(), 2 * on_each + 60);  // and of the sides of the bar's ends
    for (const CoveredFace& face : found) {
      EXPECT_NE(face.owner, face.inside);
      const double away = (face.where - vertex_at(mesh->vertices, face.face[0])).norm();
      EXPECT_LT(away, 6);
    }
  }
}

/// A tetrahedron of order 2 whose bulge alone enters the block: its corners are outside, and the block's vertices too.
TEST(PointsInBody, SeeTheBulgeOfAnElementOfOrder2) {
  Mesh mesh;
  mesh.vertices.resize(8, 3);
  mesh.vertices << 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, -4, -9, -9, 1.2, 9, -9, 1.2, 0, 18, 1.2, 0, 0, 20;
  mesh.tetrahedra = {{0, 2, 1, 3}, {4, 5, 6, 7}};
  for (const Tetrahedron& t : mesh.tetrahedra) ASSERT_GT(signed_volume(mesh.vertices, t), 0);
  mesh = elevated(mesh);
  EXPECT_EQ(covered_of(mesh), 0u);
  for (Index v = 8; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices(v, 2) == 0) mesh.vertices(v, 2) = 1.5;  // the middles of the three edges on top
  const std::vector<CoveredFace> found = covered_faces(mesh.vertices, mesh.tetrahedra, mesh.edge_nodes);
  ASSERT_EQ(found.size(), 1u);  // the middle one of the four parts
  EXPECT_EQ(found[0].owner, 0u);
  EXPECT_EQ(found[0].inside, 1u);
  EXPECT_NEAR(found[0].where.z(), 1.5, 1e-4);
  EXPECT_GT(found[0].where.z(), 1.5);
}

/// The face that looks at the other body is found as soon as its point is in it, not before.
TEST(PointsInBody, AreFoundFromTheFirstStepOn) {
  Mesh mesh;
  mesh.vertices.resize(8, 3);
  mesh.vertices << 2, 0, 0, 3, 0, 0, 2, 1, 0, 2, 0, 1, -9, -9, 0, 9, -9, 0, 0, 18, 0, 0, 0, -9;
  mesh.tetrahedra = {{0, 1, 2, 3}, {4, 6, 5, 7}};
  for (const Tetrahedron& t : mesh.tetrahedra) ASSERT_GT(signed_volume(mesh.vertices, t), 0);
  const double diagonal = std::sqrt(18 * 18 + 27 * 27 + 100.0);
  const auto covered_at = [&](double height) {
    Points moved = mesh.vertices;
    moved.topRows(4).col(2).array() += height * diagonal;
    return covered_faces(moved, mesh.tetrahedra).size();
  };
  EXPECT_EQ(covered_at(1.1e-6), 0u);  // its point is 1e-6 below it
  EXPECT_EQ(covered_at(0.9e-6), 1u);
  EXPECT_EQ(covered_at(-1e-3), 1u);
  // turned inside out: what it covers, and its own four faces, whose outer side is taken to be within
  std::swap(mesh.tetrahedra[1][0], mesh.tetrahedra[1][1]);
  EXPECT_EQ(covered_at(-1e-3), 5u);
}

}  // namespace softkin::testing
