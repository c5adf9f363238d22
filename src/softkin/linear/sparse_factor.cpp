#include <Eigen/SparseCholesky>
#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/linear/ordering.hpp>
#include <softkin/linear/sparse_factor.hpp>

namespace softkin::linear {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

Index entries(const Matrix& lower, Index column) {
  return lower.outerIndexPtr()[column + 1] - lower.outerIndexPtr()[column];
}

/// First row below the diagonal: the column's parent in the elimination tree; -1 at a root.
Index parent(const Matrix& lower, Index column) {
  return entries(lower, column) > 1 ? lower.innerIndexPtr()[lower.outerIndexPtr()[column] + 1] : -1;
}

/// Last column + 1 of the supernode that starts at `begin`. A column joins its child where that fills up few zeros: the
/// rows of a parent contain its child's.
Index supernode_end(const Matrix& lower, Index begin, Index limit) {
  std::int64_t entered = entries(lower, begin);
  Index end = begin + 1;
  for (; end < limit && parent(lower, end - 1) == end; ++end) {
    const std::int64_t width = end + 1 - begin, height = entries(lower, end);
    const std::int64_t filled = width * height + width * (width - 1) / 2;
    entered += height;
    if (const std::int64_t zeros = filled - entered; zeros > 8 && 5 * zeros > filled) break;
  }
  return end;
}

}  // namespace

SparseFactor::SparseFactor(const Matrix& matrix, const std::vector<Index>& order) {
  Ordering ordering = order.empty() ? nested_dissection(matrix) : postordered(matrix, order);
  order_ = std::move(ordering.order);
  top_ = ordering.pieces.back();

  const Index n = size();
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> permutation(n);
  for (Index k = 0; k < n; ++k) permutation.indices()[order_[k]] = k;
  Matrix permuted(n, n);
  permuted.selfadjointView<Eigen::Lower>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(permutation);
  const Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> ldlt(permuted);
  if (ldlt.info() != Eigen::Success || (n > 0 && !(ldlt.vectorD().minCoeff() > 0)))
    throw InvalidInput("the system matrix is not positive definite: some part of the robot is not held");

  const Matrix lower = ldlt.matrixL();
  for (Index j = 0; j < n; ++j) inverse_diagonal_.push_back(1 / ldlt.vectorD()[j]);
  ordering.pieces.push_back(n);
  for (std::size_t p = 0; p + 1 < ordering.pieces.size(); ++p) {
    piece_nodes_.push_back(static_cast<Index>(nodes_.size()));
    for (Index begin = ordering.pieces[p]; begin < ordering.pieces[p + 1];) {
      const Index end = supernode_end(lower, begin, ordering.pieces[p + 1]);
      add_supernode(lower, begin, end);
      begin = end;
    }
  }
}

void SparseFactor::add_supernode(const Matrix& lower, Index begin, Index end) {
  Supernode node{begin,
                 end,
                 static_cast<std::int64_t>(rows_.size()),
                 0,
                 entries(lower, end - 1) - 1,
                 static_cast<std::int64_t>(values_.size())};
  for (Matrix::InnerIterator it(lower, end - 1); it; ++it) {
    if (it.row() == end - 1) continue;
    rows_.push_back(static_cast<Index>(it.row()));
    if (it.row() < top_) ++node.inner_rows;
  }
  const Index width = node.width();
  values_.resize(values_.size() + static_cast<std::size_t>(node.first_below() - node.first_value) +
                     static_cast<std::size_t>(width) * node.row_count,
                 0.0);
  for (Index c = 0; c < width; ++c)
    for (Matrix::InnerIterator it(lower, begin + c); it; ++it) {
      const Index row = static_cast<Index>(it.row());
      if (row == begin + c) continue;
      if (row < end) {
        const std::int64_t i = row - begin;
        values_[node.first_value + i * (i - 1) / 2 + c] = it.value();
      } else {
        const auto first = rows_.begin() + node.first_row;
        const std::int64_t r = std::lower_bound(first, rows_.end(), row) - first;
        values_[node.first_below() + r * width + c] = it.value();
      }
    }
  nodes_.push_back(node);
}

