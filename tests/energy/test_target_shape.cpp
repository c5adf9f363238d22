#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <random>
#include <softkin/energy/target_shape.hpp>

namespace softkin::energy {

namespace {

template <int K>
using Points_ = Eigen::Matrix<double, K, 3>;

std::mt19937 engine(11);

template <int K>
Points_<K> random_points(double size) {
  std::normal_distribution<double> normal(0, size);
  return Points_<K>::NullaryExpr([&] { return normal(engine); });
}

Points_<4> regular_tetrahedron() {
  Points_<4> p;
  p << 1, 1, 1, -1, -1, 1, 1, -1, -1, -1, 1, -1;
  return p;
}

template <int K>
Points_<K> base_shape() {
  if constexpr (K == 4) {
    return 2 * regular_tetrahedron() + random_points<4>(0.2);
  } else if constexpr (K == 6) {
    Points_<6> p;
    p << 0, 0, 0, 3, 0, 0, 0, 2, 0, 0.1, 0, 1.5, 3, 0.2, 1.4, 0, 2, 1.6;
    return p;
  } else {
    Points_<3> p;
    p << 0, 0, 4, 5, 0, 4, 2, 0, 0;
    return p;
  }
}

template <int K>
void set(Shape<K>& shape, const Points_<K>& points) {
  for (int i = 0; i < K; ++i) shape[i] = {pack(points(i, 0)), pack(points(i, 1)), pack(points(i, 2))};
}

template <int K>
Points_<K> get(const Shape<K>& shape, int lane = 0) {
  Points_<K> points;
  for (int i = 0; i < K; ++i) points.row(i) << shape[i].x[lane], shape[i].y[lane], shape[i].z[lane];
  return points;
}

template <int K>
Points_<K> centred(const Points_<K>& points) {
  return points.rowwise() - points.colwise().mean().eval();
}

double volume_of(const Points_<4>& p) {
  return Mat3(p.bottomRows<3>().rowwise() - p.row(0)).determinant() / 6;
}

template <int K>
BodyBlock<K> body(const Points_<K>& rest, double ratio, double weight) {
  BodyBlock<K> block;
  set<K>(block.rest, centred<K>(rest));
  Shape<K> shape;
  set<K>(shape, rest);
  block.volume = volume(shape);
  block.weight = pack(weight);
  block.shape_ratio = pack(ratio);
  block.blended = ratio < 1;
  return block;
}

template <int K>
struct Result {
  double energy;
  Points_<K> pull;
};

template <int K>
Result<K> evaluate(const BodyBlock<K>& block, const Points_<K>& current) {
  Shape<K> shape;
  set<K>(shape, current);
  PackRotation rotation;
  ElementPull<K> out;
  pull_of_body<K>(block, shape, rotation, out);
  return {out.energy[3], get<K>(out.pull, 3)};
}

template <int K>
TargetSplit<K> split(const Points_<K>& rest) {
  if constexpr (K == 3) return split_cable(rest);
  if constexpr (K == 4) return split_pneumatic(rest);
  if constexpr (K == 6) return split_dea(rest);
}

template <int K>
ActuationBlock<K> actuation(const Points_<K>& rest, double measure, double weight) {
  const TargetSplit<K> parts = split<K>(rest);
  ActuationBlock<K> block;
  set<K>(block.constant, parts.constant);
  set<K>(block.grown, parts.grown);
  set<K>(block.thinned, parts.thinned);
  block.measure = pack(measure);
  block.weight = pack(weight);
  return block;
}

template <int K>
Result<K> evaluate(const ActuationBlock<K>& block, const Points_<K>& current, double ratio) {
  Shape<K> shape;
  set<K>(shape, current);
  PackRotation rotation;
  ElementPull<K> out;
  pull_of_actuation<K>(block, pack(ratio), shape, rotation, out);
  return {out.energy[3], get<K>(out.pull, 3)};
}

/// The pull is minus half the gradient of the energy: the rotation is the best one, so its change costs nothing.
template <int K, class Energy>
void expect_gradient(const Points_<K>& at, const Points_<K>& pull, const Energy& energy) {
  const double h = 1e-5;
  for (int i = 0; i < K; ++i)
    for (int c = 0; c < 3; ++c) {
      Points_<K> up = at, down = at;
      up(i, c) += h;
      down(i, c) -= h;
      EXPECT_NEAR(-2 * pull(i, c), (energy(up) - energy(down)) / (2 * h), 1e-6 * (1 + std::abs(pull(i, c))));
    }
}

template <int K>
void check_body_gradient() {
  for (int round = 0; round < 20; ++round) {
    const Points_<K> rest = base_shape<K>();
    const BodyBlock<K> block = body<K>(rest, 1, 1.7);
    const Points_<K> current = rest + random_points<K>(0.3);
    expect_gradient<K>(current, evaluate<K>(block, current).pull,
                       [&](const Points_<K>& p) { return evaluate<K>(block, p).energy; });
  }
}

template <int K>
void check_actuation_gradient() {
  for (int round = 0; round < 20; ++round) {
    const Points_<K> rest = base_shape<K>();
    const ActuationBlock<K> block = actuation<K>(rest, 1, 1.7);
    const Points_<K> current = rest + random_points<K>(0.3);
    const double ratio = 0.6 + 0.05 * round;
    expect_gradient<K>(current, evaluate<K>(block, current, ratio).pull,
                       [&](const Points_<K>& p) { return evaluate<K>(block, p, ratio).energy; });
  }
}

/// Translation changes nothing; a rotation turns the pull; the target itself has no pull and no energy.
template <int K, class Evaluate>
void expect_invariant(const Points_<K>& current, const Evaluate& eval) {
  const Mat3 turn = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const Eigen::RowVector3d shift(30, -20, 10);
  const Result<K> here = eval(current), there = eval((current * turn.transpose()).rowwise() + shift);
  EXPECT_NEAR(here.energy, there.energy, 1e-10 * (1 + here.energy));
  EXPECT_NEAR((here.pull * turn.transpose() - there.pull).norm(), 0, 1e-10 * (1 + here.pull.norm()));
  EXPECT_NEAR(here.pull.colwise().sum().norm(), 0, 1e-12 * (1 + here.pull.norm()));
}

}  // namespace

TEST(TargetShape, BodyGradientIsTheDifferenceQuotient) {
  check_body_gradient<4>();
  check_body_gradient<6>();
}

TEST(TargetShape, ActuationGradientIsTheDifferenceQuotient) {
  check_actuation_gradient<3>();
  check_actuation_gradient<4>();
  check_actuation_gradient<6>();
}

TEST(TargetShape, InvariantUnderRigidMotion) {
  const Points_<4> t = base_shape<4>();
  const Points_<6> p = base_shape<6>();
  const Points_<3> c = base_shape<3>();
  for (const double ratio : {1.0, 0.4, 0.0}) {
    expect_invariant<4>(t + random_points<4>(0.3),
                        [&](const Points_<4>& x) { return evaluate<4>(body<4>(t, ratio, 2), x); });
    expect_invariant<6>(p + random_points<6>(0.3),
                        [&](const Points_<6>& x) { return evaluate<6>(body<6>(p, ratio, 2), x); });
  }
  expect_invariant<3>(c + random_points<3>(0.3),
                      [&](const Points_<3>& x) { return evaluate<3>(actuation<3>(c, 5, 2), x, 0.7); });
  expect_invariant<4>(t + random_points<4>(0.3),
                      [&](const Points_<4>& x) { return evaluate<4>(actuation<4>(t, 5, 2), x, 1.8); });
  expect_invariant<6>(p + random_points<6>(0.3),
                      [&](const Points_<6>& x) { return evaluate<6>(actuation<6>(p, 5, 2), x, 1.4); });
}

TEST(TargetShape, RestAndRotatedRestHaveNoPull) {
  const Points_<4> t = base_shape<4>();
  const Mat3 turn = Eigen::AngleAxisd(-2.8, Vec3(0, 1, 1).normalized()).toRotationMatrix();
  for (const double ratio : {1.0, 0.5, 0.0})
    EXPECT_NEAR(evaluate<4>(body<4>(t, ratio, 1), t * turn.transpose()).pull.norm(), 0, 1e-12);
}

TEST(TargetShape, BlendFollowsEquationFive) {
  const Points_<4> rest = base_shape<4>();
  const Points_<4> current = centred<4>(1.2 * rest + random_points<4>(0.2));
  const Eigen::JacobiSVD<Mat3> svd(current.transpose() * centred<4>(rest), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 r = svd.matrixU() * svd.matrixV().transpose();
  const double scale = std::cbrt(volume_of(rest) / volume_of(current));
  for (const double ratio : {0.0, 0.3, 1.0}) {
    const Points_<4> target = ratio * centred<4>(rest) * r.transpose() + (1 - ratio) * scale * current;
    const Result<4> result = evaluate<4>(body<4>(rest, ratio, 3), current);
    EXPECT_NEAR((result.pull - 3 * (target - current)).norm(), 0, 1e-10);
    EXPECT_NEAR(result.energy, 3 * (target - current).squaredNorm(), 1e-10);
  }
}

TEST(TargetShape, SoftElementResistsVolumeOnly) {
  const Points_<4> rest = base_shape<4>();
  const Mat3 shear = (Mat3() << 1, 0.4, 0, 0, 1, 0, 0, 0, 1).finished();
  EXPECT_NEAR(evaluate<4>(body<4>(rest, 0, 1), rest * shear).pull.norm(), 0, 1e-12);
  const Result<4> grown = evaluate<4>(body<4>(rest, 0, 1), 1.1 * rest);
  EXPECT_NEAR((grown.pull + 0.1 * centred<4>(rest)).norm(), 0, 1e-12);
}

TEST(TargetShape, InvertedSoftElementIsPulledBackToItsRestShape) {
  const Points_<4> rest = base_shape<4>();
  Points_<4> mirrored = rest;
  mirrored.col(0) *= -1;
  const Points_<4> soft = evaluate<4>(body<4>(rest, 0, 1), mirrored).pull;
  const Points_<4> stiff = evaluate<4>(body<4>(rest, 1, 1), mirrored).pull;
  EXPECT_GT(stiff.norm(), 0.1);
  EXPECT_NEAR((soft - stiff).norm(), 0, 1e-12);
  // flat: neither NaN nor infinity
  Points_<4> flat = rest;
  flat.col(2).setZero();
  EXPECT_TRUE(evaluate<4>(body<4>(rest, 0, 1), flat).pull.allFinite());
  EXPECT_TRUE((evaluate<4>(body<4>(rest, 0.5, 1), Points_<4>::Zero()).pull.allFinite()));
}

/// The closed form that the calibration starts from: a regular tetrahedron of shape ratio R is at small strain an
/// isotropic material with E proportional to 6R/(2+R) and nu = (1-R)/(2+R).
TEST(TargetShape, RegularTetrahedronIsIsotropic) {
  const Points_<4> rest = regular_tetrahedron();
  const auto stress = [&](double ratio, const Mat3& strain) {
    const double h = 1e-6;
    const auto virial = [&](double sign) {
      const Points_<4> x = rest * (Mat3::Identity() + sign * h * strain);
      return Mat3(-2 * evaluate<4>(body<4>(rest, ratio, 1), x).pull.transpose() * rest);
    };
    return Mat3((virial(1) - virial(-1)) / (2 * h));
  };
  const auto unit = [](int i, int j) {
    Mat3 e = Mat3::Zero();
    e(i, j) += 0.5;
    e(j, i) += 0.5;
    return e;
  };
  double e_1 = 0;
  for (const double r : {1.0, 0.5, 0.2, 0.1}) {
    const Mat3 along_x = stress(r, unit(0, 0));
    const double c_11 = along_x(0, 0), c_12 = along_x(1, 1);
    EXPECT_NEAR(along_x(2, 2), c_12, 1e-6);
    EXPECT_NEAR(stress(r, unit(0, 1))(0, 1), 0.5 * (c_11 - c_12), 1e-6);  // isotropic
    const double e = (c_11 - c_12) * (c_11 + 2 * c_12) / (c_11 + c_12);
    if (r == 1) e_1 = e;
    EXPECT_NEAR(e / e_1, 3 * r / (2 + r), 1e-7);
    EXPECT_NEAR(c_12 / (c_11 + c_12), (1 - r) / (2 + r), 1e-7);
  }
}

TEST(TargetShape, CableTargetShrinksTheEdgeAndKeepsTheApex) {
  Points_<3> rest;
  rest << 1, 2, 5, 5, 2, 5, 2, 2, 1;  // edge along x, foot of the apex at a quarter of it
  const TargetSplit<3> parts = split_cable(rest);
  const Points_<3> target = parts.constant + 0.5 * parts.grown;
  EXPECT_NEAR((target.row(1) - target.row(0)).norm(), 2, 1e-12);
  const Vec3 along = (target.row(1) - target.row(0)).normalized();
  const Vec3 to_apex = target.row(2) - target.row(0);
  EXPECT_NEAR(to_apex.dot(along), 0.5, 1e-12);                           // foot at a quarter of the shrunk edge
  EXPECT_NEAR((to_apex - to_apex.dot(along) * along).norm(), 4, 1e-12);  // its distance stays
  EXPECT_NEAR((parts.constant + parts.grown - centred<3>(rest)).norm(), 0, 1e-12);
}

TEST(TargetShape, DeaTargetScalesAreaAndKeepsVolume) {
  Points_<6> rest;  // a right prism: the volume is kept exactly
  rest << 0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0, 0.5, 3, 0, 0.5, 0, 2, 0.5;
  const Mat3 turn = Eigen::AngleAxisd(0.9, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  rest = rest * turn.transpose();
  const TargetSplit<6> parts = split_dea(rest);
  EXPECT_NEAR((parts.constant + parts.grown + parts.thinned - centred<6>(rest)).norm(), 0, 1e-12);
  const double ratio = 1.44;
  const Points_<6> target = parts.constant + std::sqrt(ratio) * parts.grown + parts.thinned / ratio;
  Shape<6> shape;
  set<6>(shape, target);
  EXPECT_NEAR(volume(shape)[0], 1.5, 1e-12);
  const Vec3 u = target.row(1) - target.row(0), v = target.row(2) - target.row(0);
  EXPECT_NEAR(0.5 * u.cross(v).norm(), 3 * ratio, 1e-12);
  EXPECT_NEAR(current_ratio<6>(actuation<6>(rest, 3, 1), shape)[5], ratio, 1e-12);
}

TEST(TargetShape, PneumaticTargetScalesVolume) {
  const Points_<4> rest = base_shape<4>();
  const ActuationBlock<4> block = actuation<4>(rest, volume_of(rest), 5);
  const Points_<4> grown = std::cbrt(1.7) * rest;
  EXPECT_NEAR(evaluate<4>(block, grown, 1.7).pull.norm(), 0, 1e-10);
  Shape<4> shape;
  set<4>(shape, grown);
  EXPECT_NEAR(current_ratio<4>(block, shape)[0], 1.7, 1e-12);
}

TEST(TargetShape, VolumesOfTetrahedronAndPrism) {
  Shape<4> t;
  const Points_<4> points = base_shape<4>();
  set<4>(t, points);
  EXPECT_NEAR(volume(t)[1], volume_of(points), 1e-12);
  Points_<6> unit;
  unit << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1;
  Shape<6> p;
  set<6>(p, unit);
  EXPECT_NEAR(volume(p)[0], 0.5, 1e-14);
  // twisted: against a fine Gauss-like sum of the linear prism's Jacobian
  const Points_<6> twisted = unit + random_points<6>(0.1);
  set<6>(p, twisted);
  double sum = 0;
  constexpr int n = 60;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      for (int c = 0; c < n; ++c) {
        const double r = (a + 0.5) / n, s = (b + 0.5) / n, z = (c + 0.5) / n;
        // the square onto the triangle: (r, s) -> (r, s (1 - r)), with the Jacobian 1 - r
        const double x = r, y = s * (1 - r);
        const Eigen::RowVector3d lower = twisted.row(0) * (1 - x - y) + twisted.row(1) * x + twisted.row(2) * y;
        const Eigen::RowVector3d upper = twisted.row(3) * (1 - x - y) + twisted.row(4) * x + twisted.row(5) * y;
        Mat3 j;
        j.row(0) = (twisted.row(1) - twisted.row(0)) * (1 - z) + (twisted.row(4) - twisted.row(3)) * z;
        j.row(1) = (twisted.row(2) - twisted.row(0)) * (1 - z) + (twisted.row(5) - twisted.row(3)) * z;
        j.row(2) = upper - lower;
        sum += j.determinant() * (1 - r) / (n * n * n);
      }
  EXPECT_NEAR(volume(p)[0], sum, 1e-4);
}

}  // namespace softkin::energy
