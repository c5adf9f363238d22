#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <softkin/energy/bending.hpp>

/// Places and edges of sheets that bend: derivatives by differences, known curvatures and angles.

namespace softkin::energy {

namespace {

struct BentSample {
  std::mt19937 engine{5};
  std::uniform_real_distribution<double> any{-0.3, 0.3};

  template <int Columns>
  Eigen::Matrix<double, 3, Columns> shape() {
    Eigen::Matrix<double, 3, Columns> x = Eigen::Matrix<double, 3, Columns>::NullaryExpr([&] { return any(engine); });
    x(0, 0) += 1;
    x(1, 1) += 1;
    return x;
  }
  BendingPlace place() {
    BendingPlace place;
    const Mat3 root = Mat3::NullaryExpr([&] { return any(engine); });
    place.stiffness = root * root.transpose();
    place.rest = Vec3::NullaryExpr([&] { return any(engine); });
    return place;
  }
  static BendingJoint joint() {
    BendingJoint joint;
    joint.length = 0.7;
    joint.penalty = 2.1;
    joint.along = {0.6, 0.8};
    joint.upwards = {1, -1};
    joint.fraction = {0.3, 0.7};
    joint.moment = {0.05, -0.2};
    joint.angle = 0.1;
    return joint;
  }
};

/// response(x) of a vector of variables.
template <int N, class Response>
void expect_differences(const Eigen::Matrix<double, N, 1>& x, const Response& response) {
  constexpr double little = 1e-5;
  const BendingResponse<N> at = response(x, true);
  EXPECT_EQ(response(x, false).energy, at.energy);
  EXPECT_LT((response(x, false).gradient - at.gradient).norm(), 1e-14 * at.gradient.norm());
  for (int k = 0; k < N; ++k) {
    const auto step = [&](double by) { return response(x + by * Eigen::Matrix<double, N, 1>::Unit(k), false); };
    const auto high = step(little), low = step(-little);
    EXPECT_NEAR(at.gradient[k], (high.energy - low.energy) / (2 * little), 1e-8);
    EXPECT_LT((at.hessian.col(k) - (high.gradient - low.gradient) / (2 * little)).norm(), 1e-7);
  }
}

}  // namespace

TEST(Bending, DerivativesOfPlacesAreDifferences) {
  BentSample sample;
  for (int i = 0; i < 10; ++i) {
    const BendingPlace place = sample.place();
    expect_differences<15>(sample.shape<5>().reshaped(), [&](const auto& x, bool second) {
      return bend(place, SheetShape(x.reshaped(3, 5)), second);
    });
  }
}

TEST(Bending, DerivativesOfJointsAreDifferences) {
  BentSample sample;
  for (int i = 0; i < 10; ++i) {
    Eigen::Matrix<double, 18, 1> x;
    x << sample.shape<3>().reshaped(), sample.shape<3>().reshaped();
    expect_differences<18>(x, [&](const auto& all, bool second) {
      return bend(BentSample::joint(), SideShape(all.template head<9>().reshaped(3, 3)),
                  SideShape(all.template tail<9>().reshaped(3, 3)), second);
    });
  }
}

TEST(Bending, CurvatureIsThatOfACylinder) {
  constexpr double radius = 4, angle = 0.7;
  SheetShape shape;  // about y, x_1 along the circle
  shape.col(0) = Vec3(std::cos(angle), 0, std::sin(angle));
  shape.col(1) = Vec3(0, 1, 0);
  shape.col(2) = Vec3(-std::sin(angle), 0, std::cos(angle)) / radius;
  shape.col(3).setZero();
  shape.col(4).setZero();
  EXPECT_LT((curvature_of(shape) - Vec3(1 / radius, 0, 0)).norm(), 1e-15);
}

TEST(Bending, AnglesOfJointsAreThoseOfTheirPlanes) {
  BendingJoint joint;
  joint.along = {1, 0};
  SideShape flat = SideShape::Identity();
  for (const double slope : {0.3, -0.3, 1.5}) {  // beyond the edge, which runs along x, at y < 0
    SideShape tilted = flat;
    tilted.col(1) = Vec3(0, -std::cos(slope), std::sin(slope));
    joint.upwards = {1, -1};
    EXPECT_NEAR(joint_angle(joint, flat, tilted), slope, 1e-15);
  }
}

TEST(Bending, NothingChangesWithATurn) {
  BentSample sample;
  const Mat3 turn = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const BendingPlace place = sample.place();
  const SheetShape shape = sample.shape<5>();
  EXPECT_NEAR(bend(place, shape, false).energy, bend(place, turn * shape, false).energy, 1e-14);
  const SideShape one = sample.shape<3>(), two = sample.shape<3>();
  EXPECT_NEAR(bend(BentSample::joint(), one, two, false).energy,
              bend(BentSample::joint(), turn * one, turn * two, false).energy, 1e-14);
}

}  // namespace softkin::energy
