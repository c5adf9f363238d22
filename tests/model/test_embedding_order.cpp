#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <softkin/model/compile/embedding.hpp>

#include "model/quadratic_mesh.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

class RandomPoints {
 public:
  Vec3 point(double low, double high) {
    std::uniform_real_distribution<double> in(low, high);
    return {in(engine_), in(engine_), in(engine_)};
  }

 private:
  std::mt19937 engine_{11};
};

double quadratic_function(const Vec3& p) {
  return 1 + 2 * p[0] - p[1] + 3 * p[2] + p[0] * p[0] - 2 * p[1] * p[2] + 0.5 * p[2] * p[2] + p[0] * p[1];
}

/// Value at the embedded point of what a function is at the vertices.
template <class Function>
double carried(const EmbeddedPoint& point, const Points& at, const Function& function) {
  double value = 0;
  for (std::size_t i = 0; i < point.vertices.size(); ++i)
    value += point.weights[i] * function(Vec3(at.row(point.vertices[i]).transpose()));
  return value;
}

Mesh shaken(RandomPoints& random) {
  Mesh mesh = block_mesh({3, 3, 3}, {3, 3, 3});
  for (Index v = 0; v < mesh.vertices.rows(); ++v) mesh.vertices.row(v) += random.point(-0.1, 0.1).transpose();
  return elevated(mesh);
}

TEST(EmbeddingOrder2, CarriesQuadraticFunctionsInsideStraightElements) {
  RandomPoints random;
  const Mesh mesh = shaken(random);
  const Embedder embedder(mesh.vertices, mesh.tetrahedra, {}, mesh.edge_nodes);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = random.point(0.2, 2.8);
    const EmbeddedPoint embedded = embedder.embed(p);
    EXPECT_EQ(embedded.distance_mm, 0);
    EXPECT_LE(embedded.vertices.size(), 10u);
    EXPECT_NEAR(std::accumulate(embedded.weights.begin(), embedded.weights.end(), 0.0), 1, 1e-14);
    EXPECT_NEAR(carried(embedded, mesh.vertices, quadratic_function), quadratic_function(p), 1e-11);
  }
  for (const Index v : {0, 21, 63, 64, 100}) {
    const EmbeddedPoint embedded = embedder.embed(mesh.vertices.row(v).transpose());
    EXPECT_EQ(embedded.vertices, std::vector<Index>{v});
  }
}

TEST(EmbeddingOrder2, IsContinuedLinearlyOutside) {
  RandomPoints random;
  const Mesh mesh = shaken(random);
  const Embedder embedder(mesh.vertices, mesh.tetrahedra, {}, mesh.edge_nodes);
  for (int i = 0; i < 100; ++i) {
    const Vec3 out = random.point(-1, 1).normalized(), p = Vec3(1.5, 1.5, 1.5) + 4 * out;
    const EmbeddedPoint embedded = embedder.embed(p);
    EXPECT_GT(embedded.distance_mm, 1);
    EXPECT_LT((embedded.at(mesh.vertices) - p).norm(), 1e-11);
    // a quadratic continuation of shape functions would grow with the square of the distance
    for (const double weight : embedded.weights) EXPECT_LT(std::abs(weight), 30);
  }
}

TEST(EmbeddingOrder2, FindsThePlaceInCurvedElements) {
  const Mesh straight = quadratic_block({3, 3, 3}, {3, 3, 3}), mesh = bent(straight);
  const Embedder embedder(mesh.vertices, mesh.tetrahedra, {}, mesh.edge_nodes);
  RandomPoints random;
  int exact = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = random.point(0.05, 2.95), q = Bend{}(p);
    const EmbeddedPoint embedded = embedder.embed(q);
    EXPECT_LT((embedded.at(mesh.vertices) - q).norm(), 1e-10);
    EXPECT_NEAR(std::accumulate(embedded.weights.begin(), embedded.weights.end(), 0.0), 1, 1e-14);
    EXPECT_LT(embedded.distance_mm, 0.02);
    // the elements' coordinates are those of the straight mesh; near a face the nearest by corners is a neighbour
    const double error = carried(embedded, straight.vertices, quadratic_function) - quadratic_function(p);
    EXPECT_LT(std::abs(error), 1e-2);
    exact += std::abs(error) < 1e-9;
  }
  EXPECT_GT(exact, 250);
}

}  // namespace
