#include "support/random_drops.hpp"

#include <Eigen/Geometry>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <softkin/model/mesh/boundary.hpp>

#include "model/block_mesh.hpp"
#include "random/draw.hpp"
#include "support/exact_crossing.hpp"
#include "support/two_bodies.hpp"

namespace softkin::testing {

namespace {

using random_robots::Draw;

PressedBody body_of(const std::vector<Vec3>& points, std::vector<Tetrahedron> tetrahedra) {
  PressedBody body{Points(points.size(), 3), std::move(tetrahedra), {}};
  for (std::size_t i = 0; i < points.size(); ++i) body.vertices.row(i) = points[i];
  return body;
}

/// A tetrahedron for each triangle of a closed surface and a point inside.
PressedBody cone(std::vector<Vec3> points, const std::vector<Triangle>& outwards) {
  std::vector<Tetrahedron> tetrahedra;
  for (const auto& [a, b, c] : outwards) tetrahedra.push_back({a, b, c, static_cast<Index>(points.size())});
  for (Tetrahedron& t : tetrahedra) std::swap(t[1], t[2]);  // the point is behind the faces
  points.push_back(Vec3::Zero());
  return body_of(points, tetrahedra);
}

/// Each triangle in four, or in three around its middle.
void refine(std::vector<Vec3>& points, std::vector<Triangle>& triangles, bool in_four) {
  std::map<std::pair<Index, Index>, Index> middles;
  const auto add = [&](const Vec3& p) {
    points.push_back(p);
    return static_cast<Index>(points.size()) - 1;
  };
  const auto at = [&](Index v) { return points[v]; };
  const auto middle = [&](Index a, Index b) {
    const std::pair edge = std::minmax(a, b);
    if (!middles.contains(edge)) middles[edge] = add((at(a) + at(b)) / 2);
    return middles[edge];
  };
  std::vector<Triangle> finer;
  for (const auto& [a, b, c] : triangles) {
    if (in_four) {
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    } else {
      const Index m = add((at(a) + at(b) + at(c)) / 3);
      finer.insert(finer.end(), {{a, b, m}, {b, c, m}, {c, a, m}});
    }
  }
  triangles = finer;
}

PressedBody draw_cube(Draw& draw) {
  Mesh mesh = block_mesh({1, 1, 1}, {1, 1, 1}, draw.chance(0.5) ? Split::five : Split::six);
  mesh.vertices.rowwise() -= Eigen::RowVector3d(0.5, 0.5, 0.5);
  if (draw.chance(0.5)) return {mesh.vertices, mesh.tetrahedra, {}};
  std::vector<Vec3> points;
  for (Index v = 0; v < 8; ++v) points.push_back(vertex_at(mesh.vertices, v));
  return cone(points, boundary_of(mesh.tetrahedra, {}).triangles);
}

PressedBody draw_tetrahedron(Draw& draw) {
  std::vector<Vec3> points{{0.5, 0.5, 0.5}, {-0.5, -0.5, 0.5}, {0.5, -0.5, -0.5}, {-0.5, 0.5, -0.5}};
  std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  refine(points, triangles, draw.chance(0.5));
  return cone(points, triangles);
}

PressedBody draw_octahedron(Draw& draw) {
  std::vector<Vec3> points{{0.6, 0, 0}, {0, 0.6, 0}, {0, 0, 0.6}, {-0.6, 0, 0}, {0, -0.6, 0}, {0, 0, -0.6}};
  std::vector<Triangle> triangles{{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                                  {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  if (draw.chance(0.5)) refine(points, triangles, false);
  return cone(points, triangles);
}

Mat3 draw_rotation(Draw& draw) {
  Eigen::Vector4d q;  // uniform in the ball
  do
    for (double& value : q) value = draw.between(-1, 1);
  while (q.norm() > 1 || q.norm() < 0.1);
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

/// Sheared, jittered, turned and enlarged to a height of about `size`.
void deform(Draw& draw, PressedBody& body, double size) {
  Mat3 shear = Mat3::Identity();
  for (double& entry : shear.reshaped()) entry += draw.between(-0.2, 0.2);
  const Mat3 map = size * draw_rotation(draw) * shear;
  const double jitter = draw.between(0, 0.06);
  for (Index v = 0; v < body.vertices.rows(); ++v)
    body.vertices.row(v) = (map * (vertex_at(body.vertices, v) + jitter * draw.offset())).transpose();
}

bool is_sound(const PressedBody& body) {
  double longest = 0;
  for (const Tetrahedron& t : body.tetrahedra) longest = std::max(longest, longest_edge(body.vertices, t));
  return std::all_of(body.tetrahedra.begin(), body.tetrahedra.end(), [&](const Tetrahedron& t) {
    return signed_volume(body.vertices, t) > 0.004 * std::pow(longest, 3);
  });
}

/// Have the first vertex and two others a triangle of at least that area, doubled?
bool span_area(const PressedBody& body, double area) {
  const auto from_first = [&](Index v) {
    return Vec3(vertex_at(body.vertices, v) - vertex_at(body.vertices, body.held.front()));
  };
  for (const Index a : body.held)
    for (const Index b : body.held)
      if (from_first(a).cross(from_first(b)).norm() >= area) return true;
  return false;
}

/// side  1: the far side is above, -1: below
void hold_far_side(PressedBody& body, double side) {
  const Eigen::VectorXd height = side * body.vertices.col(2);
  const double extent = height.maxCoeff() - height.minCoeff();
  std::vector<Index> farthest_first(height.size());
  std::iota(farthest_first.begin(), farthest_first.end(), 0);
  std::sort(farthest_first.begin(), farthest_first.end(), [&](Index a, Index b) { return height[a] > height[b]; });
  for (const Index v : farthest_first) {
    const bool near = height[v] < height.maxCoeff() - 0.2 * extent;
    if (near && span_area(body, 0.1 * extent * extent)) break;
    body.held.push_back(v);
  }
}

PressedBody draw_body(Draw& draw, double size, double side) {
  for (;;) {
    const int kind = draw.below(3);
    PressedBody body = kind == 0 ? draw_cube(draw) : kind == 1 ? draw_tetrahedron(draw) : draw_octahedron(draw);
    deform(draw, body, size);
    if (!is_sound(body)) continue;
    hold_far_side(body, side);
    return body;
  }
}

/// Whether the surfaces of two bodies meet, as one robot.
class Meeting {
 public:
  Meeting(const PressedBody& lower, const PressedBody& upper) {
    const Mesh mesh = two_bodies("", lower, upper, Vec3::Zero()).mesh;
    vertices_ = mesh.vertices;
    upper_ = lower.vertices.rows();
    triangles_ = boundary_of(mesh.tetrahedra, {}).triangles;
    for (const Triangle& t : triangles_) group_.push_back(t[0] < upper_ ? 0 : 1);
  }
  [[nodiscard]] bool raised_by(double height) const {
    return !crossings(moved_from(upper_, vertices_, {0, 0, height}), triangles_, group_).empty();
  }

 private:
  Points vertices_;
  Index upper_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<int> group_;
};

/// From above: the height at which the upper body, coming down, first touches the lower one, to 1e-6 of its size. Steps
/// down to the first that meets, then halves.
double touching_height(const Meeting& meeting, double apart, double size) {
  const double step = size / 50;
  double high = apart, low = apart - step;
  for (; !meeting.raised_by(low); low -= step) {
    if (low < apart - 10 * size) return apart;  // beside it
    high = low;
  }
  while (high - low > 1e-6 * size) {
    const double middle = (low + high) / 2;
    (meeting.raised_by(middle) ? low : high) = middle;
  }
  return high;
}

double lowest_of(const PressedBody& body, double side) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Index v : body.held) lowest = std::min(lowest, side * body.vertices(v, 2));
  return lowest;
}

/// None where the bodies would meet at rest, or what is held would come too near to each other.
std::optional<Drop> attempt(Draw& draw, const std::string& name) {
  const double size = draw.log_between(2, 50);
  const PressedBody lower = draw_body(draw, size * draw.between(0.7, 1.5), -1);
  PressedBody upper = draw_body(draw, size, 1);
  const auto height = upper.vertices.col(2);
  Drop drop;
  drop.upper = lower.vertices.rows();
  drop.size_mm = height.maxCoeff() - height.minCoeff();
  drop.gap_mm = drop.size_mm * draw.log_between(0.02, 0.5);
  drop.displacement.z() = -drop.size_mm * draw.between(0.2, 0.8);
  if (draw.chance(0.5)) drop.displacement.head<2>() = 0.5 * drop.size_mm * draw.offset().head<2>();
  upper.vertices.rowwise() += drop.size_mm * Eigen::RowVector3d(draw.between(-0.3, 0.3), draw.between(-0.3, 0.3), 0);
  const Meeting meeting(lower, upper);
  const double above = lower.vertices.col(2).maxCoeff() - height.minCoeff() + 1e-3 * size;
  const double raise = touching_height(meeting, above, size) + drop.gap_mm;
  upper.vertices.col(2).array() += raise;
  const double room = lowest_of(upper, 1) + lowest_of(lower, -1) + drop.displacement.z();
  if (room < 0.3 * drop.size_mm || meeting.raised_by(raise)) return {};
  drop.robot = two_bodies(name, lower, upper, drop.displacement);
  drop.robot.mesh_options.quadratic = draw.chance(0.25);
  return drop;
}

}  // namespace

Drop random_drop(std::uint64_t seed) {
  Draw draw(seed);
  for (;;)
    if (std::optional<Drop> drop = attempt(draw, "drop_" + std::to_string(seed))) return *drop;
}

}  // namespace softkin::testing
