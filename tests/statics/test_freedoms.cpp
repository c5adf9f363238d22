#include <Eigen/Geometry>
#include <set>
#include <softkin/energy/rotation.hpp>
#include <softkin/linear/sparse_ldlt.hpp>
#include <softkin/statics/supports/reduced_matrix.hpp>

#include "model/physical_robots.hpp"
#include "statics/robots.hpp"

namespace softkin {

namespace {

using namespace testing;
using namespace linear;

/// A block held at one end, with vertices that slide in a plane or along a line, and rigid regions: a free one, one
/// that is held along z, one held along y and z, and one that is held whole.
RobotSpec held_robot() {
  RobotSpec spec = physical_robot(block_mesh({8, 2, 2}, {80, 20, 20}));
  const auto rigid = [&](const std::string& name, const Vec3& low, const Vec3& high) {
    spec.rigid.push_back({{Box{low, high}, {}}, name});
  };
  const auto hold = [&](const Vec3& low, const Vec3& high, std::array<bool, 3> axes, const Vec3& displacement) {
    spec.fixed.push_back({{Box{low, high}, {}}, axes, displacement});
  };
  rigid("free", {70, 0, 0}, {80, 20, 20});
  rigid("plane", {50, 0, 0}, {60, 20, 20});
  rigid("line", {40, 0, 0}, {40, 20, 20});
  rigid("whole", {20, 0, 0}, {20, 20, 20});
  hold({50, 0, 0}, {60, 20, 0}, {false, false, true}, {0, 0, 1.5});
  hold({40, 0, 0}, {40, 20, 20}, {false, true, true}, {0, 0.5, -0.5});
  hold({20, 0, 0}, {20, 20, 20}, {true, true, true}, {1, -1, 0.5});
  hold({10, 0, 0}, {10, 20, 0}, {false, false, true}, {0, 0, 0.25});
  hold({30, 0, 0}, {30, 20, 0}, {true, false, true}, {0.5, 0, 0});
  return spec;
}

/// A model, a pattern that couples neighbours and distant vertices, and freedoms over it.
struct FreedomSample {
  explicit FreedomSample(const RobotSpec& spec) : model(compile(spec)) {
    for (const Tetrahedron& t : model.elements.tetrahedra) cliques.add(t);
    const Index n = model.rest.rows();
    cliques.add(std::vector<Index>{0, n - 1, n / 2, 3, n / 3});
    pattern.emplace(n, cliques);
    freedoms.emplace(model, *pattern);
    reduced.emplace(*freedoms, *pattern);
    positions = model.rest + noise(n, 1, 1);
    freedoms->hold(1, positions);
  }

  [[nodiscard]] Eigen::VectorXd random_unknowns(unsigned seed) const {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    return Eigen::VectorXd::NullaryExpr(freedoms->size(), [&] { return normal(engine); });
  }

  Model model;
  Cliques cliques;
  std::optional<BlockPattern> pattern;
  std::optional<supports::Freedoms> freedoms;
  std::optional<supports::ReducedMatrix> reduced;
  Points positions;
};

Eigen::Map<const Eigen::VectorXd> flat(const Points& points) {
  return {points.data(), points.size()};
}

/// T, column by column.
Eigen::MatrixXd tangent_of(const FreedomSample& sample) {
  Eigen::MatrixXd t(3 * sample.model.rest.rows(), sample.freedoms->size());
  Points moves;
  for (Index u = 0; u < t.cols(); ++u) {
    sample.freedoms->expand(Eigen::VectorXd::Unit(t.cols(), u), sample.positions, moves);
    t.col(u) = flat(moves);
  }
  return t;
}

Eigen::MatrixXd dense_of(const BlockColumns& columns, const LargeVector<double>& values) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(columns.size(), columns.size());
  for (Index j = 0; j < columns.nodes(); ++j)
    for (Index e = columns.starts[j]; e < columns.starts[j + 1]; ++e) {
      const Index i = columns.rows[e];
      const Eigen::Map<const Eigen::MatrixXd> block(values.data() + columns.offsets[e], columns.width(i),
                                                    columns.width(j));
      dense.block(columns.unknowns[i], columns.unknowns[j], block.rows(), block.cols()) = block;
      dense.block(columns.unknowns[j], columns.unknowns[i], block.cols(), block.rows()) = block.transpose();
    }
  return dense;
}

/// Random blocks for every clique, those on the diagonal symmetric; their sums over the pattern, and these as a matrix.
struct RandomMatrix {
  explicit RandomMatrix(const FreedomSample& sample)
      : slots(9 * static_cast<std::size_t>(sample.cliques.slots.back())) {
    std::mt19937 engine(4);
    std::normal_distribution<double> normal;
    for (Index c = 0; c < sample.cliques.count(); ++c) {
      std::int64_t slot = sample.cliques.slots[c];
      for (std::int64_t a = 0; slot < sample.cliques.slots[c + 1]; ++a)
        for (std::int64_t b = 0; b <= a; ++b, ++slot) {
          Mat3 block = Mat3::NullaryExpr([&] { return normal(engine); });
          if (a == b) block = (block + block.transpose()).eval();
          for (int i = 0; i < 9; ++i) slots[9 * slot + i] = block(i / 3, i % 3);
        }
    }
    Team alone(1);
    sample.pattern->gather(slots, blocks, alone);
    dense = Eigen::MatrixXd::Zero(3 * sample.pattern->vertices(), 3 * sample.pattern->vertices());
    sample.pattern->each([&](std::int64_t entry, Index row, Index column) {
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(blocks.data() + 9 * entry);
      dense.block<3, 3>(3 * row, 3 * column) = block;
      dense.block<3, 3>(3 * column, 3 * row) = block.transpose();
    });
  }

