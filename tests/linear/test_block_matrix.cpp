#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <softkin/linear/block_matrix.hpp>

namespace softkin::linear {

namespace {

struct CliqueSample {
  Cliques cliques;
  LargeVector<double> slots;
  Eigen::MatrixXd dense;
};

/// Sets of 1 to 7 of the vertices, some of them several times, each with a random symmetric matrix.
CliqueSample random_cliques(Index vertices, int count, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<Index> pick(0, vertices - 1), size(1, std::min<Index>(7, vertices));
  CliqueSample sample;
  sample.dense = Eigen::MatrixXd::Zero(3 * vertices, 3 * vertices);
  for (int c = 0; c < count; ++c) {
    std::vector<Index> set;
    for (Index k = size(engine); k > 0;) {
      const Index v = pick(engine);
      if (std::find(set.begin(), set.end(), v) != set.end()) continue;
      set.push_back(v);
      --k;
    }
    sample.cliques.add(set);
    for (std::size_t a = 0; a < set.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        Eigen::Matrix3d block = Eigen::Matrix3d::NullaryExpr([&] { return normal(engine); });
        if (a == b) block = (block + block.transpose()).eval();
        for (int i = 0; i < 9; ++i) sample.slots.push_back(block(i / 3, i % 3));
        sample.dense.block<3, 3>(3 * set[a], 3 * set[b]) += block;
        if (a != b) sample.dense.block<3, 3>(3 * set[b], 3 * set[a]) += block.transpose();
      }
  }
  return sample;
}

Eigen::MatrixXd dense_of(const BlockPattern& pattern, const LargeVector<double>& blocks) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * pattern.vertices(), 3 * pattern.vertices());
  pattern.each([&](std::int64_t entry, Index row, Index column) {
    EXPECT_LE(column, row);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        dense(3 * row + r, 3 * column + c) = blocks[9 * entry + 3 * r + c];
        dense(3 * column + c, 3 * row + r) = blocks[9 * entry + 3 * r + c];
      }
  });
  return dense;
}

}  // namespace

TEST(BlockMatrix, GathersAndMultipliesAsADenseMatrixDoes) {
  Team alone(1), pair(2);
  for (const auto& [vertices, count] : {std::pair<Index, int>{1, 1}, {1, 3}, {6, 4}, {40, 60}, {200, 30}}) {
    const CliqueSample sample = random_cliques(vertices, count, static_cast<unsigned>(vertices + count));
    const BlockPattern pattern(vertices, sample.cliques);
    LargeVector<double> blocks, shared;
    pattern.gather(sample.slots, blocks, alone);
    pattern.gather(sample.slots, shared, pair);
    EXPECT_EQ(blocks, shared);
    ASSERT_EQ(static_cast<std::int64_t>(blocks.size()), 9 * pattern.entries());
    EXPECT_LT((dense_of(pattern, blocks) - sample.dense).norm(), 1e-13 * sample.dense.norm());

    std::mt19937 engine(1);
    std::normal_distribution<double> normal;
    const Points x = Points::NullaryExpr(vertices, 3, [&] { return normal(engine); });
    Points product, other;
    pattern.multiply(blocks, x, product, alone);
    pattern.multiply(blocks, x, other, pair);
    EXPECT_EQ(product, other);
    const Eigen::VectorXd expected = sample.dense * Eigen::Map<const Eigen::VectorXd>(x.data(), x.size());
    EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(product.data(), product.size()) - expected).norm(),
              1e-13 * expected.norm());
  }
}

TEST(BlockMatrix, VerticesOfNoCliqueHaveNoEntries) {
  Cliques cliques;
  cliques.add(std::vector<Index>{3, 1});
  const BlockPattern pattern(5, cliques);
  EXPECT_EQ(pattern.entries(), 3);
  Team alone(1);
  LargeVector<double> blocks;
  pattern.gather(LargeVector<double>(27, 1), blocks, alone);
  Points product;
  pattern.multiply(blocks, Points::Ones(5, 3), product, alone);
  EXPECT_TRUE(product.row(0).isZero(0));
  EXPECT_TRUE(product.row(2).isZero(0));
  EXPECT_TRUE(product.row(4).isZero(0));
  EXPECT_EQ(product(1, 0), 6);
}

TEST(BlockMatrix, NoVertexAtAll) {
  Team alone(1);
  const BlockPattern pattern(0, {});
  LargeVector<double> blocks;
  pattern.gather({}, blocks, alone);
  Points product;
  pattern.multiply(blocks, Points(0, 3), product, alone);
  EXPECT_EQ(product.rows(), 0);
}

}  // namespace softkin::linear
