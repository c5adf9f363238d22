#include <Eigen/Geometry>
#include <algorithm>
#include <softkin/contact/surface.hpp>
#include <softkin/core/error.hpp>
#include <string>

namespace softkin::contact {

namespace {

Ends ends_of(const Corners& triangle, std::size_t k) {
  const Index a = triangle[k], b = triangle[(k + 1) % 3];
  return {std::min(a, b), std::max(a, b)};
}

template <class Value>
void sort_unique(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

template <class Value>
Index place_of(const Value& value, const std::vector<Value>& sorted) {
  return std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin();
}

/// For each of `count` things the triangles that name it.
Lists triangles_of(const std::vector<std::array<Index, 3>>& named, std::size_t count) {
  Lists lists;
  lists.begin.assign(count + 1, 0);
  for (const auto& three : named)
    for (const Index i : three) ++lists.begin[i + 1];
  for (std::size_t i = 0; i < count; ++i) lists.begin[i + 1] += lists.begin[i];
  lists.items.resize(3 * named.size());
  std::vector<Index> next(lists.begin);
  for (std::size_t t = 0; t < named.size(); ++t)
    for (const Index i : named[t]) lists.items[next[i]++] = t;
  return lists;
}

std::vector<double> thirds(const Lists& triangles, const std::vector<double>& area) {
  std::vector<double> sums(triangles.begin.size() - 1, 0);
  for (std::size_t i = 0; i < sums.size(); ++i)
    for (Index k = triangles.begin[i]; k < triangles.begin[i + 1]; ++k) sums[i] += area[triangles.items[k]] / 3;
  return sums;
}

void check(const std::vector<Corners>& triangles, Index vertices) {
  for (const Corners& t : triangles) {
    for (const Index v : t)
      if (v < 0 || v >= vertices)
        throw InvalidInput("a triangle of a contact surface names vertex " + std::to_string(v) + " of " +
                           std::to_string(vertices));
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      throw InvalidInput("a triangle of a contact surface names a vertex twice: " + std::to_string(t[0]) + ", " +
                         std::to_string(t[1]) + ", " + std::to_string(t[2]));
  }
}

}  // namespace

Surface make_surface(std::vector<Corners> triangles, const Points& rest) {
  check(triangles, rest.rows());
  Surface surface;
  surface.triangles = std::move(triangles);
  for (const Corners& t : surface.triangles) {
    surface.vertices.insert(surface.vertices.end(), t.begin(), t.end());
    for (std::size_t k = 0; k < 3; ++k) surface.edges.push_back(ends_of(t, k));
  }
  sort_unique(surface.vertices);
  sort_unique(surface.edges);
  std::vector<std::array<Index, 3>> corners;
  for (const Corners& t : surface.triangles) {
    std::array<Index, 3> edges, places;
    for (std::size_t k = 0; k < 3; ++k) {
      edges[k] = place_of(ends_of(t, k), surface.edges);
      places[k] = place_of(t[k], surface.vertices);
    }
    surface.triangle_edges.push_back(edges);
    corners.push_back(places);
    const Vec3 a = rest.row(t[0]), b = rest.row(t[1]), c = rest.row(t[2]);
    surface.triangle_area.push_back((b - a).cross(c - a).norm() / 2);
  }
  surface.edge_triangles = triangles_of(surface.triangle_edges, surface.edges.size());
  surface.vertex_triangles = triangles_of(corners, surface.vertices.size());
  surface.edge_area = thirds(surface.edge_triangles, surface.triangle_area);
  surface.vertex_area = thirds(surface.vertex_triangles, surface.triangle_area);
  return surface;
}

std::vector<Corners> split_faces(const std::vector<SixNodes>& faces) {
  std::vector<Corners> triangles;
  triangles.reserve(4 * faces.size());
  for (const auto& [a, b, c, ab, bc, ca] : faces)
    triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  return triangles;
}

}  // namespace softkin::contact
