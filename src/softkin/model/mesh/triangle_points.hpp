#pragma once

#include <softkin/model/mesh/quadratic_elements.hpp>
#include <span>

namespace softkin {

/// Where a load that is spread over a triangle is looked at: of 3 nodes its middle, which is exact for a flat one (the
/// shape functions of the others are 0); of 6 triangle_rule(), exact for area vectors of degree 2 times shape
/// functions.
[[nodiscard]] std::span<const TrianglePoint> triangle_points(std::size_t nodes);

/// The edges of the surface there, d(position)/du and d(position)/dv [mm]; the area of a piece is that of their
/// parallelogram times the point's weight.
struct SurfaceEdges {
  Vec3 u = Vec3::Zero(), v = Vec3::Zero();

  SurfaceEdges(const TrianglePoint& point, std::span<const Index> nodes, const Points& positions);
};

}  // namespace softkin
