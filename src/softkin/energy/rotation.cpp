#include <Eigen/Geometry>
#include <softkin/core/dense.hpp>
#include <softkin/energy/rotation.hpp>

namespace softkin::energy {

void davenport(const double (&correlation)[9], double (&quaternion)[4]) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> h(correlation);
  Eigen::Matrix4d k;
  const Vec3 a(h(2, 1) - h(1, 2), h(0, 2) - h(2, 0), h(1, 0) - h(0, 1));
  k(0, 0) = h.trace();
  k.block<1, 3>(0, 1) = a.transpose();
  k.block<3, 1>(1, 0) = a;
  k.block<3, 3>(1, 1) = h + h.transpose() - h.trace() * Mat3::Identity();
  Eigen::Map<Eigen::Vector4d> q(quaternion);
  q = symmetric_eigen(k).vectors.col(3).normalized();
}

Mat3 best_rotation(const Mat3& correlation) {
  double h[9], q[4];
  for (int i = 0; i < 9; ++i) h[i] = correlation(i / 3, i % 3);
  davenport(h, q);
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

}  // namespace softkin::energy
