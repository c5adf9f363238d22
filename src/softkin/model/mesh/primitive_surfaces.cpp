#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/model/mesh/primitive_surfaces.hpp>

namespace softkin {

namespace {

constexpr double pi = std::numbers::pi;

/// Vertices around the axis: `count` of them, 0 for the pole.
struct Ring {
  Index first = 0, count = 0;

  [[nodiscard]] Index at(Index i) const { return count == 0 ? first : first + i % count; }
};

/// Builds a surface of revolution, ring by ring along its axis.
class Turner {
 public:
  explicit Turner(const Vec3& axis) : along_(axis.normalized()), u_(along_.unitOrthogonal()), v_(along_.cross(u_)) {}

  /// A ring of 4 k vertices; k = 0: a point.
  Ring ring(const Vec3& center, double radius, Index k) {
    const Ring ring{static_cast<Index>(vertices_.size()), 4 * k};
    if (k == 0) vertices_.push_back(center);
    for (Index i = 0; i < ring.count; ++i) {
      const double angle = 2 * pi * i / ring.count;
      vertices_.emplace_back(center + radius * (std::cos(angle) * u_ + std::sin(angle) * v_));
    }
    return ring;
  }

  /// Triangles between two rings, the second farther along the axis, whose k differ by 1 at most.
  void join(const Ring& low, const Ring& high) {
    const Index below = low.count / 4, above = high.count / 4;
    for (Index quarter = 0; quarter < 4; ++quarter) {
      const auto l = [&](Index i) { return low.at(quarter * below + i); };
      const auto h = [&](Index i) { return high.at(quarter * above + i); };
      // a triangle on each edge of either ring; the tips of those on the ring with more vertices lie at their start
      for (Index i = 0; i < below; ++i) triangles_.push_back({l(i), l(i + 1), h(above > below ? i + 1 : i)});
      for (Index i = 0; i < above; ++i) triangles_.push_back({l(above > below ? i : i + 1), h(i + 1), h(i)});
    }
  }

  /// A fan over a ring; up: with its normal along the axis.
  void close(const Vec3& center, const Ring& ring, bool up) {
    const Index middle = vertices_.size();
    vertices_.push_back(center);
    for (Index i = 0; i < ring.count; ++i) {
      const Index from = ring.at(i), to = ring.at(i + 1);
      triangles_.push_back(up ? Triangle{middle, from, to} : Triangle{middle, to, from});
    }
  }

  [[nodiscard]] const Vec3& along() const { return along_; }
  [[nodiscard]] TriangleSurface surface() const {
    TriangleSurface surface{Points(vertices_.size(), 3), triangles_};
    for (std::size_t i = 0; i < vertices_.size(); ++i) surface.vertices.row(i) = vertices_[i].transpose();
    return surface;
  }

