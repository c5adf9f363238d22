#include <gtest/gtest.h>
#include <Eigen/Core>

#include <cmath>
#include <limits>
#include <random>
#include <softkin/core/dense.hpp>
#include <softkin/model/compile/embedding.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

#include "model/block_mesh.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

class Random {
 public:
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3 point(double low, double high) { return {in(low, high), in(low, high), in(low, high)}; }

 private:
  std::mt19937 engine_{7};
};

// Distance from a convex hull: the least over all subsets of its corners whose affine projection is convex.
double brute_distance(const std::vector<Vec3>& corners, const Vec3& point) {
  double best = std::numeric_limits<double>::infinity();
  for (unsigned subset = 1; subset < (1u << corners.size()); ++subset) {
    std::vector<Vec3> chosen;
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (subset >> i & 1u) chosen.push_back(corners[i]);
    Eigen::MatrixXd edges(3, std::ssize(chosen) - 1);
    for (Eigen::Index i = 0; i < edges.cols(); ++i) edges.col(i) = chosen[i + 1] - chosen[0];
    const Eigen::VectorXd w = edges.cols() ? least_squares(edges, point - chosen[0]).solution : Eigen::VectorXd(0);
    if (w.size() && (w.minCoeff() < -1e-12 || w.sum() > 1 + 1e-12)) continue;
    const Vec3 nearest = w.size() ? Vec3(chosen[0] + edges * w) : chosen[0];
    best = std::min(best, (nearest - point).norm());
  }
  return best;
}

double brute_distance(const Mesh& mesh, const Vec3& point) {
  double best = std::numeric_limits<double>::infinity();
  for (const Tetrahedron& t : mesh.tetrahedra) {
    std::vector<Vec3> corners;
    for (const Index v : t) corners.push_back(mesh.vertices.row(v).transpose());
    best = std::min(best, brute_distance(corners, point));
  }
  return best;
}

Mesh shaken_block_with_a_hole(Random& random) {
  Mesh mesh = block_mesh({3, 3, 3}, {3, 3, 3}, Split::five);
  for (Index v = 0; v < mesh.vertices.rows(); ++v) mesh.vertices.row(v) += random.point(-0.15, 0.15).transpose();
  mesh.tetrahedra.erase(mesh.tetrahedra.begin() + 65, mesh.tetrahedra.begin() + 70);  // the middle cell
  return mesh;
}

void expect_reproduces(const EmbeddedPoint& embedded, const Points& rest, const Vec3& point, double tolerance) {
  double sum = 0;
  for (const double w : embedded.weights) sum += w;
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_LT((embedded.at(rest) - point).norm(), tolerance);
}

TEST(Embedding, AgreesWithBruteForceOnAShakenMesh) {
  Random random;
  const Mesh mesh = shaken_block_with_a_hole(random);
  const Embedder embedder(mesh.vertices, mesh.tetrahedra, {});
  int inside = 0, outside = 0;
  for (int i = 0; i < 150; ++i) {
    const Vec3 point = random.point(-1, 4);
    const EmbeddedPoint embedded = embedder.embed(point);
    const double expected = brute_distance(mesh, point);
    EXPECT_NEAR(embedded.distance_mm, expected, 1e-9);
    expect_reproduces(embedded, mesh.vertices, point, 1e-12);
    (expected < 1e-9 ? inside : outside)++;
    if (expected > 1e-9) continue;
    for (const double w : embedded.weights) EXPECT_GE(w, -1e-9);
  }
  EXPECT_GT(inside, 20);
  EXPECT_GT(outside, 20);
}

TEST(Embedding, DistanceFromABlockOfAnyElements) {
  Random random;
  for (const Split split : {Split::five, Split::six, Split::prisms}) {
    const Vec3 size(4, 2, 1);
    const Mesh mesh = block_mesh({4, 3, 2}, size, split);
    const Embedder embedder(mesh.vertices, mesh.tetrahedra, mesh.prisms);
    for (int i = 0; i < 500; ++i) {
      const Vec3 point = random.point(-1, 5);
      const Vec3 nearest = point.cwiseMax(Vec3::Zero()).cwiseMin(size);
      const EmbeddedPoint embedded = embedder.embed(point);
      EXPECT_NEAR(embedded.distance_mm, (point - nearest).norm(), 1e-12);
      expect_reproduces(embedded, mesh.vertices, point, 1e-11);
    }
  }
}

TEST(Embedding, TwistedPrismsAgreeAcrossTheirSides) {
  Mesh mesh = block_mesh({4, 4, 2}, {4, 4, 2}, Split::prisms);
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    const double angle = 0.3 * mesh.vertices(v, 2), x = mesh.vertices(v, 0) - 2, y = mesh.vertices(v, 1) - 2;
    mesh.vertices(v, 0) = std::cos(angle) * x - std::sin(angle) * y;
    mesh.vertices(v, 1) = std::sin(angle) * x + std::cos(angle) * y;
  }
  const Embedder embedder(mesh.vertices, {}, mesh.prisms);
  Random random;
  // a gap between neighbours that split a common side differently would leave points outside
  for (int i = 0; i < 1500; ++i) {
    const Vec3 point(random.in(-1.2, 1.2), random.in(-1.2, 1.2), random.in(0, 2));
    EXPECT_EQ(embedder.embed(point).distance_mm, 0) << point.transpose();
  }
}

