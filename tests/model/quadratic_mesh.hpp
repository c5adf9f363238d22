#pragma once

#include <softkin/model/mesh/mesh_order.hpp>

#include "model/block_mesh.hpp"

namespace softkin::testing {

/// A quadratic map of space, which elements of order 2 follow exactly: (x + a x y, y + b y z, z + c z x).
struct Bend {
  double a = 0.06, b = -0.05, c = 0.04;

  [[nodiscard]] Vec3 operator()(const Vec3& p) const {
    return {p[0] + a * p[0] * p[1], p[1] + b * p[1] * p[2], p[2] + c * p[2] * p[0]};
  }
  [[nodiscard]] double determinant(const Vec3& p) const {
    return (1 + a * p[1]) * (1 + b * p[2]) * (1 + c * p[0]) + a * b * c * p[0] * p[1] * p[2];
  }

  /// Integral over the image of a box: of 1, and of the position. Gauss, exact to degree 5 in each coordinate.
  [[nodiscard]] std::pair<double, Vec3> moments(const Vec3& low, const Vec3& high) const {
    const double at[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)}, weight[3] = {5 / 9.0, 8 / 9.0, 5 / 9.0};
    double volume = 0;
    Vec3 first = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) {
          const Vec3 p = 0.5 * (low + high) + 0.5 * (high - low).cwiseProduct(Vec3(at[i], at[j], at[k]));
          const double dv = weight[i] * weight[j] * weight[k] * (high - low).prod() / 8 * determinant(p);
          volume += dv;
          first += dv * (*this)(p);
        }
    return {volume, first};
  }
};

/// A block of order 2 in its place (straight) or bent.
[[nodiscard]] inline Mesh quadratic_block(const std::array<int, 3>& cells, const Vec3& size) {
  return elevated(block_mesh(cells, size));
}

[[nodiscard]] inline Mesh bent(Mesh mesh, const Bend& bend = {}) {
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    mesh.vertices.row(v) = bend(mesh.vertices.row(v).transpose()).transpose();
  return mesh;
}

}  // namespace softkin::testing
