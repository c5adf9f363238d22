#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/contact/distance.hpp>
#include <softkin/statics/gap.hpp>
#include <softkin/statics/physical/contact_points.hpp>

namespace softkin {

namespace {

using Box = Eigen::AlignedBox3d;

/// Vertices and triangles of one of the two.
struct SurfaceOfSide {
  std::vector<Index> vertices;  // ascending
  std::vector<std::array<Index, 3>> triangles;
};

SurfaceOfSide surface_of(const ContactModel& contact, const auto& counts) {
  SurfaceOfSide side;
  for (std::size_t t = 0; t < contact.triangles.size(); ++t) {
    if (!counts(contact.part_of[t])) continue;
    side.triangles.push_back(contact.triangles[t]);
    side.vertices.insert(side.vertices.end(), contact.triangles[t].begin(), contact.triangles[t].end());
  }
  sort_unique(side.vertices);
  return side;
}

/// Keeps the nearest pair of a vertex of one side and a triangle of the other in `gap`.
void look(const Points& points, const SurfaceOfSide& vertices, const SurfaceOfSide& triangles, bool of_robot,
          Gap& gap) {
  std::vector<Box> boxes;
  Box all;
  for (const std::array<Index, 3>& t : triangles.triangles) {
    Box& box = boxes.emplace_back();
    for (const Index v : t) box.extend(vertex_at(points, v));
    all.extend(box);
  }
  contact::FourPoints x;
  for (const Index v : vertices.vertices) {
    x.col(0) = vertex_at(points, v);
    if (all.exteriorDistance(x.col(0).eval()) >= gap.width_mm) continue;
    for (std::size_t t = 0; t < boxes.size(); ++t) {
      if (boxes[t].exteriorDistance(x.col(0).eval()) >= gap.width_mm) continue;
      const std::array<Index, 3>& corners = triangles.triangles[t];
      for (int i = 0; i < 3; ++i) x.col(i + 1) = vertex_at(points, corners[i]);
      const contact::Separation apart = contact::vertex_triangle(x);
      const double width = std::sqrt(apart.squared);
      if (!(width < gap.width_mm)) continue;
      const Vec3 towards = width > 0 ? Vec3(apart.vector / width) : Vec3::Zero();
      gap = {width,
             of_robot ? Vec3(-towards) : towards,
             {v, corners[0], corners[1], corners[2]},
             -apart.weights.tail<3>(),
             of_robot};
    }
  }
}

}  // namespace

std::optional<Gap> gap_before(const Model& model, Index part, const Points& positions) {
  const ContactModel& contact = model.contact;
  const SurfaceOfSide robot = surface_of(
      contact, [&](Index p) { return contact.parts[p].rank == ContactRank::robot && contact.pair(p, part).touch; });
  const SurfaceOfSide other = surface_of(contact, [&](Index p) { return p == part; });
  if (robot.triangles.empty() || other.triangles.empty()) return std::nullopt;
  const Points points = physical::ContactPoints::in(model, positions);
  Gap gap;
  gap.width_mm = std::numeric_limits<double>::infinity();
  look(points, robot, other, true, gap);
  look(points, other, robot, false, gap);
  if (!std::isfinite(gap.width_mm)) return std::nullopt;
  return gap;
}

double change_of(const Gap& gap, const Model& model, const Points& moves) {
  const Points points = physical::ContactPoints::in(model, moves);
  const Vec3 vertex = vertex_at(points, gap.points[0]);
  Vec3 other = Vec3::Zero();
  for (int i = 0; i < 3; ++i) other += gap.corners[i] * vertex_at(points, gap.points[i + 1]);
  return gap.towards.dot(gap.vertex_of_robot ? Vec3(other - vertex) : Vec3(vertex - other));
}

}  // namespace softkin
