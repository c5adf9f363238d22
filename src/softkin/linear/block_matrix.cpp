#include <algorithm>
#include <numeric>
#include <softkin/linear/block_matrix.hpp>
#include <type_traits>

namespace softkin::linear {

void Cliques::add(std::span<const Index> set) {
  vertices.insert(vertices.end(), set.begin(), set.end());
  starts.push_back(static_cast<std::int64_t>(vertices.size()));
  const auto count = static_cast<std::int64_t>(set.size());
  slots.push_back(slots.back() + count * (count + 1) / 2);
}

std::uint64_t Cliques::fingerprint() const {
  std::uint64_t state = 0xcbf29ce484222325;
  const auto add = [&](std::int64_t number) { state = (state ^ static_cast<std::uint64_t>(number)) * 0x100000001b3; };
  for (const std::int64_t start : starts) add(start);
  for (const Index vertex : vertices) add(vertex);
  return state;
}

BlockPattern::BlockPattern(Index vertices, const Cliques& cliques) {
  // every slot once, with the row and the column that it falls into
  const auto each_slot = [&](const auto& visit) {
    for (Index c = 0; c < cliques.count(); ++c) {
      std::int64_t slot = cliques.slots[c];
      for (std::int64_t a = cliques.starts[c]; a < cliques.starts[c + 1]; ++a)
        for (std::int64_t b = cliques.starts[c]; b <= a; ++b, ++slot) {
          const Index i = cliques.vertices[a], j = cliques.vertices[b];
          visit(std::max(i, j), std::min(i, j), 2 * slot + (i < j));
        }
    }
  };
  std::vector<std::int64_t> row_starts(vertices + 1, 0);
  each_slot([&](Index row, Index, std::int64_t) { ++row_starts[row + 1]; });
  std::partial_sum(row_starts.begin(), row_starts.end(), row_starts.begin());
  std::vector<std::pair<Index, std::int64_t>> sorted(row_starts.back());
  std::vector<std::int64_t> next(row_starts.begin(), row_starts.end() - 1);
  each_slot([&](Index row, Index column, std::int64_t source) { sorted[next[row]++] = {column, source}; });

  starts_.push_back(0);
  sources_.reserve(sorted.size());
  for (Index v = 0; v < vertices; ++v) {
    std::sort(sorted.begin() + row_starts[v], sorted.begin() + row_starts[v + 1]);
    for (std::int64_t s = row_starts[v]; s < row_starts[v + 1]; ++s) {
      if (s == row_starts[v] || sorted[s].first != sorted[s - 1].first) {
        columns_.push_back(sorted[s].first);
        source_starts_.push_back(static_cast<std::int64_t>(sources_.size()));
      }
      sources_.push_back(sorted[s].second);
    }
    starts_.push_back(static_cast<std::int64_t>(columns_.size()));
  }
  source_starts_.push_back(static_cast<std::int64_t>(sources_.size()));

  across_starts_.assign(vertices + 1, 0);
  each([&](std::int64_t, Index row, Index column) { across_starts_[column + 1] += row != column; });
  std::partial_sum(across_starts_.begin(), across_starts_.end(), across_starts_.begin());
  across_.resize(across_starts_.back());
  next.assign(across_starts_.begin(), across_starts_.end() - 1);
  each([&](std::int64_t entry, Index row, Index column) {
    if (row != column) across_[next[column]++] = {entry, row};
  });
}

void BlockPattern::gather(const LargeVector<double>& slots, LargeVector<double>& blocks, Team& team) const {
  blocks.resize(9 * columns_.size());
  team.pieces(vertices(), [&](Index begin, Index end) {
    double block[9];
    for (std::int64_t e = starts_[begin]; e < starts_[end]; ++e) {
      sum(slots, e, block);
      std::copy(block, block + 9, blocks.data() + 9 * e);
    }
  });
}

void BlockPattern::multiply(const LargeVector<double>& blocks, const Points& x, Points& result, Team& team) const {
  result.resize(x.rows(), 3);
  team.pieces(vertices(), [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v) {
      double sum[3] = {};
      for (std::int64_t e = starts_[v]; e < starts_[v + 1]; ++e) {
        const double* b = blocks.data() + 9 * e;
        const double* p = x.data() + 3 * static_cast<std::ptrdiff_t>(columns_[e]);
        for (int r = 0; r < 3; ++r) sum[r] += b[3 * r] * p[0] + b[3 * r + 1] * p[1] + b[3 * r + 2] * p[2];
      }
      for (std::int64_t a = across_starts_[v]; a < across_starts_[v + 1]; ++a) {
        const double* b = blocks.data() + 9 * across_[a].first;
        const double* p = x.data() + 3 * static_cast<std::ptrdiff_t>(across_[a].second);
        for (int c = 0; c < 3; ++c) sum[c] += b[c] * p[0] + b[3 + c] * p[1] + b[6 + c] * p[2];
      }
      for (int r = 0; r < 3; ++r) result(v, r) = sum[r];
    }
  });
}

namespace {

/// row -= B x_column and column -= B^T x_row, for one column-major block. column: null on the diagonal
template <class Height, class Width>
void subtract_block(const double* block, Height height, Width width, const double* x_row, const double* x_column,
                    double* row, double* column) {
  for (Index c = 0; c < width; ++c) {
    double across = 0;
    for (Index r = 0; r < height; ++r) {
      const double value = block[c * height + r];
      row[r] -= value * x_column[c];
      across += value * x_row[r];
    }
    if (column != nullptr) column[c] -= across;
  }
}

}  // namespace

void subtract_product(const BlockColumns& pattern, const LargeVector<double>& values,
                      const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::MatrixXd& left, Team& team) {
  const Index count = std::ssize(pattern.pieces) - 1, size = pattern.size();
  const Index top = pattern.unknowns[pattern.pieces.back()];
  const auto subtract = [&](Index node, Index column, double* below, Index from) {  // rows from `from` on: `below`
    using Three = std::integral_constant<Index, 3>;
    const double* xs = x.col(column).data();
    double* own = left.col(column).data();
    const Index begin = pattern.unknowns[node], width = pattern.width(node);
    for (Index e = pattern.starts[node]; e < pattern.starts[node + 1]; ++e) {
      const Index row = pattern.unknowns[pattern.rows[e]], height = pattern.width(pattern.rows[e]);
      const double* block = values.data() + pattern.offsets[e];
      double* to = row >= from ? below + (row - from) : own + row;
      double* across = row == begin ? nullptr : own + begin;
      if (width == 3 && height == 3)
        subtract_block(block, Three(), Three(), xs + row, xs + begin, to, across);
      else
        subtract_block(block, height, width, xs + row, xs + begin, to, across);
    }
  };
  for (Index column = 0; column < x.cols(); ++column) {
    Eigen::MatrixXd above = Eigen::MatrixXd::Zero(size - top, count);  // of each piece
    team.each(count, [&](Index p) {
      for (Index node = pattern.pieces[p]; node < pattern.pieces[p + 1]; ++node)
        subtract(node, column, above.col(p).data(), top);
    });
    left.col(column).tail(size - top) += above.rowwise().sum();
    for (Index node = pattern.pieces.back(); node < pattern.nodes(); ++node) subtract(node, column, nullptr, size);
  }
}

}  // namespace softkin::linear
