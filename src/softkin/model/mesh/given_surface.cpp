#include <Eigen/Geometry>
#include <softkin/model/mesh/given_surface.hpp>

namespace softkin {

Projection::Projection(const GivenSurface& surface) : surface_(surface) {
  if (const auto* triangles = std::get_if<TriangleSurface>(&surface.shape))
    tree_.emplace(triangles->vertices, triangles->triangles);
}

std::optional<Projection::Foot> Projection::foot(const Vec3& point, double farthest) const {
  std::optional<Foot> found;
  if (const auto* sphere = std::get_if<Sphere>(&surface_.shape))
    found = foot_on(*sphere, point);
  else if (const auto* cylinder = std::get_if<Cylinder>(&surface_.shape))
    found = foot_on(*cylinder, point, farthest);
  else
    found = foot_on(std::get<TriangleSurface>(surface_.shape), point);
  if (found && (found->point - point).norm() > farthest) return std::nullopt;
  return found;
}

std::optional<Projection::Foot> Projection::foot_on(const Sphere& sphere, const Vec3& point) const {
  const Vec3 offset = point - sphere.center;
  if (!(offset.norm() > 0)) return std::nullopt;
  const Vec3 normal = offset.normalized();
  return Foot{sphere.center + sphere.radius * normal, normal};
}

std::optional<Projection::Foot> Projection::foot_on(const Cylinder& cylinder, const Vec3& point, double beyond) const {
  const Vec3 axis = (cylinder.end - cylinder.start).normalized(), offset = point - cylinder.start;
  const double along = offset.dot(axis);
  if (along < -beyond || along > (cylinder.end - cylinder.start).norm() + beyond) return std::nullopt;
  const Vec3 across = offset - along * axis;
  if (!(across.norm() > 0)) return std::nullopt;
  const Vec3 normal = across.normalized();
  return Foot{cylinder.start + along * axis + cylinder.radius * normal, normal};
}

std::optional<Projection::Foot> Projection::foot_on(const TriangleSurface& surface, const Vec3& point) const {
  Index triangle = -1;
  const Vec3 near = tree_->nearest(point, &triangle);
  if (triangle < 0) return std::nullopt;
  const auto& [a, b, c] = surface.triangles[triangle];
  const Vec3 at = vertex_at(surface.vertices, a);
  return Foot{near, (vertex_at(surface.vertices, b) - at).cross(vertex_at(surface.vertices, c) - at).normalized()};
}

}  // namespace softkin