  LargeVector<double> slots, blocks;
  Eigen::MatrixXd dense;
};

}  // namespace

TEST(Freedoms, CountsWhatMayMove) {
  const FreedomSample sample(held_robot());
  Index expected = 6 + 3 + 1;  // regions: free, in a plane, along a line
  std::vector<bool> in_region(sample.model.held.fixed.size());
  for (const RigidRegion& region : sample.model.rigid)
    for (const Index v : region.vertices) in_region[v] = true;
  for (std::size_t v = 0; v < in_region.size(); ++v)
    for (int axis = 0; axis < 3; ++axis) expected += !in_region[v] && !sample.model.held.fixed[v][axis];
  EXPECT_EQ(sample.freedoms->size(), expected);
}

TEST(Freedoms, ExpandIsTheSlopeOfMoveAndReduceItsTranspose) {
  const FreedomSample sample(held_robot());
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Eigen::VectorXd unknowns = sample.random_unknowns(seed);
    Points high = sample.positions, low = sample.positions, moves;
    constexpr double reach = 1e-5;
    sample.freedoms->move(unknowns, reach, high);
    sample.freedoms->move(unknowns, -reach, low);
    sample.freedoms->expand(unknowns, sample.positions, moves);
    EXPECT_LT(((high - low) / (2 * reach) - moves).norm(), 1e-8 * moves.norm());
    const Points vectors = noise(moves.rows(), 1, seed + 50);
    Eigen::VectorXd reduced(sample.freedoms->size());
    sample.freedoms->reduce(vectors, sample.positions, reduced);
    EXPECT_NEAR(reduced.dot(unknowns), vectors.cwiseProduct(moves).sum(), 1e-10 * vectors.norm() * moves.norm());
  }
}

