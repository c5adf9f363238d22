#pragma once

#include <array>
#include <functional>
#include <softkin/core/types.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <span>
#include <unordered_map>
#include <vector>

namespace softkin {

using SurfaceCorner = std::array<double, 3>;
using FacetCorners = std::array<SurfaceCorner, 3>;

/// Twice the area, as a vector over the square of the longest edge; zero where the corners are on a line as far as
/// double precision can resolve.
[[nodiscard]] Vec3 facet_normal(const Vec3& a, const Vec3& b, const Vec3& c);

/// Makes a surface of facets: corners of equal coordinates become one vertex.
class Welder {
 public:
  void add(const FacetCorners& corners);
  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  TriangleSurface surface() &&;

 private:
  struct Hash {
    std::size_t operator()(const SurfaceCorner& point) const;
  };

  Index vertex(SurfaceCorner point);

  std::unordered_map<SurfaceCorner, Index, Hash> known_;
  std::vector<double> coordinates_;
  std::vector<Triangle> triangles_;
};

/// Cuts a polygon into triangles of its vertices. Vertices that follow each other at one place are one; what has fewer
/// than three then is no triangle.
///
/// fail  is called with the reason, and must throw, where the polygon has no area, a vertex lies farther from its plane
///       than 5 % of its size, or it is no simple polygon
[[nodiscard]] std::vector<FacetCorners> triangulated(std::vector<SurfaceCorner> polygon,
                                                     const std::function<void(const std::string&)>& fail);

}  // namespace softkin
