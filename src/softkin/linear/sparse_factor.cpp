#include <algorithm>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/linear/ordering.hpp>
#include <softkin/linear/sparse_factor.hpp>
#include <softkin/linear/sparse_ldlt.hpp>
#include <thread>

namespace softkin::linear {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// The lower triangle in an order of elimination: its pattern, a node per row, and its values.
BlockColumns in_order(const Matrix& matrix, const Ordering& ordering, LargeVector<double>& values) {
  const Index n = static_cast<Index>(ordering.order.size());
  std::vector<Index> place(static_cast<std::size_t>(n));
  for (Index k = 0; k < n; ++k) place[ordering.order[k]] = k;
  std::vector<std::vector<std::pair<Index, double>>> columns(static_cast<std::size_t>(n));
  for (Index column = 0; column < n; ++column)
    for (Matrix::InnerIterator it(matrix, column); it; ++it) {
      if (it.row() < column) continue;
      const auto [first, last] = std::minmax(place[column], place[it.row()]);
      columns[first].emplace_back(last, it.value());
    }
  BlockColumns pattern;
  for (Index k = 0; k < n; ++k) {
    std::sort(columns[k].begin(), columns[k].end());
    for (const auto& [row, value] : columns[k]) {
      pattern.rows.push_back(row);
      values.push_back(value);
      pattern.offsets.push_back(static_cast<std::int64_t>(values.size()));
    }
    pattern.starts.push_back(static_cast<Index>(pattern.rows.size()));
    pattern.unknowns.push_back(k + 1);
  }
  pattern.pieces = ordering.pieces;
  return pattern;
}

}  // namespace

SparseFactor::SparseFactor(const Matrix& matrix, const std::vector<Index>& order) {
  Ordering ordering = order.empty() ? nested_dissection(matrix) : postordered(matrix, order);
  LargeVector<double> values;
  const auto tree =
      std::make_shared<const FrontTree>(make_front_tree(in_order(matrix, ordering, values), Fill::for_solves));
  order_ = std::move(ordering.order);
  top_ = ordering.pieces.back();

  SparseLdlt ldlt(tree);
  Team team(static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
  if (ldlt.factorise(values, std::numeric_limits<double>::min(), team).negative > 0)
    throw InvalidInput("the system matrix is not positive definite: some part of the robot is not held");
  for (const double pivot : ldlt.diagonal()) inverse_diagonal_.push_back(1 / pivot);
  piece_nodes_.assign(tree->pieces.begin(), tree->pieces.end() - 1);
  rows_ = tree->rows;
  for (const Front& front : tree->fronts) add_supernode(front, ldlt.lower().data() + front.first_value);
}

/// lower: the front's columns of L
void SparseFactor::add_supernode(const Front& front, const double* lower) {
  const Supernode node{front.begin, front.end,   front.first_row,
                       0,           front.below, static_cast<std::int64_t>(values_.size())};
  const Index width = node.width();
  for (Index r = 1; r < front.size(); ++r)
    for (Index c = 0; c < std::min(r, width); ++c)
      values_.push_back(lower[static_cast<std::int64_t>(c) * front.size() + r]);
  nodes_.push_back(node);
  const Index* rows = rows_.data() + node.first_row;
  nodes_.back().inner_rows = static_cast<Index>(std::lower_bound(rows, rows + node.row_count, top_) - rows);
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
