#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <random>
#include <softkin/energy/rotation.hpp>

namespace softkin::energy {

namespace {

/// Kabsch: the proper rotation that maximises tr(R^T H), from the singular value decomposition.
Mat3 kabsch(const Mat3& h) {
  const Eigen::JacobiSVD<Mat3> svd(h, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 sign = Mat3::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

Pack33 pack_of(const std::vector<Mat3>& matrices) {
  Pack33 packed;
  for (int i = 0; i < 3; ++i)
    for (int l = 0; l < lanes; ++l) {
      packed.row[i].x[l] = matrices[l](i, 0);
      packed.row[i].y[l] = matrices[l](i, 1);
      packed.row[i].z[l] = matrices[l](i, 2);
    }
  return packed;
}

Mat3 lane_of(const Pack33& packed, int l) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) m.row(i) << packed.row[i].x[l], packed.row[i].y[l], packed.row[i].z[l];
  return m;
}

std::vector<Mat3> solve(const std::vector<Mat3>& h, PackRotation& start) {
  best_rotation(pack_of(h), start);
  const Pack33 r = to_matrix(start);
  std::vector<Mat3> result;
  for (int l = 0; l < lanes; ++l) result.push_back(lane_of(r, l));
  return result;
}

class Random {
 public:
  double normal() { return distribution_(engine_); }
  Mat3 matrix() {
    return Mat3::NullaryExpr([&] { return normal(); });
  }
  Mat3 rotation() { return Eigen::Quaterniond(normal(), normal(), normal(), normal()).normalized().toRotationMatrix(); }

 private:
  std::mt19937 engine_{7};
  std::normal_distribution<double> distribution_;
};

void expect_best(const Mat3& r, const Mat3& h) {
  EXPECT_NEAR((r.transpose() * r - Mat3::Identity()).norm(), 0, 1e-12);
  EXPECT_NEAR(r.determinant(), 1, 1e-12);
  EXPECT_NEAR((r.transpose() * h).trace(), (kabsch(h).transpose() * h).trace(), 1e-12 * (1 + h.norm()));
}

}  // namespace

TEST(Rotation, AgreesWithSvdForProperInvertedAndFlatShapesFromAnyStart) {
  Random random;
  for (int round = 0; round < 500; ++round) {
    std::vector<Mat3> h;
    for (int l = 0; l < lanes; ++l) {
      Mat3 m = random.matrix();
      if (l % 4 == 1) m.col(2) = m.col(0) - m.col(1);                         // rank 2
      if (l % 4 == 2) m *= 1e-8;                                              // tiny
      if (l % 4 == 3) m = -random.rotation() * Vec3(3, 2, 0.5).asDiagonal();  // mirrored
      h.push_back(m);
    }
    PackRotation start;
    if (round % 2) {
      for (int l = 0; l < lanes; ++l) {
        const Eigen::Quaterniond q(random.rotation());
        start.w[l] = q.w(), start.x[l] = q.x(), start.y[l] = q.y(), start.z[l] = q.z();
      }
    }
    const std::vector<Mat3> r = solve(h, start);
    for (int l = 0; l < lanes; ++l) {
      expect_best(r[l], h[l]);
      const Eigen::JacobiSVD<Mat3> svd(h[l]);
      const Vec3 s = svd.singularValues();
      if (s[1] - (h[l].determinant() < 0 ? s[2] : 0) > 0.05 * s[0]) {  // unique
        EXPECT_NEAR((r[l] - kabsch(h[l])).norm(), 0, 1e-9) << h[l];
      }
    }
  }
}

TEST(Rotation, WarmStartNearTheAnswerIsExact) {
  Random random;
  for (int round = 0; round < 200; ++round) {
    std::vector<Mat3> h(lanes);
    PackRotation start;
    for (int l = 0; l < lanes; ++l) {
      const Mat3 r = random.rotation();
      const Mat3 stretch = Mat3::Identity() + 0.1 * random.matrix();
      h[l] = r * stretch * stretch.transpose();
      const Eigen::Quaterniond q(r * Eigen::AngleAxisd(0.1 * random.normal(), Vec3::UnitX()));
      start.w[l] = q.w(), start.x[l] = q.x(), start.y[l] = q.y(), start.z[l] = q.z();
    }
    const std::vector<Mat3> r = solve(h, start);
    for (int l = 0; l < lanes; ++l) EXPECT_NEAR((r[l] - kabsch(h[l])).norm(), 0, 1e-12);
  }
}

TEST(Rotation, WhereItIsNotUniqueItIsStillARotation) {
  const Mat3 turned = Eigen::AngleAxisd(1.0, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Mat3> h(lanes, Mat3::Zero());
  h[1] = -Mat3::Identity();                          // mirrored ball: every half turn is best
  h[2] = Vec3(1, 0, 0) * Vec3(1, 0, 0).transpose();  // a line: any turn about it
  h[3] = -turned;
  h[4] = 1e-300 * turned;
  PackRotation start;
  const std::vector<Mat3> r = solve(h, start);
  for (int l = 0; l < lanes; ++l) expect_best(r[l], h[l]);
}

TEST(Rotation, SingleMatrixAgreesWithSvd) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    const Mat3 h = random.matrix();
    EXPECT_NEAR((best_rotation(h) - kabsch(h)).norm(), 0, 1e-7) << h;
  }
}

}  // namespace softkin::energy
