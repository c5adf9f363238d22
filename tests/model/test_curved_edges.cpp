#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <softkin/model/mesh/curved_edges.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/mesh_review.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>

#include "model/random_round.hpp"
#include "support/patience.hpp"

namespace softkin {

namespace {

using namespace testing;

constexpr double curve_pi = std::numbers::pi;

CurveSpec smooth_curve(double crease = 50) {
  CurveSpec spec;
  spec.smooth = true;
  spec.crease_degrees = crease;
  return spec;
}

CurveSpec onto(std::vector<GivenSurface> surfaces) {
  CurveSpec spec;
  spec.surfaces = std::move(surfaces);
  return spec;
}

struct CurvedMesh {
  Mesh straight, mesh;
  CurvedEdges done;
};

CurvedMesh curved_mesh(const Mesh& linear, const CurveSpec& spec) {
  CurvedMesh result{elevated(linear), {}, {}};
  result.mesh = result.straight;
  result.done = curve_edges(result.mesh, labels_of(result.mesh, result.mesh.regions), spec);
  return result;
}

/// Nodes on edges of the boundary both of whose ends the test accepts.
template <class Accept>
std::vector<Index> boundary_nodes(const Mesh& mesh, const Accept& accept) {
  const EdgeTable edges(mesh);
  std::vector<Index> nodes;
  for (const Triangle& t : boundary_of(mesh.tetrahedra, {}).triangles)
    for (int i = 0; i < 3; ++i)
      if (accept(vertex_at(mesh.vertices, t[i])) && accept(vertex_at(mesh.vertices, t[(i + 1) % 3])))
        nodes.push_back(edges.find(t[i], t[(i + 1) % 3]));
  sort_unique(nodes);
  return nodes;
}

/// The least Jacobian of all elements over that of their corners, at the points of a lattice: by brute force.
double min_on_lattice(const Mesh& mesh, int steps) {
  double least = HUGE_VAL;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const TetrahedronNodes nodes = nodes_of(mesh.vertices, mesh.tetrahedra[t], mesh.edge_nodes[t]);
    const double straight = 6 * signed_volume(mesh.vertices, mesh.tetrahedra[t]);
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j)
        for (int k = 0; i + j + k <= steps; ++k) {
          const Barycentric l = Barycentric(i, j, k, steps - i - j - k) / steps;
          const Eigen::Matrix<double, 3, 4> along = nodes.transpose() * quadratic_slope(l);
          least = std::min(least, (along.rightCols<3>().colwise() - along.col(0)).determinant() / straight);
        }
  }
  return least;
}

}  // namespace

TEST(JacobianBound, IsBelowWhatSamplesFindAndExactOnStraightEdges) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> real(-1, 1);
  for (int i = 0; i < 200; ++i) {
    TetrahedronNodes nodes;
    nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, Eigen::Matrix<double, 6, 3>::Zero();
    for (int e = 0; e < 6; ++e)
      nodes.row(e + 4) = 0.5 * (nodes.row(tetrahedron_edges[e][0]) + nodes.row(tetrahedron_edges[e][1]));
    EXPECT_NEAR(min_jacobian_bound(nodes), 1, 1e-14);
    for (int e = 4; e < 10; ++e) nodes.row(e) += 0.15 * Eigen::RowVector3d(real(random), real(random), real(random));
    Mesh mesh;
    mesh.vertices = nodes;
    mesh.tetrahedra = {{0, 1, 2, 3}};
    mesh.edge_nodes = {{4, 5, 6, 7, 8, 9}};
    const double least = min_on_lattice(mesh, 16), bound = min_jacobian_bound(nodes);
    EXPECT_LE(bound, least + 1e-14);
    EXPECT_GT(bound, least - 0.5);
    EXPECT_LE(bound, min_jacobian(nodes) + 1e-14);
  }
}

/// Of rods of 10 to 24 corners straight edges take 6.5 to 1.1 % of the section.
TEST(CurvedEdges, ARodIsRoundAndItsEndsStayFlat) {
  for (const int corners : {10, 12, 16, 24}) {
    const CurvedMesh rod = curved_mesh(rod_mesh(corners, 1, 6, 10, 60), smooth_curve());
    const double exact = curve_pi * 100 * 60;
    EXPECT_NEAR(measure_curved(rod.mesh).volume, exact, 1.5e-3 * exact) << corners;
    EXPECT_LT(measure_curved(rod.straight).volume, 0.99 * exact);
    EXPECT_NEAR(measure_curved(rod.mesh).boundary, 2 * curve_pi * 10 * 60 + 2 * curve_pi * 100,
                2e-3 * 2 * curve_pi * 600);
    EXPECT_EQ(rod.done.held_back, 0u);
    for (const double end : {0.0, 60.0})
      for (const Index v : boundary_nodes(rod.mesh, [&](const Vec3& p) { return p.x() == end; }))
        EXPECT_NEAR(rod.mesh.vertices(v, 0), end, 1e-12);
    for (const Index v : boundary_nodes(rod.mesh, [](const Vec3& p) { return p.tail<2>().norm() > 9.9; }))
      EXPECT_NEAR(rod.mesh.vertices.row(v).tail<2>().norm(), 10, 0.03);
  }
}

