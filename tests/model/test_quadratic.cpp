#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <random>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/model.hpp>

#include "model/quadratic_mesh.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

double factorial(int n) {
  return n < 2 ? 1 : n * factorial(n - 1);
}

TetrahedronNodes unit_tetrahedron() {
  TetrahedronNodes nodes;
  nodes.topRows<4>() << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  for (int e = 0; e < 6; ++e)
    nodes.row(e + 4) = 0.5 * (nodes.row(tetrahedron_edges[e][0]) + nodes.row(tetrahedron_edges[e][1]));
  return nodes;
}

TEST(QuadraticTetrahedron, ShapeFunctionsAreOneAtTheirNode) {
  for (int node = 0; node < 10; ++node) {
    Barycentric l = Barycentric::Zero();
    if (node < 4) {
      l[node] = 1;
    } else {
      l[tetrahedron_edges[node - 4][0]] = 0.5;
      l[tetrahedron_edges[node - 4][1]] = 0.5;
    }
    EXPECT_EQ(quadratic_shape(l), (TetrahedronWeights(TetrahedronWeights::Unit(node))));
  }
  const Barycentric l(0.1, 0.2, 0.3, 0.4);
  EXPECT_NEAR(quadratic_shape(l).sum(), 1, 1e-15);
  for (int i = 0; i < 4; ++i) {
    const Barycentric step = 1e-5 * Barycentric::Unit(i);
    const TetrahedronWeights difference = (quadratic_shape(l + step) - quadratic_shape(l - step)) / 2e-5;
    EXPECT_LT((quadratic_slope(l).col(i) - difference).norm(), 1e-9);
  }
}

TEST(QuadraticTetrahedron, IntegralsOfStraightAndCurvedElements) {
  TetrahedronNodes nodes = unit_tetrahedron();
  TetrahedronWeights integrals = shape_integrals(nodes);
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(integrals[i], i < 4 ? -1 / 120.0 : 1 / 30.0, 1e-16);
  EXPECT_NEAR(min_jacobian(nodes), 1, 1e-14);
  nodes.col(0).swap(nodes.col(1));
  EXPECT_NEAR(shape_integrals(nodes).sum(), -1 / 6.0, 1e-16);
  nodes.col(0).swap(nodes.col(1));

  // x -> x + s x^2 maps the element onto a curved one: integrals of polynomials in x by 1/(p+3)! p! of x^p
  const double s = 0.3;
  for (int i = 0; i < 10; ++i) nodes(i, 0) += s * nodes(i, 0) * nodes(i, 0);
  integrals = shape_integrals(nodes);
  const auto power = [](int p) { return factorial(p) / factorial(p + 3); };
  EXPECT_NEAR(integrals.sum(), power(0) + 2 * s * power(1), 1e-15);
  // integral of the image's x: (x + s x^2)(1 + 2 s x)
  EXPECT_NEAR(integrals.dot(nodes.col(0)), power(1) + 3 * s * power(2) + 2 * s * s * power(3), 1e-15);
  EXPECT_NEAR(min_jacobian(nodes), 1, 1e-14);
}

TEST(QuadraticTetrahedron, TheRuleIsExactToDegreeFive) {
  // L_0^2 (as a sum of shape functions) times the Jacobian of a map of degree 2 in each coordinate
  const double s = 0.2, t = -0.15, u = 0.1;
  TetrahedronNodes nodes = unit_tetrahedron();
  for (int i = 0; i < 10; ++i)
    for (int axis = 0; axis < 3; ++axis) nodes(i, axis) += Vec3(s, t, u)[axis] * nodes(i, axis) * nodes(i, axis);
  // (1 + 2 s x)(1 + 2 t y)(1 + 2 u z) x^2, where x^2 = N_1 + (N_01 + N_12 + N_13) / 4
  const TetrahedronWeights integrals = shape_integrals(nodes);
  const double square = integrals[1] + (integrals[4] + integrals[5] + integrals[8]) / 4;
  const auto monomial = [](int a, int b, int c) {
    return factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3);
  };
  double expected = 0;
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b)
      for (int c = 0; c < 2; ++c)
        expected += std::pow(2 * s, a) * std::pow(2 * t, b) * std::pow(2 * u, c) * monomial(a + 2, b, c);
  EXPECT_NEAR(square, expected, 1e-16);
}

