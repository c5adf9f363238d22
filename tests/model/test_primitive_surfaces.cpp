#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <numbers>
#include <softkin/model/mesh/primitive_surfaces.hpp>
#include <softkin/model/mesh/shells.hpp>

namespace softkin {
namespace {

constexpr double pi = std::numbers::pi;

double area_of(const TriangleSurface& surface) {
  double area = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3 p = vertex_at(surface.vertices, a);
    area += (vertex_at(surface.vertices, b) - p).cross(vertex_at(surface.vertices, c) - p).norm() / 2;
  }
  return area;
}

/// One closed piece; its volume.
double closed_volume(const TriangleSurface& surface) {
  const std::vector<Shell> shells = shells_of(surface.vertices, surface.triangles);
  EXPECT_EQ(shells.size(), 1u);
  EXPECT_TRUE(shells[0].closed);
  return shells[0].volume;
}

/// Of a convex surface around a point: every normal leads away from it.
void expect_outward_from(const Vec3& inside, const TriangleSurface& surface) {
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3 p = vertex_at(surface.vertices, a);
    const Vec3 normal = (vertex_at(surface.vertices, b) - p).cross(vertex_at(surface.vertices, c) - p);
    ASSERT_GT(normal.dot(p - inside), 0);
  }
}

double distance_to_line(const Vec3& point, const Vec3& start, const Vec3& end) {
  const double along = (point - start).dot(end - start) / (end - start).squaredNorm();
  return (point - start - std::clamp(along, 0.0, 1.0) * (end - start)).norm();
}

TEST(PrimitiveSurfaces, ABox) {
  const FacetedSurface made = faceted(Box{{1, 2, 3}, {4, 7, 5}});
  EXPECT_EQ(made.surface.triangles.size(), 12u);
  EXPECT_EQ(made.sagitta_mm, 0);
  EXPECT_DOUBLE_EQ(closed_volume(made.surface), 30);
  EXPECT_DOUBLE_EQ(area_of(made.surface), 62);
  expect_outward_from({2, 3, 4}, made.surface);
}

TEST(PrimitiveSurfaces, AHalfspaceHoldsTheCircle) {
  const Vec3 normal(1, -2, 2), beside(5, 6, 7);
  const Halfspace plane{{0, 0, -1}, normal};
  const auto& [surface, sagitta] = faceted(plane, beside, 100);
  ASSERT_EQ(surface.triangles.size(), 1u);
  const Vec3 a = vertex_at(surface.vertices, 0), b = vertex_at(surface.vertices, 1), c = vertex_at(surface.vertices, 2);
  for (const Vec3& p : {a, b, c}) EXPECT_NEAR((p - plane.point).dot(normal), 0, 1e-12 * 600);
  EXPECT_NEAR((b - a).norm(), 200 * std::sqrt(3), 1e-9);
  EXPECT_NEAR((c - b).norm(), 200 * std::sqrt(3), 1e-9);
  EXPECT_NEAR((b - a).cross(c - a).normalized().dot(normal.normalized()), 1, 1e-12);
  const Vec3 middle = (a + b + c) / 3;
  EXPECT_NEAR((middle - beside).cross(normal).norm(), 0, 1e-9);  // below it
  EXPECT_EQ(sagitta, 0);
}

TEST(PrimitiveSurfaces, ASphereLiesBetweenTwo) {
  const Sphere sphere{{1, -2, 30}, 20};
  const auto& [surface, sagitta] = faceted(sphere, 0.05);
  EXPECT_LE(sagitta, 0.05);
  EXPECT_GT(sagitta, 0.04);  // no finer than requested
  const double inner = 20 - sagitta;
  EXPECT_GT(closed_volume(surface), 4 / 3.0 * pi * inner * inner * inner);
  EXPECT_LT(closed_volume(surface), 4 / 3.0 * pi * 8000);
  EXPECT_GT(area_of(surface), 4 * pi * inner * inner);
  EXPECT_LT(area_of(surface), 4 * pi * 400);
  for (Index v = 0; v < surface.vertices.rows(); ++v)
    ASSERT_NEAR((vertex_at(surface.vertices, v) - sphere.center).norm(), 20, 1e-12 * 40);
  double least = 20;
  for (const auto& [a, b, c] : surface.triangles)
    for (const auto& [p, q, r] : {std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}) {
      const Vec3 edge = 0.5 * (vertex_at(surface.vertices, p) + vertex_at(surface.vertices, q));
      const Vec3 middle = edge / 1.5 + vertex_at(surface.vertices, r) / 3;
      least = std::min({least, (edge - sphere.center).norm(), (middle - sphere.center).norm()});
    }
  EXPECT_GE(least, inner - 1e-12);
  EXPECT_LT(least, 20 - 0.9 * sagitta);
  expect_outward_from(sphere.center, surface);
}

TEST(PrimitiveSurfaces, AFineSphereStopsAtTheMost) {
  const auto& [surface, sagitta] = faceted(Sphere{{0, 0, 0}, 1}, 1e-9);
  EXPECT_LE(surface.triangles.size(), max_facets);
  EXPECT_GT(surface.triangles.size(), max_facets * 9 / 10);
  EXPECT_GT(sagitta, 1e-9);
  EXPECT_LT(sagitta, 1e-3);
}

TEST(PrimitiveSurfaces, ACylinderIsAPrism) {
  const Cylinder cylinder{{0, 0, 1}, {3, 4, 1}, 2};
  const auto& [surface, sagitta] = faceted(cylinder, 0.01);
  const double sides = static_cast<double>(surface.triangles.size()) / 4;
  EXPECT_LE(sagitta, 0.01);
  EXPECT_GT(2 * (1 - std::cos(pi / (sides - 4))), 0.01);  // with one side less in each quarter it would be more
  EXPECT_NEAR(closed_volume(surface), 5 * sides / 2 * 4 * std::sin(2 * pi / sides), 1e-10);
  EXPECT_NEAR(area_of(surface), 5 * sides * 4 * std::sin(pi / sides) + sides * 4 * std::sin(2 * pi / sides), 1e-10);
  expect_outward_from({1.5, 2, 1}, surface);
}

TEST(PrimitiveSurfaces, ACapsuleLiesBetweenTwo) {
  const Capsule capsule{{0, 0, 0}, {0, -10, 0}, 3};
  const auto& [surface, sagitta] = faceted(capsule, 0.02);
  EXPECT_LE(sagitta, 0.02);
  const auto volume = [](double r) { return 4 / 3.0 * pi * r * r * r + 10 * pi * r * r; };
  EXPECT_GT(closed_volume(surface), volume(3 - sagitta));
  EXPECT_LT(closed_volume(surface), volume(3));
  EXPECT_LT(area_of(surface), 4 * pi * 9 + 10 * 2 * pi * 3);
  for (Index v = 0; v < surface.vertices.rows(); ++v)
    ASSERT_NEAR(distance_to_line(vertex_at(surface.vertices, v), capsule.start, capsule.end), 3, 1e-12);
  expect_outward_from({0, -5, 0}, surface);
}

}  // namespace
}  // namespace softkin
