#pragma once

#include <optional>
#include <softkin/model/mesh/curve_spec.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

/// A surface that points are projected onto.
class Projection {
 public:
  explicit Projection(const GivenSurface& surface);

  struct Foot {
    Vec3 point, normal;
  };
  /// The surface's point nearest to one that is at most so far from it [mm]; else none.
  [[nodiscard]] std::optional<Foot> foot(const Vec3& point, double farthest) const;

 private:
  [[nodiscard]] std::optional<Foot> foot_on(const Sphere& sphere, const Vec3& point) const;
  [[nodiscard]] std::optional<Foot> foot_on(const Cylinder& cylinder, const Vec3& point, double beyond) const;
  [[nodiscard]] std::optional<Foot> foot_on(const TriangleSurface& surface, const Vec3& point) const;

  const GivenSurface& surface_;
  std::optional<SurfaceTree> tree_;
};

}  // namespace softkin