TEST(CurvedEdges, ABallIsRound) {
  for (const double inner : {8.0, 9.8}) {  // the thinner shell is thinner than its edges' arcs are high
    for (const int cuts : {1, 2}) {
      const CurvedMesh ball = curved_mesh(shell_mesh(cuts, 1, inner, 10), smooth_curve());
      const double exact = 4 * curve_pi / 3 * (1000 - inner * inner * inner);
      EXPECT_NEAR(measure_curved(ball.mesh).volume, exact, (cuts == 1 ? 3e-3 : 3e-4) * exact);
      EXPECT_LT(measure_curved(ball.straight).volume, (cuts == 1 ? 0.88 : 0.97) * exact);
      EXPECT_EQ(ball.done.held_back, 0u);
      EXPECT_GT(min_on_lattice(ball.mesh, 6), 0.1);
    }
  }
}

TEST(CurvedEdges, OntoGivenSurfaces) {
  const GivenSurface side{Cylinder{{0, 0, 0}, {60, 0, 0}, 10}, {}};
  for (const int corners : {6, 8}) {
    const CurvedMesh rod = curved_mesh(rod_mesh(corners, 1, 12, 10, 60), onto({side}));
    EXPECT_EQ(rod.done.held_back, 0u);
    EXPECT_GT(rod.done.taken[0], 0u);
    for (const Index v : boundary_nodes(rod.mesh, [](const Vec3& p) { return p.tail<2>().norm() > 9.9; }))
      EXPECT_NEAR(rod.mesh.vertices.row(v).tail<2>().norm(), 10, 1e-12);
    for (const Index v : boundary_nodes(rod.mesh, [&](const Vec3& p) { return p.x() == 60; }))
      EXPECT_NEAR(rod.mesh.vertices(v, 0), 60, 1e-12);
  }
  const CurvedMesh ball = curved_mesh(shell_mesh(1, 1, 7, 10), onto({{Sphere{{0, 0, 0}, 10}, {}}}));
  for (const Index v : boundary_nodes(ball.mesh, [](const Vec3& p) { return p.norm() > 9; }))
    EXPECT_NEAR(ball.mesh.vertices.row(v).norm(), 10, 1e-12);
  for (const Index v : boundary_nodes(ball.mesh, [](const Vec3& p) { return p.norm() < 9; }))
    EXPECT_LT(ball.mesh.vertices.row(v).norm(), 6.8);  // the hollow was not given
  EXPECT_EQ(curved_mesh(shell_mesh(1, 1, 7, 10), onto({{Sphere{{0, 0, 0}, 12}, {}}})).done.taken[0], 0u);
}

/// A fine triangle surface in place of the sphere: nodes are as near to the sphere as its facets.
TEST(CurvedEdges, OntoAFile) {
  const Footprint fine = ball_surface(4);
  const TriangleSurface surface{10 * fine.vertices, fine.triangles};
  const CurvedMesh ball = curved_mesh(shell_mesh(1, 1, 7, 10), onto({{surface, {}}}));
  double facet = 10;
  for (const auto& [a, b, c] : fine.triangles)
    facet = std::min(facet, 10 * (fine.vertices.row(a) + fine.vertices.row(b) + fine.vertices.row(c)).norm() / 3);
  for (const Index v : boundary_nodes(ball.mesh, [](const Vec3& p) { return p.norm() > 9; })) {
    EXPECT_GT(ball.mesh.vertices.row(v).norm(), facet - 1e-9);
    EXPECT_LE(ball.mesh.vertices.row(v).norm(), 10 + 1e-12);
  }
}

/// The rim of a slanting cut lies on the cylinder and in the plane.
TEST(CurvedEdges, ASlantingRimStaysInItsPlane) {
  Mesh mesh = rod_mesh(8, 1, 6, 10, 60);
  for (Index v = 0; v < mesh.vertices.rows(); ++v) mesh.vertices(v, 0) += 0.5 * mesh.vertices(v, 1);
  const CurvedMesh rod = curved_mesh(mesh, onto({{Cylinder{{-10, 0, 0}, {70, 0, 0}, 10}, {}}}));
  const auto rim = [](const Vec3& p) { return p.x() - 0.5 * p.y() > 59.99 && p.tail<2>().norm() > 9.9; };
  for (const Index v : boundary_nodes(rod.mesh, rim)) {
    EXPECT_NEAR(rod.mesh.vertices.row(v).tail<2>().norm(), 10, 1e-9);
    EXPECT_NEAR(rod.mesh.vertices(v, 0) - 0.5 * rod.mesh.vertices(v, 1), 60, 1e-9);
  }
}

