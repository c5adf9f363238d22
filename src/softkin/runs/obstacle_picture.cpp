#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/runs/obstacle_picture.hpp>
#include <vector>

namespace softkin::runs {

namespace {

constexpr double surroundings = 0.5;   // how far they are drawn, over the robot's diagonal
constexpr double shadow_margin = 1.2;  // over the shadow

using Corners = std::array<Vec3, 3>;

/// Cuts a polygon off beyond a plane across an axis: side +1 or -1.
void cut(int axis, int side, double limit, std::vector<Vec3>& polygon) {
  std::vector<Vec3> kept;
  const auto inside = [&](const Vec3& p) { return side * (limit - p[axis]); };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double a = inside(from), b = inside(to);
    if (a >= 0) kept.push_back(from);
    if ((a < 0 && b > 0) || (a > 0 && b < 0)) kept.push_back(from + a / (a - b) * (to - from));
  }
  polygon = std::move(kept);
}

void add_within(const Bounds& box, const Corners& triangle, PictureLayer& layer, std::vector<Vec3>& points) {
  std::vector<Vec3> polygon(triangle.begin(), triangle.end());
  for (int axis = 0; axis < 3; ++axis) {
    cut(axis, 1, box.max()[axis], polygon);
    cut(axis, -1, box.min()[axis], polygon);
  }
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Index first = points.size();
    points.insert(points.end(), {polygon[0], polygon[i - 1], polygon[i]});
    layer.triangles.push_back({first, first + 1, first + 2});
  }
}

/// Of the plane of a triangle, as two.
std::array<Corners, 2> patch(const Corners& plane, const Bounds& robot) {
  const Vec3 normal = (plane[1] - plane[0]).cross(plane[2] - plane[0]).stableNormalized();
  int across = 0;
  normal.cwiseAbs().minCoeff(&across);
  const Vec3 u = (Vec3::Unit(across) - normal[across] * normal).normalized(), v = normal.cross(u);
  const Vec3 half = 0.5 * robot.sizes();
  const double reach = shadow_margin * std::max(half.dot(u.cwiseAbs()), half.dot(v.cwiseAbs()));
  const Vec3 center = robot.center() - normal.dot(robot.center() - plane[0]) * normal;
  const auto corner = [&](int a, int b) -> Vec3 { return center + reach * (a * u + b * v); };
  return {{{corner(-1, -1), corner(1, -1), corner(1, 1)}, {corner(-1, -1), corner(1, 1), corner(-1, 1)}}};
}

}  // namespace

std::optional<PictureLayer> body_layer(const Model& model, const Points& positions) {
  if (model.bodies.empty()) return std::nullopt;
  PictureLayer layer;
  layer.color = {0.85, 0.62, 0.30};
  layer.edges = false;
  layer.points = positions;
  for (std::size_t t = 0; t < model.contact.triangles.size(); ++t)
    if (model.contact.parts[model.contact.part_of[t]].rank == ContactRank::body)
      layer.triangles.push_back(model.contact.triangles[t]);
  return layer;
}

std::optional<PictureLayer> obstacle_layer(const Model& model, const Points& positions, const Bounds& robot) {
  const ContactModel& contact = model.contact;
  const Vec3 more = Vec3::Constant(surroundings * robot.diagonal().norm());
  const Bounds box(robot.min() - more, robot.max() + more);
  PictureLayer layer;
  layer.color = {0.55, 0.60, 0.66};
  layer.opacity = 0.4;
  layer.edges = false;
  std::vector<Vec3> points;
  for (std::size_t t = 0; t < contact.triangles.size(); ++t) {
    const ContactPart& part = contact.parts[contact.part_of[t]];
    if (part.rank != ContactRank::obstacle) continue;
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = vertex_at(positions, contact.triangles[t][i]);
    if (!part.halfspace) {
      add_within(box, corners, layer, points);
      continue;
    }
    for (const Corners& half : patch(corners, robot)) add_within(box, half, layer, points);
  }
  if (points.empty()) return std::nullopt;
  layer.points.resize(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) layer.points.row(i) = points[i].transpose();
  return layer;
}

}  // namespace softkin::runs
