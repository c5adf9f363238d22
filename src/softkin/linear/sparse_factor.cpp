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
  const Index n = ordering.order.size();
  std::vector<Index> place(n);
  for (Index k = 0; k < n; ++k) place[ordering.order[k]] = k;
  std::vector<std::vector<std::pair<Index, double>>> columns(n);
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
    pattern.starts.push_back(pattern.rows.size());
    pattern.unknowns.push_back(k + 1);
  }
  pattern.pieces = ordering.pieces;
  return pattern;
}

void forward(const SupernodeColumns& node, double* rows, double* above) {
  SOFTKIN_RUN_KERNEL(forward_supernode(node, rows, above));
}
void backward(const SupernodeColumns& node, double* rows) {
  SOFTKIN_RUN_KERNEL(backward_supernode(node, rows));
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
  for (std::size_t f = 0; f < tree->fronts.size(); ++f) add_supernode(tree->fronts[f], ldlt.lower(f));
}

void SparseFactor::add_supernode(const Front& front, const FrontColumns<double>& lower) {
  const Supernode node{front.begin, front.end,   front.first_row,
                       0,           front.below, static_cast<std::int64_t>(values_.size())};
  const Index width = node.width();
  for (Index r = 1; r < front.size(); ++r)
    for (Index c = 0; c < std::min(r, width); ++c)
      values_.push_back(lower.values[static_cast<std::int64_t>(c) * lower.stride + r]);
  nodes_.push_back(node);
  const Index* rows = rows_.data() + node.first_row;
  nodes_.back().inner_rows = std::lower_bound(rows, rows + node.row_count, top_) - rows;
}

SupernodeColumns SparseFactor::columns_of(const Supernode& node) const {
  return {node.begin,
          node.width(),
          node.row_count,
          node.inner_rows,
          top_,
          rows_.data() + node.first_row,
          values_.data() + node.first_value,
          values_.data() + node.first_below(),
          inverse_diagonal_.data() + node.begin};
}

void SparseFactor::solve(Points& right_side, Team& team) const {
  const Index n = size(), above_rows = n - top_, count = std::ssize(piece_nodes_) - 1;
  // four numbers a row: three coordinates and a spare
  LargeVector<double> rows(4 * static_cast<std::size_t>(n));
  std::vector<double> above(4 * static_cast<std::size_t>(count) * above_rows);
  for (Index k = 0; k < n; ++k) {
    for (int c = 0; c < 3; ++c) rows[4 * static_cast<std::size_t>(k) + c] = right_side(order_[k], c);
    rows[4 * static_cast<std::size_t>(k) + 3] = 0;
  }

  team.each(count, [&](Index i) {
    double* own = above.data() + 4 * static_cast<std::size_t>(i) * above_rows;
    for (Index s = piece_nodes_[i]; s < piece_nodes_[i + 1]; ++s) forward(columns_of(nodes_[s]), rows.data(), own);
  });
  for (Index i = 0; i < count; ++i)
    for (Index k = 0; k < 4 * above_rows; ++k)
      rows[4 * static_cast<std::size_t>(top_) + k] += above[4 * static_cast<std::size_t>(i) * above_rows + k];
  const Index first_of_top = piece_nodes_.back(), end = nodes_.size();
  for (Index s = first_of_top; s < end; ++s)
    forward(columns_of(nodes_[s]), rows.data(), rows.data() + 4 * static_cast<std::size_t>(top_));
  for (Index s = end - 1; s >= first_of_top; --s) backward(columns_of(nodes_[s]), rows.data());
  team.each(count, [&](Index i) {
    for (Index s = piece_nodes_[i + 1] - 1; s >= piece_nodes_[i]; --s) backward(columns_of(nodes_[s]), rows.data());
  });

  for (Index k = 0; k < n; ++k)
    for (int c = 0; c < 3; ++c) right_side(order_[k], c) = rows[4 * static_cast<std::size_t>(k) + c];
}

}  // namespace softkin::linear
