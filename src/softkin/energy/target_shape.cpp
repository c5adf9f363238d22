#include <Eigen/Geometry>
#include <softkin/energy/target_shape.hpp>

namespace softkin::energy {

TargetSplit<3> split_cable(const Eigen::Matrix<double, 3, 3>& rest) {
  const Eigen::Matrix<double, 3, 3> centred = rest.rowwise() - rest.colwise().mean();
  const Vec3 along = (rest.row(1) - rest.row(0)).normalized().transpose();
  TargetSplit<3> split;
  split.grown = centred * along * along.transpose();
  split.constant = centred - split.grown;
  split.thinned.setZero();
  return split;
}

TargetSplit<4> split_pneumatic(const Eigen::Matrix<double, 4, 3>& rest) {
  TargetSplit<4> split;
  split.grown = rest.rowwise() - rest.colwise().mean();
  split.constant.setZero();
  split.thinned.setZero();
  return split;
}

TargetSplit<6> split_dea(const Eigen::Matrix<double, 6, 3>& rest) {
  const Eigen::RowVector3d middle = rest.colwise().mean();
  TargetSplit<6> split;
  Vec3 normal = Vec3::Zero();
  for (int t = 0; t < 6; t += 3)
    normal += (rest.row(t + 1) - rest.row(t)).cross(rest.row(t + 2) - rest.row(t)).transpose();
  normal.normalize();
  for (int t = 0; t < 6; t += 3) {
    const Eigen::RowVector3d center = rest.middleRows<3>(t).colwise().mean();
    const Eigen::RowVector3d thickness = (center - middle).dot(normal) * normal.transpose();
    for (int i = t; i < t + 3; ++i) {
      split.grown.row(i) = rest.row(i) - center;
      split.thinned.row(i) = thickness;
      split.constant.row(i) = center - middle - thickness;
    }
  }
  return split;
}

}  // namespace softkin::energy
