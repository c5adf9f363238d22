#pragma once

#include <Eigen/Core>
#include <softkin/core/index.hpp>

namespace softkin {

static_assert(EIGEN_MAX_ALIGN_BYTES == 64 && EIGEN_MAX_STATIC_ALIGN_BYTES == 64,
              "matrices of softkin are aligned otherwise: link the CMake target softkin::softkin");

/// A place, a direction or a force in space, a column.
using Vec3 = Eigen::Vector3d;
/// A rotation, a covariance or another 3 by 3 matrix.
using Mat3 = Eigen::Matrix3d;

/// A point a row, #V by 3 [mm].
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Of a point, from one to the other [mm].
[[nodiscard]] inline double largest_move(const Points& from, const Points& to) {
  return (to - from).rowwise().norm().maxCoeff();
}

}  // namespace softkin