 private:
  Vec3 along_, u_, v_;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
};

/// Of a facet with its corners on a sphere: no point of it is farther from the sphere.
double sagitta_of(const TriangleSurface& surface, const Triangle& t, const Vec3& center, double radius) {
  const Vec3 a = vertex_at(surface.vertices, t[0]), b = vertex_at(surface.vertices, t[1]),
             c = vertex_at(surface.vertices, t[2]);
  return radius - std::abs((b - a).cross(c - a).normalized().dot(a - center));
}

/// Of a prism inscribed into a cylinder.
double sagitta_of(double radius, Index sides) {
  return radius * (1 - std::cos(pi / sides));
}

/// A sphere of radius r around start, cut at its equator and drawn apart to end; start == end: a sphere.
FacetedSurface rounded(const Vec3& start, const Vec3& end, const Vec3& axis, double radius, Index n) {
  Turner turner(axis);
  const auto at = [&](const Vec3& center, Index step) {
    const double latitude = 0.5 * pi * step / n;
    return turner.ring(center + radius * std::sin(latitude) * turner.along(), radius * std::cos(latitude),
                       n - std::abs(step));
  };
  Ring last = at(start, -n);
  const auto go_on = [&](const Ring& next) {
    turner.join(last, next);
    last = next;
  };
  for (Index step = 1 - n; step <= 0; ++step) go_on(at(start, step));
  if (start != end) go_on(at(end, 0));
  for (Index step = 1; step <= n; ++step) go_on(at(end, step));
  FacetedSurface faceted{turner.surface(), 0};
  const std::ptrdiff_t half = 4 * n * n;
  const auto& triangles = faceted.surface.triangles;
  for (auto t = triangles.begin(); t != triangles.begin() + half; ++t)
    faceted.sagitta_mm = std::max(faceted.sagitta_mm, sagitta_of(faceted.surface, *t, start, radius));
  if (start != end) faceted.sagitta_mm = std::max(faceted.sagitta_mm, sagitta_of(radius, 4 * n));
  return faceted;
}

/// The coarsest that is fine enough, or the finest of those with at most max_facets.
FacetedSurface rounded(const Vec3& start, const Vec3& end, const Vec3& axis, double radius, double sagitta_mm) {
  const auto facets = [&](Index n) { return static_cast<std::size_t>(8 * n * n + (start != end ? 8 * n : 0)); };
  for (Index n = 2;; ++n) {
    FacetedSurface made = rounded(start, end, axis, radius, n);
    if (made.sagitta_mm <= sagitta_mm || facets(n + 1) > max_facets) return made;
  }
}

}  // namespace

FacetedSurface faceted(const Box& box) {
  FacetedSurface made{{Points(8, 3), {}}, 0};
  for (Index corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis)
      made.surface.vertices(corner, axis) = (corner >> axis & 1) != 0 ? box.high[axis] : box.low[axis];
  for (int axis = 0; axis < 3; ++axis) {
    const Index a = 1 << axis, b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3;
    const auto add = [&](Index p, Index q, Index r, Index s) {
      made.surface.triangles.insert(made.surface.triangles.end(), {{p, q, r}, {p, r, s}});
    };
    add(0, c, b | c, b);
    add(a, a | b, a | b | c, a | c);
  }
  return made;
}

FacetedSurface faceted(const Halfspace& halfspace, const Vec3& beside, double reach_mm) {
  const Vec3 normal = halfspace.normal.normalized(), u = normal.unitOrthogonal(), v = normal.cross(u);
  const Vec3 center = beside - normal.dot(beside - halfspace.point) * normal;
  FacetedSurface made{{Points(3, 3), {{0, 1, 2}}}, 0};
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * pi * i / 3;
    made.surface.vertices.row(i) = (center + 2 * reach_mm * (std::cos(angle) * u + std::sin(angle) * v)).transpose();
  }
  return made;
}

FacetedSurface faceted(const Sphere& sphere, double sagitta_mm) {
  return rounded(sphere.center, sphere.center, Vec3::UnitZ(), sphere.radius, sagitta_mm);
}

FacetedSurface faceted(const Cylinder& cylinder, double sagitta_mm) {
  Index k = 2;
  const auto most = static_cast<Index>(max_facets / 16);
  while (k < most && sagitta_of(cylinder.radius, 4 * k) > sagitta_mm) ++k;
  Turner turner(cylinder.end - cylinder.start);
  const Ring low = turner.ring(cylinder.start, cylinder.radius, k),
             high = turner.ring(cylinder.end, cylinder.radius, k);
  turner.join(low, high);
  turner.close(cylinder.start, low, false);
  turner.close(cylinder.end, high, true);
  return {turner.surface(), sagitta_of(cylinder.radius, 4 * k)};
}

FacetedSurface faceted(const Capsule& capsule, double sagitta_mm) {
  return rounded(capsule.start, capsule.end, capsule.end - capsule.start, capsule.radius, sagitta_mm);
}

}  // namespace softkin
