#include <Eigen/Geometry>
#include <cmath>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/surface_tree.hpp>
#include <softkin/model/mesh/walls.hpp>

namespace softkin {

namespace {

constexpr double nearly_parallel = 0.8;  // cosine between the two sides of a wall

/// Of the corners of an element along a direction of length 1.
double extent(const Points& vertices, const Tetrahedron& element, const Vec3& direction) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Index v : element) {
    const double at = direction.dot(vertex_at(vertices, v));
    low = std::min(low, at);
    high = std::max(high, at);
  }
  return high - low;
}

Vec3 doubled_area(const Points& vertices, const Triangle& t) {
  const Vec3 a = vertex_at(vertices, t[0]);
  return (vertex_at(vertices, t[1]) - a).cross(vertex_at(vertices, t[2]) - a);
}

Vec3 centroid(const Points& vertices, const Triangle& t) {
  return (vertex_at(vertices, t[0]) + vertex_at(vertices, t[1]) + vertex_at(vertices, t[2])) / 3;
}

}  // namespace

std::vector<WallSample> wall_samples(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra,
                                     const std::vector<Prism>& prisms, std::size_t most) {
  const Boundary boundary = boundary_of(tetrahedra, prisms);
  const std::vector<Triangle> triangles = triangulated(boundary);
  const SurfaceTree surface(vertices, triangles);
  const std::size_t count = boundary.triangles.size(), taken = std::min(most, count);
  std::vector<WallSample> samples;
  samples.reserve(taken);
  for (std::size_t i = 0; i < taken; ++i) {
    const std::size_t face = i * count / taken;
    const std::size_t owner = boundary.triangle_owners[face];
    const Vec3 normal = doubled_area(vertices, boundary.triangles[face]);
    const double doubled = normal.norm();
    if (owner >= tetrahedra.size() || !(doubled > 0)) continue;
    const Vec3 inwards = -normal / doubled;
    Index other = -1;
    const auto thickness =
        surface.first_hit(centroid(vertices, boundary.triangles[face]), inwards, 1e-6 * std::sqrt(doubled), &other);
    if (!thickness) continue;
    const Vec3 beyond = doubled_area(vertices, triangles[other]);
    if (!(inwards.dot(beyond) > nearly_parallel * beyond.norm())) continue;
    samples.push_back({static_cast<Index>(owner), doubled / 2, *thickness, extent(vertices, tetrahedra[owner], inwards),
                       std::sqrt(doubled)});
  }
  return samples;
}

double bending_excess(const WallSample& wall, double poisson_ratio) {
  const double across = wall.across_mm / wall.thickness_mm, along = wall.along_mm / wall.thickness_mm;
  const double bulk_over_shear = 2 * (1 + poisson_ratio) / (3 * (1 - 2 * poisson_ratio));
  return (1 + bulk_over_shear / 20) * (1.75 * across * across + 0.8 * along * along);
}

}  // namespace softkin
