#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/energy/elastic.hpp>
#include <string>

namespace softkin::energy {

namespace {

template <int K>
using Nodes = Eigen::Matrix<double, K, 3>;

std::string place(const Eigen::RowVector3d& p) {
  return "element at rest, first node (" + std::to_string(p[0]) + ", " + std::to_string(p[1]) + ", " +
         std::to_string(p[2]) + ") mm: ";
}

/// One quadrature point: gradients in the parent's coordinates, turned into the rest shape's.
template <int K>
void set_point(const Nodes<K>& rest, const Nodes<K>& by_parent, double weight, Nodes<K>& slope, double& volume) {
  const Mat3 jacobian = rest.transpose() * by_parent;  // dX_i / dxi_j
  volume = weight * jacobian.determinant();
  if (!(volume > 0) || !std::isfinite(volume))
    throw InvalidInput(place(rest.row(0)) + "its volume at a quadrature point is " + std::to_string(volume) +
                       " mm^3, not above 0");
  slope = by_parent * jacobian.inverse();
}

/// dN/dxi of the quadratic tetrahedron: N_i = L_i (2 L_i - 1) at corners, 4 L_i L_j on edges; L_0 = 1 - sum xi.
Nodes<10> quadratic_tetrahedron(const Eigen::Vector4d& l) {
  static constexpr int edge[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  Nodes<4> by_parent;
  by_parent << -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  Nodes<10> slope;
  for (int i = 0; i < 4; ++i) slope.row(i) = (4 * l[i] - 1) * by_parent.row(i);
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = edge[e];
    slope.row(4 + e) = 4 * (l[i] * by_parent.row(j) + l[j] * by_parent.row(i));
  }
  return slope;
}

/// dN/dxi of the linear prism: N_i = L_i (1 - z) / 2 below, L_i (1 + z) / 2 above; L_0 = 1 - x - y, -1 <= z <= 1.
Nodes<6> linear_prism(double x, double y, double z) {
  const Vec3 l(1 - x - y, x, y);
  Eigen::Matrix<double, 3, 2> by_plane;
  by_plane << -1, -1, 1, 0, 0, 1;
  Nodes<6> slope;
  slope.topLeftCorner<3, 2>() = 0.5 * (1 - z) * by_plane;
  slope.bottomLeftCorner<3, 2>() = 0.5 * (1 + z) * by_plane;
  slope.block<3, 1>(0, 2) = -0.5 * l;
  slope.block<3, 1>(3, 2) = 0.5 * l;
  return slope;
}

}  // namespace

ElasticRest<4, 1> elastic_rest(const Eigen::Matrix<double, 4, 3>& rest) {
  Nodes<4> by_parent;
  by_parent << -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  ElasticRest<4, 1> result;
  set_point<4>(rest, by_parent, 1.0 / 6, result.slope[0], result.volume[0]);
  return result;
}

ElasticRest<10, 4> elastic_rest(const Eigen::Matrix<double, 10, 3>& rest) {
  const double near = (5 + 3 * std::sqrt(5.0)) / 20, far = (5 - std::sqrt(5.0)) / 20;
  ElasticRest<10, 4> result;
  for (int q = 0; q < 4; ++q) {
    Eigen::Vector4d l = Eigen::Vector4d::Constant(far);
    l[q] = near;
    set_point<10>(rest, quadratic_tetrahedron(l), 1.0 / 24, result.slope[q], result.volume[q]);
  }
  return result;
}

ElasticRest<6, 6> elastic_rest(const Eigen::Matrix<double, 6, 3>& rest) {
  static constexpr double in_plane[3][2] = {{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}};
  const double across = 1 / std::sqrt(3.0);
  ElasticRest<6, 6> result;
  for (int q = 0; q < 6; ++q) {
    const auto& [x, y] = in_plane[q % 3];
    set_point<6>(rest, linear_prism(x, y, q < 3 ? -across : across), 1.0 / 6, result.slope[q], result.volume[q]);
  }
  return result;
}

Mat3 layer_frame(const Eigen::Matrix<double, 6, 3>& rest) {
  const Eigen::Matrix<double, 6, 3>& p = rest;
  Vec3 normal = Vec3::Zero(), along = Vec3::Zero();
  for (int t = 0; t < 6; t += 3) {
    const Vec3 side = (p.row(t + 1) - p.row(t)).transpose();
    normal += side.cross((p.row(t + 2) - p.row(t)).transpose());
    along += side;
  }
  const double area = normal.norm();
  if (!(area > 0) || !std::isfinite(area)) throw InvalidInput(place(p.row(0)) + "its triangles span no area");
  normal /= area;
  const Vec3 up = (p.bottomRows<3>() - p.topRows<3>()).colwise().sum().transpose();
  if (up.dot(normal) < 0) normal = -normal;
  Mat3 frame;
  frame.col(0) = (along - along.dot(normal) * normal).normalized();
  frame.col(1) = normal.cross(frame.col(0));
  frame.col(2) = normal;
  return frame;
}

void refuse_law(Law law) {
  throw InvalidInput("elastic law " + std::to_string(static_cast<int>(law)) + ": there is no such law");
}

}  // namespace softkin::energy