/// Boxes, a prism of six sides, and one of twelve whose sides are flat for several elements: chamfers are no curves.
TEST(CurvedEdges, WhatHasFlatSidesStaysAsItIs) {
  EXPECT_EQ(curved_mesh(block_mesh({4, 2, 2}, {40, 10, 10}), smooth_curve()).done.moved, 0u);
  EXPECT_EQ(curved_mesh(rod_mesh(6, 1, 4, 10, 40), smooth_curve()).done.moved, 0u);
  Footprint plan = disc(48, 1);
  for (Index v = 1; v <= 48; ++v) {  // onto the chords of twelve corners
    const double angle = 2 * curve_pi * static_cast<double>(v - 1) / 48,
                 from = curve_pi / 6 * std::floor(angle / (curve_pi / 6) + 1e-9);
    plan.vertices.row(v) *= std::cos(curve_pi / 12) / std::cos(angle - from - curve_pi / 12);
  }
  const Mesh prism = layered(plan, 4, [](const Vec3& p, double s) { return Vec3(40 * s, 10 * p.x(), 10 * p.y()); });
  EXPECT_EQ(curved_mesh(prism, smooth_curve()).done.moved, 0u);
  EXPECT_GT(curved_mesh(rod_mesh(6, 1, 4, 10, 40), smooth_curve(65)).done.moved, 0u);
}

/// Interfaces of regions are curved, too: a chamber in a rod, with elements of its own.
TEST(CurvedEdges, RegionsInsideAreRoundToo) {
  Mesh mesh = rod_mesh(12, 2, 8, 10, 60);
  Region chamber;
  chamber.name = "chamber";
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    double middle = 0, radius = 0;
    for (const Index v : mesh.tetrahedra[t]) {
      middle += mesh.vertices(v, 0) / 4;
      radius = std::max(radius, mesh.vertices.row(v).tail<2>().norm());
    }
    if (radius < 5.1 && middle > 7.5 && middle < 52.5) chamber.tetrahedra.push_back(t);
  }
  mesh.regions.push_back(chamber);
  const CurvedMesh rod = curved_mesh(mesh, smooth_curve());
  const double exact = curve_pi * 25 * 45;
  EXPECT_NEAR(measure_curved(rod.mesh).regions[1], exact, 2e-3 * exact);
  EXPECT_LT(measure_curved(rod.straight).regions[1], 0.96 * exact);
  EXPECT_EQ(rod.done.held_back, 0u);
}

TEST(CurvedEdges, TurnAndMoveWithTheMesh) {
  const Mesh mesh = RandomRound(8).draw();
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  Mesh turned = mesh;
  turned.vertices = (mesh.vertices * turn.transpose()).rowwise() + Eigen::RowVector3d(3, -5, 2);
  const Points here = curved_mesh(mesh, smooth_curve()).mesh.vertices,
               there = curved_mesh(turned, smooth_curve()).mesh.vertices;
  const Points moved = (here * turn.transpose()).rowwise() + Eigen::RowVector3d(3, -5, 2);
  EXPECT_LT((moved - there).cwiseAbs().maxCoeff(), 1e-9);
}

namespace {

/// Curves `count` random bodies; brute force checks the invariants of each.
void check_random_bodies(unsigned first, int count) {
  std::size_t moved = 0, held = 0;
  for (int i = 0; i < count; ++i) {
    const unsigned seed = first + static_cast<unsigned>(i);
    const CurvedMesh body = curved_mesh(RandomRound(seed).draw(), smooth_curve(seed % 2 == 0 ? 50 : 65));
    moved += body.done.moved;
    held += body.done.held_back;
    ASSERT_GT(min_on_lattice(body.mesh, 6), 0.1 - 1e-9) << seed;
    ASSERT_LE(largest_bulge(body.mesh), 0.25) << seed;
    const Index corners = RandomRound(seed).draw().vertices.rows();
    ASSERT_EQ(body.mesh.vertices.topRows(corners), body.straight.vertices.topRows(corners)) << seed;
  }
  EXPECT_GT(moved, 50u * static_cast<unsigned>(count));
  EXPECT_GT(held, 0u);  // some are such that it must be
  EXPECT_LT(held, moved / 4);
  ::testing::Test::RecordProperty("moved", static_cast<int>(moved));
  ::testing::Test::RecordProperty("held_back", static_cast<int>(held));
}

}  // namespace

TEST(CurvedEdges, NoElementOfRandomBodiesFolds) {
  check_random_bodies(1, 25);
}

TEST(CurvedEdges, NoElementOfAThousandRandomBodiesFolds) {
  check_random_bodies(1000, 1000);
}

}  // namespace softkin
