#include <softkin/core/lanes.hpp>
#include <softkin/linear/kernels/supernode.hpp>

namespace softkin::linear::SOFTKIN_TARGET {

namespace {

using namespace softkin::SOFTKIN_TARGET;

/// Three coordinates and a spare, in one register or two.
struct Row {
  static constexpr int bytes = vector_bytes < 32 ? vector_bytes : 32, parts = 32 / bytes;
  typedef double Part __attribute__((vector_size(bytes)));
  Part part[parts];
};

[[gnu::always_inline]] inline Row row_at(const double* rows, Index index) {
  Row row;
  std::memcpy(&row, rows + 4 * static_cast<std::ptrdiff_t>(index), sizeof row);
  return row;
}
[[gnu::always_inline]] inline void put(const Row& row, double* rows, Index index) {
  std::memcpy(rows + 4 * static_cast<std::ptrdiff_t>(index), &row, sizeof row);
}

/// to += factor row
[[gnu::always_inline]] inline void add(Row& to, double factor, const Row& row) {
  for (int p = 0; p < Row::parts; ++p) to.part[p] += factor * row.part[p];
}
[[gnu::always_inline]] inline void subtract(Row& from, double factor, const Row& row) {
  for (int p = 0; p < Row::parts; ++p) from.part[p] -= factor * row.part[p];
}

}  // namespace

void forward_supernode(const SupernodeColumns& node, double* rows, double* above) {
  const Index width = node.width;
  double* x = rows + 4 * static_cast<std::ptrdiff_t>(node.begin);
  const double* p = node.triangle;
  for (Index i = 1; i < width; p += i, ++i) {
    Row own = row_at(x, i);
    for (Index c = 0; c < i; ++c) subtract(own, p[c], row_at(x, c));
    put(own, x, i);
  }
  const auto lose = [&](Index r, const Row& lost) {
    double* from = r < node.inner_rows ? rows : above;
    const Index at = r < node.inner_rows ? node.rows[r] : node.rows[r] - node.top;
    Row row = row_at(from, at);
    subtract(row, 1, lost);
    put(row, from, at);
  };
  p = node.below;
  Index r = 0;
  for (; r + 4 <= node.row_count; r += 4, p += 4 * width) {  // four rows use each load of x
    Row lost[4] = {};
    for (Index k = 0; k < width; ++k) {
      const Row known = row_at(x, k);
#pragma GCC unroll 4
      for (int i = 0; i < 4; ++i) add(lost[i], p[i * width + k], known);
    }
    for (int i = 0; i < 4; ++i) lose(r + i, lost[i]);
  }
  for (; r < node.row_count; ++r, p += width) {
    Row lost{};
    for (Index k = 0; k < width; ++k) add(lost, p[k], row_at(x, k));
    lose(r, lost);
  }
}

void backward_supernode(const SupernodeColumns& node, double* rows) {
  const Index width = node.width;
  double* x = rows + 4 * static_cast<std::ptrdiff_t>(node.begin);
  for (Index k = 0; k < width; ++k) {
    const Row known = row_at(x, k);
    Row own{};
    add(own, node.inverse_diagonal[k], known);
    put(own, x, k);
  }
  const double* p = node.below;
  Index r = 0;
  for (; r + 4 <= node.row_count; r += 4, p += 4 * width) {
    Row known[4];
    for (int i = 0; i < 4; ++i) known[i] = row_at(rows, node.rows[r + i]);
    for (Index k = 0; k < width; ++k) {
      Row own = row_at(x, k);
#pragma GCC unroll 4
      for (int i = 0; i < 4; ++i) subtract(own, p[i * width + k], known[i]);
      put(own, x, k);
    }
  }
  for (; r < node.row_count; ++r, p += width) {
    const Row known = row_at(rows, node.rows[r]);
    for (Index k = 0; k < width; ++k) {
      Row own = row_at(x, k);
      subtract(own, p[k], known);
      put(own, x, k);
    }
  }
  p = node.below;
  for (Index i = width - 1; i >= 1; --i) {
    p -= i;
    const Row known = row_at(x, i);
    for (Index k = 0; k < i; ++k) {
      Row own = row_at(x, k);
      subtract(own, p[k], known);
      put(own, x, k);
    }
  }
}

}  // namespace softkin::linear::SOFTKIN_TARGET
