#include <Eigen/Geometry>
#include <softkin/model/mesh/quadratic_triangle.hpp>

namespace softkin {

namespace {

TrianglePoint triangle_point(double u, double v, double weight) {
  const double t = 1 - u - v;
  TrianglePoint point;
  point.shape << t * (2 * t - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * t * u, 4 * u * v, 4 * v * t;
  point.along_u << 1 - 4 * t, 4 * u - 1, 0, 4 * (t - u), 4 * v, -4 * v;
  point.along_v << 1 - 4 * t, 0, 4 * v - 1, -4 * u, 4 * u, 4 * (t - v);
  point.weight = weight;
  return point;
}

std::array<TrianglePoint, 6> make_rule() {
  constexpr double a = 0.44594849091596488632, of_a = 0.22338158967801146570 / 2;
  constexpr double b = 0.09157621350977074346, of_b = 0.10995174365532186764 / 2;
  return {triangle_point(a, a, of_a), triangle_point(1 - 2 * a, a, of_a), triangle_point(a, 1 - 2 * a, of_a),
          triangle_point(b, b, of_b), triangle_point(1 - 2 * b, b, of_b), triangle_point(b, 1 - 2 * b, of_b)};
}

}  // namespace

const std::array<TrianglePoint, 6>& triangle_rule() {
  static const std::array<TrianglePoint, 6> rule = make_rule();
  return rule;
}

Eigen::Matrix<double, 6, 1> shape_integrals(const TriangleNodes& nodes) {
  Eigen::Matrix<double, 6, 1> integrals = Eigen::Matrix<double, 6, 1>::Zero();
  for (const TrianglePoint& point : triangle_rule()) {
    const Vec3 u = nodes.transpose() * point.along_u, v = nodes.transpose() * point.along_v;
    integrals += point.weight * u.cross(v).norm() * point.shape;
  }
  return integrals;
}

}  // namespace softkin