TEST(Freedoms, MovedFarRegionsKeepTheirShapeAndSupportsTheirPlace) {
  const FreedomSample sample(held_robot());
  Points moved = sample.positions;
  sample.freedoms->move(sample.random_unknowns(7), 2, moved);
  EXPECT_GT((moved - sample.positions).rowwise().norm().maxCoeff(), 2);
  for (const RigidRegion& region : sample.model.rigid)
    for (const Index a : region.vertices)
      for (const Index b : region.vertices)
        EXPECT_NEAR((moved.row(a) - moved.row(b)).norm(), (sample.model.rest.row(a) - sample.model.rest.row(b)).norm(),
                    1e-11);
  for (Index v = 0; v < moved.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (sample.model.held.fixed[v][axis]) {
        EXPECT_NEAR(moved(v, axis), sample.model.held.at(v, axis), 1e-11);
      }
}

TEST(Freedoms, ReducedMatrixIsTheDenseOne) {
  const FreedomSample sample(held_robot());
  const RandomMatrix matrix(sample);
  const Eigen::MatrixXd t = tangent_of(sample), expected = t.transpose() * matrix.dense * t;
  Team alone(1), pair(2);
  LargeVector<double> values, shared;
  const Points none = Points::Zero(sample.model.rest.rows(), 3);
  sample.reduced->reduce(*sample.pattern, matrix.slots, none, sample.positions, values, alone);
  sample.reduced->reduce(*sample.pattern, matrix.slots, none, sample.positions, shared, pair);
  EXPECT_EQ(values, shared);
  EXPECT_LT((dense_of(sample.reduced->columns(), values) - expected).norm(), 1e-12 * expected.norm());
}

/// Vertices that were far apart in the order of elimination become neighbours, with each other and with regions.
TEST(Freedoms, MatrixOfAWiderPatternIsTheDenseOne) {
  FreedomSample sample(held_robot());
  const Index n = sample.model.rest.rows();
  std::mt19937 engine(11);
  for (int i = 0; i < 30; ++i) {
    std::set<Index> set;
    while (set.size() < 4) set.insert(engine() % static_cast<unsigned>(n));
    sample.cliques.add(std::vector<Index>(set.begin(), set.end()));
  }
  sample.pattern.emplace(n, sample.cliques);
  const supports::ReducedMatrix wider = supports::ReducedMatrix::wider(*sample.freedoms, *sample.pattern);
  ASSERT_FALSE(wider.in_order());
  const RandomMatrix matrix(sample);
  const Eigen::MatrixXd t = tangent_of(sample), expected = t.transpose() * matrix.dense * t;
  Team alone(1);
  LargeVector<double> values;
  wider.reduce(*sample.pattern, matrix.slots, Points::Zero(n, 3), sample.positions, values, alone);
  const Eigen::MatrixXd in_columns = dense_of(wider.columns(), values);
  Eigen::MatrixXd half, whole(expected.rows(), expected.cols()), mine;  // P^T (P expected)^T, and back
  wider.to_columns(expected, half);
  wider.to_columns(half.transpose(), mine);
  EXPECT_LT((in_columns - mine).norm(), 1e-12 * expected.norm());
  wider.to_unknowns(half, whole);
  EXPECT_EQ(whole, expected);

  // and it can be factorised in that order
  SparseLdlt factor(wider.columns());
  ASSERT_EQ(factor.factorise(values, 1e-13, alone).replaced, 0);
  Eigen::MatrixXd right = sample.random_unknowns(3), solved;
  wider.to_columns(right, solved);
  factor.solve(solved, alone);
  wider.to_unknowns(solved, right);
  EXPECT_LT((expected * right - sample.random_unknowns(3)).norm(), 1e-6);
}

/// Along a straight line of unknowns regions turn about one axis: the derivative of u . T^T gradient there is u^T K u,
/// of which all of the symmetric K follows.
TEST(Freedoms, ReducedMatrixIsTheSlopeOfTheReducedGradient) {
  const FreedomSample sample(held_robot());
  const RandomMatrix hessian(sample);
  Team alone(1);
  const auto gradient_at = [&](const Points& positions) {
    Points gradient;
    sample.pattern->multiply(hessian.blocks, positions, gradient, alone);
    return gradient;
  };
  LargeVector<double> values;
  sample.reduced->reduce(*sample.pattern, hessian.slots, gradient_at(sample.positions), sample.positions, values,
                         alone);
  const Eigen::MatrixXd matrix = dense_of(sample.reduced->columns(), values);
  constexpr double reach = 1e-5;
  const auto slope_at = [&](const Eigen::VectorXd& unknowns, double scale) {
    Points moved = sample.positions;
    sample.freedoms->move(unknowns, scale, moved);
    Eigen::VectorXd reduced(sample.freedoms->size());
    sample.freedoms->reduce(gradient_at(moved), moved, reduced);
    return reduced.dot(unknowns);
  };
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Eigen::VectorXd unknowns = sample.random_unknowns(seed);
    const double change = (slope_at(unknowns, reach) - slope_at(unknowns, -reach)) / (2 * reach);
    EXPECT_NEAR(unknowns.dot(matrix * unknowns), change, 1e-7 * matrix.norm() * unknowns.squaredNorm());
  }
  // the turns alone, where the gradient counts
  Index turns = 0;
  for (Index node = 0; node < sample.reduced->columns().nodes(); ++node)
    if (sample.reduced->columns().width(node) == 6) turns = sample.reduced->columns().unknowns[node] + 3;
  ASSERT_GT(turns, 0);
  for (int i = 0; i < 6; ++i) {
    const Vec3 about = i < 3 ? Vec3(Vec3::Unit(i)) : Vec3(Vec3::Unit(i % 3) + Vec3::Unit((i + 1) % 3));
    Eigen::VectorXd unknowns = Eigen::VectorXd::Zero(matrix.rows());
    unknowns.segment<3>(turns) = about;
    const double change = (slope_at(unknowns, reach) - slope_at(unknowns, -reach)) / (2 * reach);
    EXPECT_NEAR(unknowns.dot(matrix * unknowns), change, 1e-6 * std::abs(change));
  }
}

TEST(Freedoms, HoldProjects) {
  const FreedomSample sample(held_robot());
  const Model& model = sample.model;
  for (const double fraction : {0.0, 0.4, 1.0}) {
    Points positions = model.rest + noise(model.rest.rows(), 2, 3);
    const Points before = positions;
    sample.freedoms->hold(fraction, positions);
    for (Index v = 0; v < positions.rows(); ++v)
      for (int axis = 0; axis < 3; ++axis)
        if (model.held.fixed[v][axis]) {
          EXPECT_NEAR(positions(v, axis),
                      model.rest(v, axis) + fraction * (model.held.at(v, axis) - model.rest(v, axis)), 1e-11);
        }
    for (const RigidRegion& region : model.rigid)
      for (const Index a : region.vertices)
        for (const Index b : region.vertices)
          ASSERT_NEAR((positions.row(a) - positions.row(b)).norm(), (model.rest.row(a) - model.rest.row(b)).norm(),
                      1e-11);
    Points again = positions;
    sample.freedoms->hold(fraction, again);
    EXPECT_LT((again - positions).norm(), 1e-10);
    // a region that nothing holds takes the pose that fits best: no small turn or shift fits better
    const RigidRegion& free = model.rigid[0];
    const auto misfit = [&](const Points& p) {
      double sum = 0;
      for (const Index v : free.vertices) sum += (p.row(v) - before.row(v)).squaredNorm();
      return sum;
    };
    for (unsigned seed = 1; seed <= 5; ++seed) {
      Points other = positions;
      sample.freedoms->move(sample.random_unknowns(seed), 1e-3, other);
      EXPECT_GT(misfit(other), misfit(positions));
    }
  }
}

}  // namespace softkin
