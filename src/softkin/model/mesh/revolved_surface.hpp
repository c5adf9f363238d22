#pragma once

#include <optional>
#include <softkin/model/mesh/circle_axes.hpp>
#include <softkin/model/mesh/profile_arc.hpp>
#include <softkin/model/mesh/smooth_surface.hpp>
#include <vector>

namespace softkin {

/// From the middle of an edge's chord to where the middle of the edge may be [mm].
struct BulgeRange {
  Vec3 bulge{0, 0, 0};
  bool determined = true;                  // whether the mesh determines it
  Vec3 inward{0, 0, 0}, outward{0, 0, 0};  // where not, the limits of what is possible, too
};

/// The parts of a mesh's surface that are surfaces of revolution.
///
/// Axes are those of circles of creases, such as the rims of a shaft's ends. A face belongs to an axis where its normal
/// points from that axis within the face's own angle about it. A profile is found for each edge from the vertices
/// around it, whatever their angle about the axis (profile_arc.hpp).
class RevolvedSurface {
 public:
  /// crease  the widest step between vertices of a circle [degrees]
  RevolvedSurface(const Points& vertices, const SmoothSurface& surface, double crease);

  /// Returns how the edge curves, or nothing where its faces are not all of one surface of revolution.
  [[nodiscard]] std::optional<BulgeRange> bulge(std::size_t edge) const;

 private:
  [[nodiscard]] Vec2 profile_of(Index axis, Index vertex) const;
  [[nodiscard]] double azimuth_between(Index axis, Index a, Index b) const;
  void assign_faces(Index axis);
  [[nodiscard]] bool is_about(Index axis, Index face) const;
  [[nodiscard]] bool is_flat(Index axis, Index face) const;  // perpendicular to the axis
  [[nodiscard]] bool belongs(Index axis, Index face) const;  // is of the axis, or flat
  void drop_contradictions(Index axis);
  void drop_partial_patches(Index axis);
  void drop_flat_sides(Index axis);
  void find_neighbours();
  [[nodiscard]] ProfilePatch patch_around(Index axis, Index a, Index b) const;
  [[nodiscard]] Vec3 placed(const AxisLine& axis, const Vec2& profile, const Vec3& middle) const;
  [[nodiscard]] Index axis_of(std::size_t edge) const;
  [[nodiscard]] bool is_within_flat_end(std::size_t edge) const;

  const Points& vertices_;
  const SmoothSurface& surface_;
  double crease_ = 0;  // [rad]
  std::vector<AxisLine> axes_;
  std::vector<double> turns_;        // of faces: the largest angle to a neighbour with which it may be smooth [rad]
  std::vector<Index> axis_of_face_;  // -1: none
  std::vector<std::vector<std::array<Index, 2>>> neighbours_;  // of vertices: along an edge of a face, and the face
};

}  // namespace softkin
