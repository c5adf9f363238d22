#include <Eigen/SparseCholesky>
#include <softkin/core/error.hpp>
#include <softkin/statics/ordering.hpp>
#include <softkin/statics/sparse_factor.hpp>

namespace softkin {

SparseFactor::SparseFactor(const Eigen::SparseMatrix<double>& matrix) {
  Ordering ordering = nested_dissection(matrix);
  order_ = std::move(ordering.order);
  pieces_ = std::move(ordering.pieces);

  const Index n = size();
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> permutation(n);
  for (Index k = 0; k < n; ++k) permutation.indices()[order_[k]] = k;
  Eigen::SparseMatrix<double> permuted(n, n);
  permuted.selfadjointView<Eigen::Lower>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(permutation);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> ldlt(permuted);
  if (ldlt.info() != Eigen::Success || (n > 0 && !(ldlt.vectorD().minCoeff() > 0)))
    throw InvalidInput("the system matrix is not positive definite: some part of the robot is not held");

  const Eigen::SparseMatrix<double> lower = ldlt.matrixL();
  inverse_diagonal_.resize(n);
  starts_.reserve(n + 1);
  starts_.push_back(0);
  for (Index j = 0; j < n; ++j) {
    inverse_diagonal_[j] = 1 / ldlt.vectorD()[j];
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, j); it; ++it)
      if (it.row() != j) {
        rows_.push_back(static_cast<Index>(it.row()));
        values_.push_back(it.value());
      }
    starts_.push_back(static_cast<std::int64_t>(rows_.size()));
  }
}

void SparseFactor::forward(Row* rows, Row* above, Index begin, Index end, Index top) const {
  for (Index j = begin; j < end; ++j) {
    const Row x = rows[j];
    std::int64_t p = starts_[j];
    for (; p < starts_[j + 1] && rows_[p] < top; ++p)
      for (int c = 0; c < 4; ++c) rows[rows_[p]].c[c] -= values_[p] * x.c[c];
    for (; p < starts_[j + 1]; ++p)
      for (int c = 0; c < 4; ++c) above[rows_[p] - top].c[c] -= values_[p] * x.c[c];
  }
}

void SparseFactor::backward(Row* rows, Index begin, Index end) const {
  for (Index j = end - 1; j >= begin; --j) {
    Row x;
    for (int c = 0; c < 4; ++c) x.c[c] = rows[j].c[c] * inverse_diagonal_[j];
    for (std::int64_t p = starts_[j]; p < starts_[j + 1]; ++p)
      for (int c = 0; c < 4; ++c) x.c[c] -= values_[p] * rows[rows_[p]].c[c];
    rows[j] = x;
  }
}

void SparseFactor::solve(Points& right_side, Team& team) const {
  const Index n = size(), top = pieces_.back(), count = static_cast<Index>(pieces_.size()) - 1;
  std::vector<Row> rows(n), above(static_cast<std::size_t>(count) * (n - top), Row{});
  for (Index k = 0; k < n; ++k)
    rows[k] = {right_side(order_[k], 0), right_side(order_[k], 1), right_side(order_[k], 2), 0};

  team.each(count, [&](Index i) {
    forward(rows.data(), above.data() + static_cast<std::size_t>(i) * (n - top), pieces_[i], pieces_[i + 1], top);
  });
  for (Index i = 0; i < count; ++i)
    for (Index k = top; k < n; ++k)
      for (int c = 0; c < 4; ++c) rows[k].c[c] += above[static_cast<std::size_t>(i) * (n - top) + k - top].c[c];
  forward(rows.data(), nullptr, top, n, n);
  backward(rows.data(), top, n);
  team.each(count, [&](Index i) { backward(rows.data(), pieces_[i], pieces_[i + 1]); });

  for (Index k = 0; k < n; ++k)
    for (int c = 0; c < 3; ++c) right_side(order_[k], c) = rows[k].c[c];
}

}  // namespace softkin
