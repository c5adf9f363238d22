#pragma once

#include <Eigen/SparseCore>
#include <softkin/core/team.hpp>
#include <vector>

namespace softkin {

/// Cholesky factor of a symmetric positive definite matrix, made once and solved many times, the three coordinates
/// together. Independent subtrees of the elimination tree are solved on several threads; the result does not depend on
/// their number.
class SparseFactor {
 public:
  /// matrix: the lower triangle is read. throws InvalidInput where it is not positive definite
  explicit SparseFactor(const Eigen::SparseMatrix<double>& matrix);

  /// right_side, n x 3, becomes the solution.
  void solve(Points& right_side, Team& team) const;

  [[nodiscard]] Index size() const { return static_cast<Index>(order_.size()); }
  [[nodiscard]] std::int64_t nonzeros() const { return static_cast<std::int64_t>(values_.size()) + size(); }

 private:
  /// Three coordinates and a spare: one vector register.
  struct alignas(32) Row {
    double c[4];
  };
  void forward(Row* rows, Row* above, Index begin, Index end, Index top) const;
  void backward(Row* rows, Index begin, Index end) const;

  std::vector<Index> order_, pieces_;
  std::vector<std::int64_t> starts_;  // of each column of L, diagonal left out
  std::vector<Index> rows_;
  std::vector<double> values_, inverse_diagonal_;
};

}  // namespace softkin