TEST(Embedding, AVertexIsItsOwnWeight) {
  Random random;
  const Mesh mesh = shaken_block_with_a_hole(random);
  const Embedder embedder(mesh.vertices, mesh.tetrahedra, {});
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (const Index v : t) {
      const EmbeddedPoint embedded = embedder.embed(mesh.vertices.row(v).transpose());
      ASSERT_EQ(embedded.vertices, std::vector<Index>{v});
      EXPECT_EQ(embedded.weights, std::vector<double>{1});
      EXPECT_LT(embedded.distance_mm, 1e-12);
    }
}

TEST(Embedding, FollowsAnAffineMotionEvenOutside) {
  Random random;
  const Mesh mesh = shaken_block_with_a_hole(random);
  const Embedder embedder(mesh.vertices, mesh.tetrahedra, {});
  Mat3 map;
  map << 1.2, 0.1, 0, -0.3, 0.9, 0.2, 0, 0.5, 1.1;
  const Points moved = mesh.vertices * map.transpose();
  for (int i = 0; i < 50; ++i) {
    const Vec3 point = random.point(-0.5, 3.5);
    EXPECT_LT((embedder.embed(point).at(moved) - map * point).norm(), 1e-11);
  }
}

TEST(Embedding, RefusesNothingToEmbedInAndNan) {
  const Embedder none(Points(0, 3), {}, {});
  EXPECT_TRUE(none.empty());
  EXPECT_THROW((void)none.embed(Vec3::Zero()), InvalidInput);
  const Mesh mesh = block_mesh({1, 1, 1}, {1, 1, 1});
  EXPECT_THROW((void)Embedder(mesh.vertices, mesh.tetrahedra, {}).embed(Vec3(0, std::nan(""), 0)), InvalidInput);
}

// The boundary of a shaken block is a closed, irregular surface; inside it is where a tetrahedron is.
TEST(SurfaceTree, ContainsWhatTheTetrahedraContain) {
  Random random;
  const Mesh mesh = shaken_block_with_a_hole(random);
  const SurfaceTree surface(mesh.vertices, triangulated(boundary_of(mesh.tetrahedra, {})));
  int inside = 0;
  for (int i = 0; i < 150; ++i) {
    const Vec3 point = random.point(-0.5, 3.5);
    const double distance = brute_distance(mesh, point);
    EXPECT_EQ(surface.contains(point), distance < 1e-9);
    inside += distance < 1e-9;
  }
  EXPECT_GT(inside, 40);
}

// Every test direction hits edges and corners of this surface, so the winding number must decide.
TEST(SurfaceTree, DoubtfulRaysAreNotCounted) {
  const std::vector<Vec3> rays{{0.8371, 0.4127, 0.3589}, {-0.2953, 0.9013, 0.3163}, {0.1789, -0.3371, 0.9241}};
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(3, -2, 7)}) {
    Points corners(6, 3);
    for (int i = 0; i < 3; ++i) {
      corners.row(i) = (center + 2 * rays[i]).transpose();
      corners.row(i + 3) = (center - 2 * rays[i]).transpose();
    }
    std::vector<Triangle> octahedron{{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                                     {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
    const SurfaceTree tree(corners, octahedron);
    EXPECT_TRUE(tree.contains(center));
    EXPECT_TRUE(tree.contains(center + rays[0]));
    EXPECT_FALSE(tree.contains(center + 1.01 * (rays[0] + rays[1])));
    EXPECT_FALSE(tree.contains(center - 2.01 * rays[0]));
  }
}

TEST(SurfaceTree, FirstHitAlongARay) {
  const Mesh mesh = block_mesh({2, 2, 2}, {4, 4, 4});
  const SurfaceTree surface(mesh.vertices, triangulated(boundary_of(mesh.tetrahedra, {})));
  EXPECT_DOUBLE_EQ(*surface.first_hit({1, 2, 2}, {2, 0, 0}, 0), 1.5);   // onto a vertex of the face
  EXPECT_DOUBLE_EQ(*surface.first_hit({-1, 1, 3}, {1, 0, 0}, 0), 1.0);  // onto an edge
  EXPECT_DOUBLE_EQ(*surface.first_hit({0, 1.3, 3.1}, {1, 0, 0}, 1e-9), 4.0);
  EXPECT_FALSE(surface.first_hit({5, 2, 2}, {1, 0, 0}, 0));
  EXPECT_FALSE(surface.first_hit({5, 5, 2}, {0, 0, 1}, 0));
}

}  // namespace