TEST(QuadraticTriangle, TheRuleIsExactToDegreeFour) {
  for (int a = 0; a <= 4; ++a)
    for (int b = 0; a + b <= 4; ++b) {
      double sum = 0;
      TriangleNodes place;  // a straight triangle, whose positions are the coordinates u, v
      place << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.5, 0, 0, 0.5, 0.5, 0, 0, 0.5, 0;
      for (const TrianglePoint& point : triangle_rule()) {
        const Vec3 at = place.transpose() * point.shape;
        sum += point.weight * std::pow(at[0], a) * std::pow(at[1], b);
        EXPECT_LT((place.transpose() * point.along_u - Vec3(1, 0, 0)).norm(), 1e-14);
        EXPECT_LT((place.transpose() * point.along_v - Vec3(0, 1, 0)).norm(), 1e-14);
      }
      EXPECT_NEAR(sum, factorial(a) * factorial(b) / factorial(a + b + 2), 1e-15) << a << " " << b;
    }
}

/// Boundary of a mesh of order 2.
std::vector<CavityFace> faces_of(const Mesh& mesh) {
  const EdgeTable edges(mesh);
  std::vector<CavityFace> faces;
  for (const Triangle& t : boundary_of(mesh.tetrahedra, {}).triangles) faces.push_back({t, edges.of(t)});
  return faces;
}

/// Volume of the faces cut into n^2 flat triangles each.
double volume_of_facets(const Points& positions, const std::vector<CavityFace>& faces, int n) {
  double six = 0;
  for (const CavityFace& face : faces) {
    const auto at = [&](int i, int j) -> Vec3 {
      const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n, t = 1 - u - v;
      const double shape[6] = {t * (2 * t - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * t * u, 4 * u * v, 4 * v * t};
      Vec3 p = Vec3::Zero();
      for (int k = 0; k < 6; ++k)
        p += shape[k] * positions.row(k < 3 ? face.corners[k] : face.edges[k - 3]).transpose();
      return p;
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        six += at(i, j).dot(at(i + 1, j).cross(at(i, j + 1)));
        if (i + j + 1 < n) six += at(i + 1, j).dot(at(i + 1, j + 1).cross(at(i, j + 1)));
      }
  }
  return six / 6;
}

TEST(EnclosedVolume, OfLinearAndStraightFaces) {
  const Mesh mesh = quadratic_block({2, 2, 1}, {2, 3, 4});
  std::vector<CavityFace> faces = faces_of(mesh);
  EXPECT_NEAR(enclosed_volume(mesh.vertices, faces), 24, 1e-13);
  for (CavityFace& face : faces) face.edges = {-1, -1, -1};
  EXPECT_NEAR(enclosed_volume(mesh.vertices, faces), 24, 1e-13);
  EXPECT_EQ(enclosed_volume(mesh.vertices, std::vector<CavityFace>{}), 0);
}

TEST(EnclosedVolume, OfCurvedFacesIsExact) {
  const Vec3 size(3, 2, 2);
  const Mesh mesh = bent(quadratic_block({3, 2, 2}, size));
  EXPECT_NEAR(enclosed_volume(mesh.vertices, faces_of(mesh)), Bend{}.moments(Vec3::Zero(), size).first, 1e-13);
}

TEST(EnclosedVolume, AgreesWithASubdividedSurface) {
  Mesh mesh = quadratic_block({1, 2, 1}, {1, 2, 1});
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> shake(-0.1, 0.1);
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis) mesh.vertices(v, axis) += shake(engine);
  const std::vector<CavityFace> faces = faces_of(mesh);
  const double exact = enclosed_volume(mesh.vertices, faces);
  const double coarse = volume_of_facets(mesh.vertices, faces, 32), fine = volume_of_facets(mesh.vertices, faces, 64);
  EXPECT_GT(std::abs(fine - exact), 1e-7) << "the faces are curved";
  EXPECT_NEAR((4 * fine - coarse) / 3, exact, 1e-8);

  // invariance, and against the elements of the curved body
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  Points moved = (mesh.vertices * turn.toRotationMatrix().transpose()).rowwise() + Eigen::RowVector3d(100, -50, 20);
  EXPECT_NEAR(enclosed_volume(moved, faces), exact, 1e-11);
  double elements = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    elements += shape_integrals(nodes_of(mesh.vertices, mesh.tetrahedra[t], mesh.edge_nodes[t])).sum();
  EXPECT_NEAR(elements, exact, 1e-13);
}

}  // namespace
