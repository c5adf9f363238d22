#include <Eigen/Geometry>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

namespace {

double six_volumes(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a.dot(b.cross(c));
}

}  // namespace

double signed_volume(const Points& vertices, const Tetrahedron& element) {
  const Vec3 o = vertex_at(vertices, element[0]);
  return six_volumes(vertex_at(vertices, element[1]) - o, vertex_at(vertices, element[2]) - o,
                     vertex_at(vertices, element[3]) - o) /
         6;
}

double signed_volume(const Points& vertices, const Prism& element) {
  Vec3 p[6];
  for (int i = 0; i < 6; ++i) p[i] = vertex_at(vertices, element[i]) - vertex_at(vertices, element[0]);
  double six = six_volumes(p[0], p[2], p[1]) + six_volumes(p[3], p[4], p[5]);
  for (int i = 0; i < 3; ++i) {
    // a bilinear side encloses the mean of its two triangulations
    const int j = (i + 1) % 3;
    const Vec3 &a = p[i], &b = p[j], &c = p[j + 3], &d = p[i + 3];
    six += 0.5 * (six_volumes(a, b, c) + six_volumes(a, c, d) + six_volumes(a, b, d) + six_volumes(b, c, d));
  }
  return six / 6;
}

double enclosed_volume(const Points& vertices, const std::vector<Triangle>& triangles) {
  if (triangles.empty()) return 0;
  const Vec3 o = vertex_at(vertices, triangles.front()[0]);
  double six = 0;
  for (const Triangle& t : triangles)
    six += six_volumes(vertex_at(vertices, t[0]) - o, vertex_at(vertices, t[1]) - o, vertex_at(vertices, t[2]) - o);
  return six / 6;
}

}  // namespace softkin
