#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/model/mesh/disjoint_sets.hpp>
#include <softkin/model/mesh/revolved_surface.hpp>

namespace softkin {

namespace {

constexpr double axis_radians = std::numbers::pi / 180;
const double crease_of_circles =
    std::cos(25 * axis_radians);                        // faces that turn by more meet in a line that may be a circle
const double one_patch = std::cos(20 * axis_radians);   // faces that turn by less are of one kind
const double one_side = std::cos(80 * axis_radians);    // faces that turn by less are about the axis alike
const double half_right = std::cos(46 * axis_radians);  // faces that turn by more say nothing about their curvature
constexpr double widest_face = 120 * axis_radians;      // as seen from the axis
constexpr double perpendicular = 1 - 1e-6;              // cosine between an axis and the normal of a flat end
constexpr double aligned = 1e-3;                        // sine between an axis and a line parallel to it
// Of the length of an edge:
constexpr double same_circle = 1e-4;   // difference of its ends' profiles
constexpr double almost_circle = 0.3;  // the same, of an edge that goes around more than along

/// The difference of two angles, from -pi to pi.
double wrapped(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

}  // namespace

RevolvedSurface::RevolvedSurface(const Points& vertices, const SmoothSurface& surface, double crease)
    : vertices_(vertices), surface_(surface), crease_(crease * axis_radians) {
  std::vector<std::array<Index, 2>> creases;
  for (std::size_t e = 0; e < surface.edges(); ++e) {
    const auto turns = surface.turns_at(e);
    if (turns.size() != 1 || turns[0].cosine < crease_of_circles) creases.push_back(surface.ends(e));
  }
  axes_ = circle_axes(vertices, creases, crease_ + 0.5 * axis_radians);
  axis_of_face_.assign(surface.faces().size(), -1);
  turns_.assign(surface.faces().size(), 0);
  for (std::size_t e = 0; e < surface.edges(); ++e)
    for (const auto& [face, other, cosine] : surface.turns_at(e))
      if (cosine >= half_right)
        for (const Index f : {face, other}) turns_[f] = std::max(turns_[f], std::acos(std::min(1.0, cosine)));
  for (Index axis = 0; axis < std::ssize(axes_); ++axis) assign_faces(axis);
  if (!axes_.empty()) find_neighbours();
}

Vec2 RevolvedSurface::profile_of(Index axis, Index vertex) const {
  const Vec3 offset = vertex_at(vertices_, vertex) - axes_[axis].point;
  const double along = offset.dot(axes_[axis].direction);
  return {along, (offset - along * axes_[axis].direction).norm()};
}

/// The angle about an axis from one vertex to another; 0 where one lies on the axis.
double RevolvedSurface::azimuth_between(Index axis, Index a, Index b) const {
  const auto& [point, direction] = axes_[axis];
  const Vec3 u = vertex_at(vertices_, a) - point, v = vertex_at(vertices_, b) - point;
  const Vec3 across_u = u - u.dot(direction) * direction, across_v = v - v.dot(direction) * direction;
  if (std::min(across_u.norm(), across_v.norm()) <= 1e-6 * (u - v).norm()) return 0;
  return std::atan2(direction.dot(across_u.cross(across_v)), across_u.dot(across_v));
}

void RevolvedSurface::assign_faces(Index axis) {
  bool any = false;
  for (Index f = 0; f < std::ssize(axis_of_face_); ++f)
    if (axis_of_face_[f] < 0 && is_about(axis, f)) {
      axis_of_face_[f] = axis;
      any = true;
    }
  if (!any) return;
  drop_contradictions(axis);
  drop_flat_sides(axis);
  drop_partial_patches(axis);
}

bool RevolvedSurface::is_flat(Index axis, Index face) const {
  return std::abs(surface_.face_normal(face).dot(axes_[axis].direction)) >= perpendicular;
}

bool RevolvedSurface::belongs(Index axis, Index face) const {
  return axis_of_face_[face] == axis || is_flat(axis, face);
}

/// Whether a face's normal is that of a surface of revolution somewhere within the face.
bool RevolvedSurface::is_about(Index axis, Index face) const {
  if (is_flat(axis, face)) return false;
  const auto& [point, direction] = axes_[axis];
  const Vec3& normal = surface_.face_normal(face);
  const Triangle& corners = surface_.faces()[face];
  double widest = 0;
  Vec3 middle = -point;
  for (int i = 0; i < 3; ++i) {
    middle += vertex_at(vertices_, corners[i]) / 3;
    widest = std::max(widest, std::abs(azimuth_between(axis, corners[i], corners[(i + 1) % 3])));
  }
  if (widest > widest_face) return false;
  const Vec3 outward = middle - middle.dot(direction) * direction;
  if (!(outward.norm() > 0)) return false;
  const double across = std::abs(normal.dot(direction.cross(outward.normalized())));
  const double radial = std::sqrt(std::max(0.0, 1 - std::pow(normal.dot(direction), 2)));
  return across <= radial * std::sin(0.6 * widest) + std::sin(0.5 * turns_[face] + 0.5 * axis_radians);
}

/// Edges that go around the axis change their distance from it as the surface does along the axis: those of an ellipse
/// do not.
void RevolvedSurface::drop_contradictions(Index axis) {
  std::vector<std::vector<Vec2>> along(vertices_.rows());  // directions of the profile
  struct Around {
    std::size_t edge;
    Vec2 direction;
  };
  std::vector<Around> around;
  for (std::size_t e = 0; e < surface_.edges(); ++e) {
    const auto faces = surface_.faces_at(e);
    if (std::none_of(faces.begin(), faces.end(), [&](Index f) { return belongs(axis, f); })) continue;
    const auto [low, high] = surface_.ends(e);
    const Vec2 step = profile_of(axis, high) - profile_of(axis, low);
    const double length = (vertices_.row(high) - vertices_.row(low)).norm();
    if (step.norm() > 0.5 * length)
      for (const Index v : {low, high}) along[v].push_back(step.normalized());
    else if (step.norm() > 0.01 * length && step.norm() < almost_circle * length)
      around.push_back({e, step.normalized()});
  }
  for (const auto& [edge, direction] : around) {
    const auto [low, high] = surface_.ends(edge);
    bool agrees = along[low].empty() && along[high].empty();
    for (const Index v : {low, high})
      for (const Vec2& other : along[v])
        agrees = agrees || std::abs(other.dot(direction)) >= std::cos(45 * axis_radians);
    if (agrees) continue;
    for (const Index f : surface_.faces_at(edge))
      if (axis_of_face_[f] == axis) axis_of_face_[f] = -1;
  }
}

/// Faces that are wider than a step of a circle are flat sides of a prism unless the vertices around them lie at angles
/// in between.
void RevolvedSurface::drop_flat_sides(Index axis) {
  std::vector<std::vector<Index>> beside(vertices_.rows());
  for (std::size_t e = 0; e < surface_.edges(); ++e)
    for (const auto& turn : surface_.turns_at(e)) {
      if (axis_of_face_[turn.face] != axis || axis_of_face_[turn.other] != axis || turn.cosine < one_side) continue;
      const auto [low, high] = surface_.ends(e);
      for (const Index v : {low, high})
        for (const Index f : {turn.face, turn.other}) beside[v].push_back(f);
    }
  std::vector<Index> flat;
  for (Index f = 0; f < std::ssize(axis_of_face_); ++f) {
    if (axis_of_face_[f] != axis) continue;
    const Triangle& corners = surface_.faces()[f];
    double low = 0, high = 0;  // angles of the corners from the first one
    for (const Index v : corners) {
      const double angle = azimuth_between(axis, corners[0], v);
      low = std::min(low, angle);
      high = std::max(high, angle);
    }
    if (high - low <= crease_ + 0.5 * axis_radians) continue;
    std::vector<double> angles{low, high};
    for (const Index v : corners)
      for (const Index near : beside[v])
        for (const Index w : surface_.faces()[near])
          for (const Index next : beside[w])
            for (const Index u : surface_.faces()[next])
              if (const double angle = azimuth_between(axis, corners[0], u); angle > low && angle < high)
                angles.push_back(angle);
    std::sort(angles.begin(), angles.end());
    double gap = 0;
    for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
    if (gap > crease_ + 0.5 * axis_radians) flat.push_back(f);
  }
  for (const Index f : flat) axis_of_face_[f] = -1;
}

/// A patch without creases belongs to an axis as a whole or not at all.
void RevolvedSurface::drop_partial_patches(Index axis) {
  DisjointSets patches(axis_of_face_.size());
  for (std::size_t e = 0; e < surface_.edges(); ++e)
    for (const auto& turn : surface_.turns_at(e))
      if (turn.cosine >= one_patch) patches.join(turn.face, turn.other);
  std::vector<char> is_partial(axis_of_face_.size(), 0);
  for (Index f = 0; f < std::ssize(axis_of_face_); ++f)
    if (!belongs(axis, f)) is_partial[patches.find(f)] = 1;
  for (Index f = 0; f < std::ssize(axis_of_face_); ++f)
    if (axis_of_face_[f] == axis && is_partial[patches.find(f)]) axis_of_face_[f] = -1;
}

void RevolvedSurface::find_neighbours() {
  neighbours_.resize(vertices_.rows());
  for (std::size_t e = 0; e < surface_.edges(); ++e) {
    const auto [low, high] = surface_.ends(e);
    for (const Index f : surface_.faces_at(e)) {
      neighbours_[low].push_back({high, f});
      neighbours_[high].push_back({low, f});
    }
  }
  for (auto& all : neighbours_) sort_unique(all);
}

/// The vertices within three edges of an edge's ends.
ProfilePatch RevolvedSurface::patch_around(Index axis, Index a, Index b) const {
  constexpr int rings = 3;
  constexpr std::size_t max_points = 120;
  std::vector<Index> found{a, b};
  for (std::size_t ring = 0, from = 0; ring < rings && found.size() < max_points; ++ring) {
    const std::size_t to = found.size();
    for (; from < to; ++from)
      for (const auto& [vertex, face] : neighbours_[found[from]])
        if (belongs(axis, face) && std::find(found.begin(), found.end(), vertex) == found.end())
          found.push_back(vertex);
  }
  ProfilePatch patch;
  patch.neighbours.resize(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    patch.points.push_back(profile_of(axis, found[i]));
    for (const auto& [vertex, face] : neighbours_[found[i]])
      if (const auto at = std::find(found.begin(), found.end(), vertex); at != found.end() && belongs(axis, face))
        patch.neighbours[i].push_back(static_cast<int>(at - found.begin()));
  }
  return patch;
}

/// The axis of all faces of an edge; of a circle, and of a line in a plane through the axis, that of some; or -1.
Index RevolvedSurface::axis_of(std::size_t edge) const {
  const auto faces = surface_.faces_at(edge);
  Index axis = -1;
  for (const Index f : faces) axis = std::max(axis, axis_of_face_[f]);
  if (axis < 0 || std::all_of(faces.begin(), faces.end(), [&](Index f) { return belongs(axis, f); })) return axis;
  if (std::any_of(faces.begin(), faces.end(), [&](Index f) { return axis_of_face_[f] >= 0 && !belongs(axis, f); }))
    return -1;
  const auto [low, high] = surface_.ends(edge);
  const double length = (vertices_.row(high) - vertices_.row(low)).norm();
  const Vec2 start = profile_of(axis, low), end = profile_of(axis, high);
  const bool is_circle = (end - start).norm() <= same_circle * length;
  const bool is_meridian = std::abs(wrapped(azimuth_between(axis, low, high))) <= same_circle;
  return is_circle || is_meridian ? axis : -1;
}

/// Whether an edge lies within a flat part that is perpendicular to an axis, such as the end or the shoulder of a
/// shaft.
bool RevolvedSurface::is_within_flat_end(std::size_t edge) const {
  const auto faces = surface_.faces_at(edge);
  for (Index axis = 0; axis < std::ssize(axes_); ++axis)
    if (faces.size() > 1 && std::all_of(faces.begin(), faces.end(), [&](Index f) { return is_flat(axis, f); }))
      return true;
  return false;
}

/// From a place to the point of the profile at the place's angle about the axis.
Vec3 RevolvedSurface::placed(const AxisLine& axis, const Vec2& profile, const Vec3& middle) const {
  const Vec3 offset = middle - axis.point;
  const double along = offset.dot(axis.direction);
  const Vec3 outward = offset - along * axis.direction;
  return (profile.x() - along) * axis.direction + (profile.y() - outward.norm()) * outward.normalized();
}

std::optional<BulgeRange> RevolvedSurface::bulge(std::size_t edge) const {
  const Index number = axes_.empty() ? -1 : axis_of(edge);
  const auto faces = surface_.faces_at(edge);
  BulgeRange range;
  if (number < 0) {
    if (is_within_flat_end(edge)) return range;
    return std::nullopt;
  }
  const AxisLine& axis = axes_[number];
  const auto [low, high] = surface_.ends(edge);
  const Vec3 middle = 0.5 * (vertex_at(vertices_, low) + vertex_at(vertices_, high));
  const double length = (vertices_.row(high) - vertices_.row(low)).norm();
  const Vec3 offset = middle - axis.point;
  const Vec2 place(offset.dot(axis.direction), offset.cross(axis.direction).norm());
  if (place.y() <= 1e-6 * length) return range;  // across the axis
  const Vec2 start = profile_of(number, low), end = profile_of(number, high), step = end - start;
  if (step.norm() <= almost_circle * length) {
    range.bulge = placed(axis, 0.5 * (start + end), middle);
    return range;
  }
  const bool is_aligned = step.cwiseAbs().minCoeff() <= aligned * step.norm();
  const ProfileArc arc = profile_arc(patch_around(number, low, high), is_aligned);
  const auto at = [&](double bend) { return placed(axis, nearest_of_arc(start, end, bend, place), middle); };
  range.bulge = at(arc.bend);
  range.determined = arc.determined;
  if (arc.determined) return range;
  range.inward = at(arc.least);
  range.outward = at(arc.most);
  Vec3 normal = Vec3::Zero();
  for (const Index f : faces) normal += surface_.face_normal(f);
  if (normal.dot(range.outward - range.inward) < 0) std::swap(range.inward, range.outward);
  return range;
}

}  // namespace softkin
