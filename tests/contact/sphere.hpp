#pragma once

#include <map>
#include <softkin/contact/surface.hpp>

namespace softkin::contact::testing {

struct Sphere {
  Points points;
  std::vector<Corners> triangles;
};

/// Returns an octahedron whose triangles are split into four repeatedly: 8 * 4^splits triangles.
inline Sphere make_sphere(int splits, double radius) {
  std::vector<Vec3> points{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  std::vector<Corners> triangles{{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                                 {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (int split = 0; split < splits; ++split) {
    std::map<Ends, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [at, added] = middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<Index>(points.size()));
      if (added) points.push_back((points[a] + points[b]).normalized());
      return at->second;
    };
    std::vector<SixNodes> faces;
    for (const auto& [a, b, c] : triangles) {
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      faces.push_back({a, b, c, ab, bc, ca});
    }
    triangles = split_faces(faces);
  }
  Sphere sphere{Points(points.size(), 3), triangles};
  for (std::size_t i = 0; i < points.size(); ++i) sphere.points.row(i) = radius * points[i];
  return sphere;
}

}  // namespace softkin::contact::testing