void SparseFactor::forward(const Supernode& node, Row* rows, Row* above) const {
  const Index width = node.width();
  Row* x = rows + node.begin;
  const double* p = values_.data() + node.first_value;
  for (Index i = 1; i < width; p += i, ++i)
    for (Index c = 0; c < i; ++c) x[i] -= p[c] * x[c];

  const Index* target = rows_.data() + node.first_row;
  const auto at = [&](Index r) -> Row& { return r < node.inner_rows ? rows[target[r]] : above[target[r] - top_]; };
  Index r = 0;
  for (; r + 4 <= node.row_count; r += 4, p += 4 * width) {  // four rows share the loads of x
    Row a{}, b{}, c{}, d{};
    for (Index k = 0; k < width; ++k) {
      a += p[k] * x[k];
      b += p[width + k] * x[k];
      c += p[2 * width + k] * x[k];
      d += p[3 * width + k] * x[k];
    }
    at(r) -= a;
    at(r + 1) -= b;
    at(r + 2) -= c;
    at(r + 3) -= d;
  }
  for (; r < node.row_count; ++r, p += width) {
    Row a{};
    for (Index k = 0; k < width; ++k) a += p[k] * x[k];
    at(r) -= a;
  }
}

void SparseFactor::backward(const Supernode& node, Row* rows) const {
  const Index width = node.width();
  Row* x = rows + node.begin;
  for (Index k = 0; k < width; ++k) x[k] *= inverse_diagonal_[node.begin + k];

  const Index* source = rows_.data() + node.first_row;
  const double* p = values_.data() + node.first_below();
  Index r = 0;
  for (; r + 4 <= node.row_count; r += 4, p += 4 * width) {
    const Row a = rows[source[r]], b = rows[source[r + 1]], c = rows[source[r + 2]], d = rows[source[r + 3]];
    for (Index k = 0; k < width; ++k) x[k] -= p[k] * a + p[width + k] * b + p[2 * width + k] * c + p[3 * width + k] * d;
  }
  for (; r < node.row_count; ++r, p += width)
    for (Index k = 0; k < width; ++k) x[k] -= p[k] * rows[source[r]];

  p = values_.data() + node.first_below();
  for (Index i = width - 1; i >= 1; --i) {
    p -= i;
    for (Index k = 0; k < i; ++k) x[k] -= p[k] * x[i];
  }
}

void SparseFactor::solve(Points& right_side, Team& team) const {
  const Index n = size(), above_rows = n - top_, count = static_cast<Index>(piece_nodes_.size()) - 1;
  std::vector<Row> rows(n), above(static_cast<std::size_t>(count) * above_rows, Row{});
  for (Index k = 0; k < n; ++k)
    rows[k] = Row{right_side(order_[k], 0), right_side(order_[k], 1), right_side(order_[k], 2), 0};

  team.each(count, [&](Index i) {
    Row* own = above.data() + static_cast<std::size_t>(i) * above_rows;
    for (Index s = piece_nodes_[i]; s < piece_nodes_[i + 1]; ++s) forward(nodes_[s], rows.data(), own);
  });
  for (Index i = 0; i < count; ++i)
    for (Index k = 0; k < above_rows; ++k) rows[top_ + k] += above[static_cast<std::size_t>(i) * above_rows + k];
  const Index first_of_top = piece_nodes_.back(), end = static_cast<Index>(nodes_.size());
  for (Index s = first_of_top; s < end; ++s) forward(nodes_[s], rows.data(), rows.data() + top_);
  for (Index s = end - 1; s >= first_of_top; --s) backward(nodes_[s], rows.data());
  team.each(count, [&](Index i) {
    for (Index s = piece_nodes_[i + 1] - 1; s >= piece_nodes_[i]; --s) backward(nodes_[s], rows.data());
  });

  for (Index k = 0; k < n; ++k)
    for (int c = 0; c < 3; ++c) right_side(order_[k], c) = rows[k][c];
}

}  // namespace softkin::linear
