#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <softkin/core/types.hpp>
#include <softkin/energy/turn_response.hpp>

namespace softkin::energy {

TEST(TurnResponse, IsTheInverseWithRaisedEigenvalues) {
  for (int round = 0; round < 100; ++round) {
    const Mat3 a = Mat3::Random(), b = Mat3::Random();
    const Mat3 stiffness = a + a.transpose(), metric = b * b.transpose() + 0.05 * Mat3::Identity();
    const auto packed = [](const Mat3& m) {
      Pack33 p;
      for (int i = 0; i < 3; ++i) p.row[i] = {pack(m(i, 0)), pack(m(i, 1)), pack(m(i, 2))};
      return p;
    };
    const Eigen::GeneralizedSelfAdjointEigenSolver<Mat3> eigen(stiffness, metric);
    const Mat3 expected = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.5).cwiseInverse().asDiagonal() *
                          eigen.eigenvectors().transpose();
    const Pack33 found = turn_response(packed(stiffness), packed(metric), pack(0.5));
    const Pack33 inverse = turn_response(packed(metric));
    for (int i = 0; i < 3; ++i) {
      const Vec3 row(found.row[i].x[3], found.row[i].y[3], found.row[i].z[3]);
      EXPECT_LT((row.transpose() - expected.row(i)).norm(), 1e-9 * expected.norm());
      const Vec3 plain(inverse.row[i].x[3], inverse.row[i].y[3], inverse.row[i].z[3]);
      EXPECT_LT((plain.transpose() * metric - Mat3::Identity().row(i)).norm(), 1e-9);
    }
  }
}

}  // namespace softkin::energy
