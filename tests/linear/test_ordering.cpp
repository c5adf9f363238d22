#include <gtest/gtest.h>

#include <softkin/linear/ordering.hpp>
#include <thread>

namespace softkin::linear {

namespace {

/// A square grid of nodes, each linked to the two after it.
Eigen::SparseMatrix<double> grid_matrix(Index side) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < side * side; ++i) {
    entries.emplace_back(i, i, 1.0);
    if (i % side + 1 < side) entries.emplace_back(i + 1, i, 1.0);
    if (i + side < side * side) entries.emplace_back(i + side, i, 1.0);
  }
  Eigen::SparseMatrix<double> matrix(side * side, side * side);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

TEST(Ordering, ThreadsThatOrderAtOnceGetWhatOneAloneGets) {
  const Eigen::SparseMatrix<double> matrix = grid_matrix(40);
  const std::vector<Index> alone = nested_dissection(matrix).order;
  std::vector<int> others(4, 0);
  std::vector<std::thread> threads;
  for (int& count : others)
    threads.emplace_back([&] {
      for (int again = 0; again < 25; ++again) count += nested_dissection(matrix).order != alone;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(others, std::vector<int>(4, 0));
}

}  // namespace softkin::linear
