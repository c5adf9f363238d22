#pragma once

#include <softkin/core/types.hpp>
#include <vector>

namespace softkin {

using Vec2 = Eigen::Vector2d;

/// Points of a profile (distance along the axis, distance from it) near an edge, with their neighbours in the mesh.
/// The points 0 and 1 are the ends of the edge.
struct ProfilePatch {
  std::vector<Vec2> points;
  std::vector<std::vector<int>> neighbours;  // of each point: those to which an edge of the mesh leads
};

/// How a profile runs from point 0 to point 1 of a patch: on an arc through both.
///
/// The bend b of an arc is 1 / (2 c) for the height c of its centre above the chord, 0 for a straight line; above is to
/// the left of the chord.
struct ProfileArc {
  double bend = 0;
  bool determined = false;     // whether the points of the patch determine the bend
  double least = 0, most = 0;  // bends that are possible, too, where they do not
};

/// Returns the arc that the points of a patch determine: a line through a third point, a circle through five points or
/// through four at regular distances, a circle through three that is tangent to what continues it, or a curve that
/// bends alike on both sides of the edge. Any other bend is undetermined and the arc is straight.
///
/// Two points of a symmetric notch and its floor lie on a circle, too; so three points determine nothing.
///
/// is_aligned  whether a straight profile would be parallel or perpendicular to the axis, as shafts and shoulders are
[[nodiscard]] ProfileArc profile_arc(const ProfilePatch& patch, bool is_aligned);

/// Returns the point of the arc over the chord's point at this fraction, from 0 at point 0 to 1 at point 1.
[[nodiscard]] Vec2 point_of_arc(const Vec2& start, const Vec2& end, double bend, double fraction);

/// Returns the point of the arc between both points that is nearest to a place.
[[nodiscard]] Vec2 nearest_of_arc(const Vec2& start, const Vec2& end, double bend, const Vec2& place);

}  // namespace softkin
