#include <Eigen/Geometry>
#include <softkin/model/compile/cavity.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

namespace {

// Three times the volume between a face and the origin.
double linear_face(const Points& positions, const CavityFace& face, const Vec3& origin) {
  const Vec3 a = vertex_at(positions, face.corners[0]) - origin, b = vertex_at(positions, face.corners[1]) - origin,
             c = vertex_at(positions, face.corners[2]) - origin;
  return 0.5 * a.dot(b.cross(c));
}

double quadratic_face(const Points& positions, const CavityFace& face, const Vec3& origin) {
  TriangleNodes nodes;
  for (int i = 0; i < 3; ++i) {
    nodes.row(i) = positions.row(face.corners[i]) - origin.transpose();
    nodes.row(i + 3) = positions.row(face.edges[i]) - origin.transpose();
  }
  double sum = 0;
  for (const TrianglePoint& point : triangle_rule()) {
    const Vec3 x = nodes.transpose() * point.shape, u = nodes.transpose() * point.along_u,
               v = nodes.transpose() * point.along_v;
    sum += point.weight * x.dot(u.cross(v));
  }
  return sum;
}

}  // namespace

double enclosed_volume(const Points& positions, const std::vector<CavityFace>& faces) {
  if (faces.empty()) return 0;
  // relative to a point of the boundary: far from the origin the terms would cancel
  const Vec3 origin = vertex_at(positions, faces.front().corners[0]);
  double three_volumes = 0;
  for (const CavityFace& face : faces)
    three_volumes += face.edges[0] < 0 ? linear_face(positions, face, origin) : quadratic_face(positions, face, origin);
  return three_volumes / 3;
}

}  // namespace softkin
