#pragma once

#include <softkin/model/mesh/mesh.hpp>
#include <softkin/model/shapes.hpp>

namespace softkin {

/// A shape as triangles, normals outwards. All vertices lie on the shape itself, so that facets of a curved one cut
/// into it and enclose a little less.
struct FacetedSurface {
  TriangleSurface surface;
  double sagitta_mm = 0;  // how far the facets are from the shape at most; 0: flat faces
};

inline constexpr std::size_t max_facets = 20000;

// Shapes of which complaint_about() finds nothing to complain. Curved ones get as many facets as it takes to stay
// within sagitta_mm > 0 of the shape, but at most max_facets.

/// 12 triangles.
[[nodiscard]] FacetedSurface faceted(const Box& box);

/// The boundary of the side against the normal: an equilateral triangle with its normal along it, around the point of
/// the plane that is nearest to `beside`, that holds a circle of radius reach_mm around that point.
[[nodiscard]] FacetedSurface faceted(const Halfspace& halfspace, const Vec3& beside, double reach_mm);

/// Rings of latitude n at a right angle's n-th part, the k-th from a pole with 4 k vertices: 8 n^2 triangles.
[[nodiscard]] FacetedSurface faceted(const Sphere& sphere, double sagitta_mm);

/// A prism of n sides with a fan at each end: 4 n triangles.
[[nodiscard]] FacetedSurface faceted(const Cylinder& cylinder, double sagitta_mm);

/// Halves of a sphere with a tube between: 8 n^2 + 8 n triangles.
[[nodiscard]] FacetedSurface faceted(const Capsule& capsule, double sagitta_mm);

}  // namespace softkin
