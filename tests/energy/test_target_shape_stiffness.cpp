#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <softkin/core/dense.hpp>
#include <softkin/energy/target_shape_stiffness.hpp>

namespace softkin::energy {

namespace {

template <int K>
using Rows = Eigen::Matrix<double, K, 3, Eigen::RowMajor>;
template <int K>
using Square = Eigen::Matrix<double, 3 * K, 3 * K>;
template <int K>
using Vector = Eigen::Matrix<double, 3 * K, 1>;

std::mt19937 engine(23);

template <int K>
Rows<K> random_rows(double size) {
  std::normal_distribution<double> normal(0, size);
  return Rows<K>::NullaryExpr([&] { return normal(engine); });
}

template <int K>
Rows<K> rest_shape() {
  Rows<K> p;
  if constexpr (K == 4)
    p << 2, 2, 2.1, -2, -1.8, 2, 2, -2, -2.3, -2, 2.2, -2;
  else if constexpr (K == 6)
    p << 0, 0, 0, 3, 0, 0, 0, 2, 0, 0.1, 0, 1.5, 3, 0.2, 1.4, 0, 2, 1.6;
  else
    p << 0, 0, 4, 5, 0, 4, 2, 0, 0;
  return p;
}

/// Lane l is scaled by 1 + 0.1 l: lanes must not be mixed up.
double lane_scale(int lane) {
  return 1 + 0.1 * lane;
}

template <int K>
void set(Shape<K>& shape, const Rows<K>& rows) {
  for (int l = 0; l < lanes; ++l)
    for (int i = 0; i < K; ++i) {
      shape[i].x[l] = lane_scale(l) * rows(i, 0);
      shape[i].y[l] = lane_scale(l) * rows(i, 1);
      shape[i].z[l] = lane_scale(l) * rows(i, 2);
    }
}

template <int K>
Vector<K> get(const Shape<K>& shape, int lane) {
  Vector<K> values;
  for (int i = 0; i < K; ++i) values.template segment<3>(3 * i) << shape[i].x[lane], shape[i].y[lane], shape[i].z[lane];
  return values;
}

template <int K>
Rows<K> centred(const Rows<K>& rows) {
  return rows.rowwise() - rows.colwise().mean().eval();
}

template <int K>
BodyBlock<K> body(double ratio) {
  BodyBlock<K> block;
  set<K>(block.rest, centred<K>(rest_shape<K>()));
  block.volume = volume(block.rest);
  block.weight = pack(1.7);
  block.shape_ratio = pack(ratio);
  block.shape_ratio[5] = 1;
  block.blended = ratio < 1;
  return block;
}

template <int K>
ActuationBlock<K> actuation() {
  TargetSplit<K> parts;
  if constexpr (K == 3) parts = split_cable(rest_shape<K>());
  if constexpr (K == 4) parts = split_pneumatic(rest_shape<K>());
  if constexpr (K == 6) parts = split_dea(rest_shape<K>());
  ActuationBlock<K> block;
  set<K>(block.constant, parts.constant);
  set<K>(block.grown, parts.grown);
  set<K>(block.thinned, parts.thinned);
  block.measure = pack(1);
  Shape<K> rest;
  set<K>(rest, rest_shape<K>());
  block.measure = current_ratio<K>(block, rest);
  block.weight = pack(1.7);
  return block;
}

/// The pull of one lane as a function of its vertices.
template <int K, class Pull>
Vector<K> difference(const Pull& pull, const Rows<K>& at, const Rows<K>& along, int lane) {
  const double h = 1e-5;
  return (pull(at + h * along, lane) - pull(at - h * along, lane)) / (2 * h);
}

template <int K>
struct Local {
  Shape<K> current;
  PackRotation rotation;
  ElementPull<K> out;
};

template <int K>
Local<K> local(const BodyBlock<K>& block, const Rows<K>& at) {
  Local<K> result;
  set<K>(result.current, at);
  pull_of_body<K>(block, result.current, result.rotation, result.out);
  return result;
}

template <int K>
Local<K> local(const ActuationBlock<K>& block, const Pack& ratio, const Rows<K>& at) {
  Local<K> result;
  set<K>(result.current, at);
  pull_of_actuation<K>(block, ratio, result.current, result.rotation, result.out);
  return result;
}

template <int K>
Square<K> matrix(const TargetStiffness<K>& stiffness, int lane) {
  Square<K> full;
  for (int i = 0, at = 0; i < K; ++i)
    for (int j = 0; j <= i; ++j, ++at) {
      Mat3 block;
      for (int r = 0; r < 3; ++r) {
        const Pack3& row = stiffness.block[at].row[r];
        block.row(r) << row.x[lane], row.y[lane], row.z[lane];
      }
      full.template block<3, 3>(3 * i, 3 * j) = block;
      full.template block<3, 3>(3 * j, 3 * i) = block.transpose();
    }
  return full;
}

/// What is left of a symmetric matrix without its negative eigenvalues.
template <int K>
Square<K> positive_part(const Square<K>& m) {
  const SymmetricEigen eigen = symmetric_eigen(m);
  return eigen.vectors * eigen.values.cwiseMax(0).asDiagonal() * eigen.vectors.transpose();
}

template <int K>
void expect_near(const Vector<K>& a, const Vector<K>& b, double tolerance) {
  EXPECT_LT((a - b).norm(), tolerance * (1 + a.norm()));
}

/// Sizes from crushed to three times as large: every branch of the soft target.
template <int K>
void check_body_change(double ratio) {
  const BodyBlock<K> block = body<K>(ratio);
  for (int round = 0; round < 40; ++round) {
    const double size = round < 10 ? 0.25 + 0.02 * round : 0.5 + 0.06 * round;
    const Rows<K> at = size * (rest_shape<K>() + random_rows<K>(0.2)), along = random_rows<K>(1);
    const Local<K> here = local<K>(block, at);
    Shape<K> change, out;
    set<K>(change, along);
    pull_change_of_body<K>(block, here.current, here.rotation, change, out);
    for (int l = 0; l < lanes; ++l)
      expect_near<K>(
          get<K>(out, l),
          difference<K>([&](const Rows<K>& x, int lane) { return get<K>(local<K>(block, x).out.pull, lane); }, at,
                        along, l),
          2e-7);
  }
}

template <int K>
void check_actuation_change() {
  const ActuationBlock<K> block = actuation<K>();
  for (int round = 0; round < 20; ++round) {
    const Rows<K> at = rest_shape<K>() + random_rows<K>(0.3), along = random_rows<K>(1);
    const Pack ratio = pack(0.5 + 0.1 * round);
    const double ratio_change = 0.3;
    const Local<K> here = local<K>(block, ratio, at);
    Shape<K> change, out;
    set<K>(change, along);
    pull_change_of_actuation<K>(block, ratio, pack(ratio_change), here.current, here.rotation, change, out);
    const double h = 1e-5;
    const Local<K> up = local<K>(block, ratio + h * ratio_change, at + h * along);
    const Local<K> down = local<K>(block, ratio - h * ratio_change, at - h * along);
    for (int l = 0; l < lanes; ++l)
      expect_near<K>(get<K>(out, l), (get<K>(up.out.pull, l) - get<K>(down.out.pull, l)) / (2 * h), 2e-7);
  }
}

template <int K>
void check_ratio_coupling() {
  const ActuationBlock<K> block = actuation<K>();
  const Rows<K> at = rest_shape<K>() + random_rows<K>(0.3), along = random_rows<K>(1);
  const Local<K> here = local<K>(block, pack(1.2), at);
  RatioCoupling<K> coupling;
  ratio_coupling<K>(block, pack(1.2), here.current, here.rotation, coupling);
  const double h = 1e-5;
  Shape<K> up, down, change;
  set<K>(up, at + h * along);
  set<K>(down, at - h * along);
  set<K>(change, along);
  const Pack slope = (current_ratio<K>(block, up) - current_ratio<K>(block, down)) / (2 * h);
  const Local<K> more = local<K>(block, pack(1.2 + h), at), less = local<K>(block, pack(1.2 - h), at);
  for (int l = 0; l < lanes; ++l) {
    EXPECT_NEAR(get<K>(coupling.ratio_slope, l).dot(get<K>(change, l)), slope[l], 1e-7);
    expect_near<K>(get<K>(coupling.pull_slope, l), (get<K>(more.out.pull, l) - get<K>(less.out.pull, l)) / (2 * h),
                   1e-7);
  }
}

/// The exact matrix times any change is minus the pull's change; the projected one is its positive part.
template <int K, class Stiffness, class Change>
int check_exact(const Stiffness& stiffness, const Change& pull_change) {
  int indefinite = 0;
  TargetStiffness<K> exact, projected;
  stiffness(false, exact);
  stiffness(true, projected);
  for (int round = 0; round < 3; ++round) {
    Shape<K> change, out;
    set<K>(change, random_rows<K>(1));
    pull_change(change, out);
    for (int l = 0; l < lanes; ++l) expect_near<K>(matrix<K>(exact, l) * get<K>(change, l), -get<K>(out, l), 1e-10);
  }
  for (int l = 0; l < lanes; ++l) {
    const Square<K> m = matrix<K>(exact, l), positive = positive_part<K>(m);
    EXPECT_LT((matrix<K>(projected, l) - positive).norm(), 1e-9 * (1 + m.norm()));
    indefinite += (m - positive).norm() > 1e-6;
  }
  return indefinite;
}

template <int K>
double min_eigenvalue(const Square<K>& m) {
  return symmetric_eigenvalues(m)[0];
}

}  // namespace

TEST(TargetShapeStiffness, VolumeSlopeIsTheDifferenceQuotient) {
  const auto check = []<int K>(std::integral_constant<int, K>) {
    const Rows<K> at = rest_shape<K>() + random_rows<K>(0.3), along = random_rows<K>(1);
    Shape<K> here, up, down, change, slope;
    set<K>(here, at);
    set<K>(change, along);
    set<K>(up, at + 1e-5 * along);
    set<K>(down, at - 1e-5 * along);
    volume_slope(here, slope);
    const Pack quotient = (volume(up) - volume(down)) / 2e-5;
    for (int l = 0; l < lanes; ++l) EXPECT_NEAR(get<K>(slope, l).dot(get<K>(change, l)), quotient[l], 1e-6);
  };
  check(std::integral_constant<int, 4>());
  check(std::integral_constant<int, 6>());
}

TEST(TargetShapeStiffness, BodyPullChangesAsTheDifferenceQuotientSays) {
  for (const double ratio : {1.0, 0.5, 0.14, 0.0}) {
    check_body_change<4>(ratio);
    check_body_change<6>(ratio);
  }
}

TEST(TargetShapeStiffness, ActuationPullChangesAsTheDifferenceQuotientSays) {
  check_actuation_change<3>();
  check_actuation_change<4>();
  check_actuation_change<6>();
}

TEST(TargetShapeStiffness, RatioCouplingIsTheDifferenceQuotient) {
  check_ratio_coupling<3>();
  check_ratio_coupling<4>();
  check_ratio_coupling<6>();
}

TEST(TargetShapeStiffness, ExactAndProjectedMatrixOfRigidTargets) {
  int indefinite = 0;
  const auto bodies = [&]<int K>(std::integral_constant<int, K>) {
    const BodyBlock<K> block = body<K>(1);
    for (int round = 0; round < 20; ++round) {
      const Local<K> here = local<K>(block, (0.5 + 0.05 * round) * (rest_shape<K>() + random_rows<K>(0.3)));
      indefinite += check_exact<K>(
          [&](bool projected, TargetStiffness<K>& out) {
            stiffness_of_body<K>(block, here.current, here.rotation, projected, out);
          },
          [&](const Shape<K>& change, Shape<K>& out) {
            pull_change_of_body<K>(block, here.current, here.rotation, change, out);
          });
    }
  };
  const auto actuations = [&]<int K>(std::integral_constant<int, K>) {
    const ActuationBlock<K> block = actuation<K>();
    for (int round = 0; round < 20; ++round) {
      const Pack ratio = pack(0.4 + 0.1 * round);
      const Local<K> here = local<K>(block, ratio, rest_shape<K>() + random_rows<K>(0.3));
      indefinite += check_exact<K>(
          [&](bool projected, TargetStiffness<K>& out) {
            stiffness_of_actuation<K>(block, ratio, false, here.current, here.rotation, projected, out);
          },
          [&](const Shape<K>& change, Shape<K>& out) {
            pull_change_of_actuation<K>(block, ratio, pack(0), here.current, here.rotation, change, out);
          });
    }
  };
  bodies(std::integral_constant<int, 4>());
  bodies(std::integral_constant<int, 6>());
  actuations(std::integral_constant<int, 3>());
  actuations(std::integral_constant<int, 4>());
  actuations(std::integral_constant<int, 6>());
  EXPECT_GT(indefinite, 100);  // there was something to project
}

/// At rest the preconditioner of a regular tetrahedron is the derivative itself, and elsewhere it is positive.
TEST(TargetShapeStiffness, MatrixOfBlendedTargetsIsPositiveAndNearTheDerivative) {
  const auto check = []<int K>(std::integral_constant<int, K>) {
    for (const double ratio : {0.5, 0.14, 0.0}) {
      const BodyBlock<K> block = body<K>(ratio);
      for (int round = 0; round < 30; ++round) {
        const Local<K> here = local<K>(block, (0.4 + 0.05 * round) * (rest_shape<K>() + random_rows<K>(0.3)));
        TargetStiffness<K> stiffness;
        stiffness_of_body<K>(block, here.current, here.rotation, true, stiffness);
        for (int l = 0; l < lanes; ++l) {
          const Square<K> m = matrix<K>(stiffness, l);
          EXPECT_GT(min_eigenvalue<K>(m), -1e-10 * m.norm());
        }
      }
    }
  };
  check(std::integral_constant<int, 4>());
  check(std::integral_constant<int, 6>());

  Rows<4> regular;
  regular << 1, 1, 1, -1, -1, 1, 1, -1, -1, -1, 1, -1;
  BodyBlock<4> block = body<4>(0.3);
  block.shape_ratio = pack(0.3);
  set<4>(block.rest, regular);
  block.volume = volume(block.rest);
  const Local<4> here = local<4>(block, regular);
  TargetStiffness<4> stiffness;
  stiffness_of_body<4>(block, here.current, here.rotation, false, stiffness);
  for (int column = 0; column < 12; ++column) {
    Rows<4> along = Rows<4>::Zero();
    along(column / 3, column % 3) = 1;
    Shape<4> change, out;
    set<4>(change, along);
    pull_change_of_body<4>(block, here.current, here.rotation, change, out);
    for (int l = 0; l < lanes; ++l) expect_near<4>(matrix<4>(stiffness, l) * get<4>(change, l), -get<4>(out, l), 1e-10);
  }
}

TEST(TargetShapeStiffness, MatrixOfRedistributedRatiosIsPositiveAndLeavesGrowthFree) {
  const auto check = []<int K>(std::integral_constant<int, K>) {
    const ActuationBlock<K> block = actuation<K>();
    for (int round = 0; round < 20; ++round) {
      const Pack ratio = pack(0.4 + 0.1 * round);
      const Local<K> here = local<K>(block, ratio, rest_shape<K>() + random_rows<K>(0.2));
      TargetStiffness<K> stiffness;
      stiffness_of_actuation<K>(block, ratio, true, here.current, here.rotation, false, stiffness);
      for (int l = 0; l < lanes; ++l) {
        const Square<K> m = matrix<K>(stiffness, l);
        EXPECT_GT(min_eigenvalue<K>(m), -1e-10 * m.norm());
      }
    }
  };
  check(std::integral_constant<int, 3>());
  check(std::integral_constant<int, 4>());
  check(std::integral_constant<int, 6>());
  const ActuationBlock<4> block = actuation<4>();
  const Rows<4> at = centred<4>(std::cbrt(1.5) * rest_shape<4>());
  const Local<4> here = local<4>(block, pack(1.5), at);
  TargetStiffness<4> stiffness;
  stiffness_of_actuation<4>(block, pack(1.5), true, here.current, here.rotation, false, stiffness);
  Shape<4> change;
  set<4>(change, at);
  for (int l = 0; l < lanes; ++l)
    EXPECT_LT((matrix<4>(stiffness, l) * get<4>(change, l)).norm(), 1e-10 * matrix<4>(stiffness, l).norm());
}

/// A rotation's tangent turns an element at rest instead of stretching it; small changes stay what they are.
TEST(TargetShapeStiffness, TurnedMovesBend) {
  const BodyBlock<4> block = body<4>(1);
  const Local<4> here = local<4>(block, rest_shape<4>());
  const Vec3 turn(0.3, -0.8, 1.1);
  const Rows<4> at = centred<4>(rest_shape<4>());
  Rows<4> along;
  for (int i = 0; i < 4; ++i) along.row(i) = turn.cross(Vec3(at.row(i).transpose())).transpose();
  Shape<4> change, out;
  set<4>(change, along);
  turned_move_of_body<4>(block, here.current, here.rotation, change, out);
  const double angle = 2 * std::atan(turn.norm() / 2);
  const Mat3 rotation = Eigen::AngleAxisd(angle, turn.normalized()).toRotationMatrix();
  Shape<4> expected;
  set<4>(expected, 1.7 * (at * rotation.transpose() - at));
  for (int l = 0; l < lanes; ++l) expect_near<4>(get<4>(out, l), get<4>(expected, l), 1e-12);

  const ActuationBlock<6> skin = actuation<6>();
  const Local<6> there = local<6>(skin, pack(1.3), rest_shape<6>() + random_rows<6>(0.2));
  const Rows<6> small = 1e-5 * centred<6>(random_rows<6>(1));
  Shape<6> little, moved;
  set<6>(little, small);
  turned_move_of_actuation<6>(skin, pack(1.3), there.current, there.rotation, little, moved);
  for (int l = 0; l < lanes; ++l) EXPECT_LT((get<6>(moved, l) - 1.7 * get<6>(little, l)).norm(), 1e-8);
}

TEST(TargetShapeStiffness, FlatAndVanishedElementsStayFinite) {
  for (const double ratio : {1.0, 0.5, 0.0})
    for (const int kind : {0, 1, 2}) {
      const BodyBlock<4> block = body<4>(ratio);
      Rows<4> at = rest_shape<4>();
      if (kind == 0) at.col(2).setZero();
      if (kind == 1) at.setZero();
      if (kind == 2) at.col(0) *= -1;
      const Local<4> here = local<4>(block, at);
      Shape<4> change, out;
      set<4>(change, random_rows<4>(1));
      pull_change_of_body<4>(block, here.current, here.rotation, change, out);
      for (const bool projected : {false, true}) {
        TargetStiffness<4> stiffness;
        stiffness_of_body<4>(block, here.current, here.rotation, projected, stiffness);
        for (int l = 0; l < lanes; ++l) {
          EXPECT_TRUE((get<4>(out, l).allFinite()));
          EXPECT_TRUE((matrix<4>(stiffness, l).allFinite()));
        }
      }
    }
}

}  // namespace softkin::energy
