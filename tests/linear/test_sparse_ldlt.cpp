#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <set>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/linear/ordering.hpp>
#include <softkin/linear/sparse_ldlt.hpp>

namespace softkin::linear {

namespace {

using Links = std::vector<std::pair<Index, Index>>;

/// Neighbours in a grid of nx x ny x nz nodes, diagonals of the cells too.
Links grid_links(int nx, int ny, int nz) {
  Links links;
  const auto at = [&](int i, int j, int k) { return static_cast<Index>(i + nx * (j + ny * k)); };
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (int c = 1; c < 8; ++c) {
          const int x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2);
          if (x < nx && y < ny && z < nz) links.emplace_back(at(i, j, k), at(x, y, z));
        }
  return links;
}

/// A random symmetric block matrix in its elimination order, and the same one dense.
struct Symmetric {
  BlockColumns pattern;
  LargeVector<double> values;
  Eigen::MatrixXd dense;
};

void append_column(BlockColumns& pattern, Index column, const std::set<Index>& below) {
  std::vector<Index> rows{column};
  rows.insert(rows.end(), below.begin(), below.end());
  for (const Index row : rows) {
    pattern.rows.push_back(row);
    pattern.offsets.push_back(pattern.offsets.back() +
                              static_cast<std::int64_t>(pattern.width(row)) * pattern.width(column));
  }
  pattern.starts.push_back(static_cast<Index>(pattern.rows.size()));
}

BlockColumns ordered_pattern(const std::vector<Index>& widths, const Links& links) {
  const Index nodes = static_cast<Index>(widths.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (Index node = 0; node < nodes; ++node) entries.emplace_back(node, node, 1.0);
  for (const auto& [a, b] : links) entries.emplace_back(std::max(a, b), std::min(a, b), 1.0);
  Eigen::SparseMatrix<double> graph(nodes, nodes);
  graph.setFromTriplets(entries.begin(), entries.end());
  const Ordering ordering = nested_dissection(graph);
  std::vector<Index> place(static_cast<std::size_t>(nodes));
  BlockColumns pattern;
  pattern.pieces = ordering.pieces;
  for (Index k = 0; k < nodes; ++k) {
    place[ordering.order[k]] = k;
    pattern.unknowns.push_back(pattern.unknowns.back() + widths[ordering.order[k]]);
  }
  std::vector<std::set<Index>> below(static_cast<std::size_t>(nodes));
  for (const auto& [a, b] : links)
    if (a != b) below[std::min(place[a], place[b])].insert(std::max(place[a], place[b]));
  for (Index k = 0; k < nodes; ++k) append_column(pattern, k, below[k]);
  return pattern;
}

/// balance: added to the diagonal, times the sign that a random share of the unknowns has.
Symmetric make_sample(const std::vector<Index>& widths, const Links& links, double negative_share, unsigned seed) {
  Symmetric sample;
  sample.pattern = ordered_pattern(widths, links);
  const BlockColumns& p = sample.pattern;
  sample.values.resize(static_cast<std::size_t>(p.offsets.back()));
  sample.dense = Eigen::MatrixXd::Zero(p.size(), p.size());
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal(0, 0.2);
  std::uniform_real_distribution<double> uniform;
  for (Index j = 0; j < p.nodes(); ++j)
    for (Index e = p.starts[j]; e < p.starts[j + 1]; ++e) {
      const Index i = p.rows[e];
      Eigen::MatrixXd block = Eigen::MatrixXd::NullaryExpr(p.width(i), p.width(j), [&] { return normal(engine); });
      if (i == j) {
        block = (block + block.transpose()).eval();
        for (Index k = 0; k < p.width(j); ++k) block(k, k) += uniform(engine) < negative_share ? -6 : 6;
      }
      Eigen::Map<Eigen::MatrixXd>(sample.values.data() + p.offsets[e], p.width(i), p.width(j)) = block;
      sample.dense.block(p.unknowns[i], p.unknowns[j], p.width(i), p.width(j)) = block;
      sample.dense.block(p.unknowns[j], p.unknowns[i], p.width(j), p.width(i)) = block.transpose();
    }
  return sample;
}

std::vector<Index> mixed_widths(Index nodes, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_int_distribution<Index> width(1, 6);
  std::vector<Index> widths;
  for (Index i = 0; i < nodes; ++i) widths.push_back(width(engine));
  return widths;
}

Eigen::MatrixXd random_matrix(Index rows, Index columns) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

std::vector<Symmetric> samples(double negative_share) {
  Links apart = grid_links(5, 4, 1);
  for (const auto& [a, b] : grid_links(3, 3, 3)) apart.emplace_back(20 + a, 20 + b);
  Links star;  // a hub that touches all
  for (Index i = 1; i < 40; ++i) star.emplace_back(0, i);
  return {make_sample({1}, {}, negative_share, 1),
          make_sample({6}, {}, negative_share, 2),
          make_sample({3, 2}, {{0, 1}}, negative_share, 3),
          make_sample({3, 2, 5}, {}, negative_share, 4),  // diagonal
          make_sample(std::vector<Index>(60, 3), grid_links(60, 1, 1), negative_share, 5),
          make_sample(std::vector<Index>(180, 3), grid_links(9, 5, 4), negative_share, 6),
          make_sample(mixed_widths(180, 1), grid_links(9, 5, 4), negative_share, 7),
          make_sample(mixed_widths(47, 2), apart, negative_share, 8),
          make_sample(mixed_widths(40, 3), star, negative_share, 9)};
}

}  // namespace

TEST(SparseLdlt, SolvesAndCountsAsADenseFactorDoes) {
  Team alone(1);
  for (const double negative_share : {0.0, 0.3})
    for (const Symmetric& sample : samples(negative_share)) {
      SparseLdlt factor(sample.pattern);
      const SparseLdlt::Pivots pivots = factor.factorise(sample.values, 1e-12, alone);
      const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(sample.dense);
      EXPECT_EQ(pivots.negative, (eigenvalues.array() < 0).count());
      EXPECT_EQ(pivots.replaced, 0);
      for (const Index columns : {1, 2, 3, 4, 7}) {  // they are solved by fours
        const Eigen::MatrixXd right = random_matrix(sample.pattern.size(), columns);
        const Eigen::MatrixXd expected = sample.dense.ldlt().solve(right);
        Eigen::MatrixXd solution = right;
        factor.solve(solution, alone);
        EXPECT_LT((solution - expected).norm(), 1e-11 * expected.norm()) << columns;
      }
    }
}

/// Factorised again, nothing of the matrix before is left.
TEST(SparseLdlt, FactorisesAgain) {
  Team alone(1);
  const std::vector<Index> widths = mixed_widths(180, 1);
  const Symmetric first = make_sample(widths, grid_links(9, 5, 4), 0.3, 1),
                  second = make_sample(widths, grid_links(9, 5, 4), 0, 2);
  SparseLdlt used(first.pattern), fresh(first.pattern);
  (void)used.factorise(first.values, 1e-12, alone);
  EXPECT_EQ(used.factorise(second.values, 1e-12, alone).negative, 0);
  (void)fresh.factorise(second.values, 1e-12, alone);
  Eigen::MatrixXd a = random_matrix(first.pattern.size(), 2), b = a;
  used.solve(a, alone);
  fresh.solve(b, alone);
  EXPECT_EQ(a, b);
}

TEST(SparseLdlt, ResultDoesNotDependOnThreads) {
  const Symmetric sample = make_sample(mixed_widths(1500, 4), grid_links(25, 10, 6), 0.1, 11);
  ASSERT_GT(sample.pattern.pieces.size(), 1u);
  Team alone(1), pair(2), trio(3);
  const Eigen::MatrixXd right = random_matrix(sample.pattern.size(), 2);
  Eigen::MatrixXd one = right;
  SparseLdlt factor(sample.pattern);
  const SparseLdlt::Pivots pivots = factor.factorise(sample.values, 1e-12, alone);
  factor.solve(one, alone);
  EXPECT_LT((sample.dense * one - right).norm(), 1e-10 * right.norm());
  for (Team* team : {&pair, &trio}) {
    Eigen::MatrixXd more = right;
    SparseLdlt again(sample.pattern);
    EXPECT_EQ(again.factorise(sample.values, 1e-12, *team).negative, pivots.negative);
    again.solve(more, *team);
    EXPECT_EQ(one, more);
  }
}

/// A singular matrix: its pivot is replaced and counted, and solutions stay finite.
TEST(SparseLdlt, SmallPivotsAreReplaced) {
  Team alone(1);
  Symmetric sample = make_sample({2}, {}, 0, 5);
  std::fill(sample.values.begin(), sample.values.end(), 1.0);
  SparseLdlt factor(sample.pattern);
  const SparseLdlt::Pivots pivots = factor.factorise(sample.values, 1e-8, alone);
  EXPECT_EQ(pivots.replaced, 1);
  EXPECT_EQ(pivots.negative, 1);
  Eigen::MatrixXd x = random_matrix(2, 1);
  factor.solve(x, alone);
  EXPECT_TRUE(x.allFinite());
}

TEST(SparseLdlt, NothingToSolve) {
  Team alone(1);
  SparseLdlt factor{BlockColumns{}};
  EXPECT_EQ(factor.factorise({}, 1e-12, alone).negative, 0);
  Eigen::MatrixXd empty(0, 1);
  factor.solve(empty, alone);
}

TEST(SparseLdlt, AFactorThatDoesNotFitIsRefusedBeforeItIsBegun) {
  FrontTree tree = make_front_tree(BlockColumns{});
  EXPECT_NO_THROW(require_memory(tree));
  tree.values = std::int64_t{1} << 50;
  try {
    require_memory(tree);
    FAIL() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("takes 8388608.0 GiB of memory"), std::string::npos) << error.what();
  }
}

}  // namespace softkin::linear
