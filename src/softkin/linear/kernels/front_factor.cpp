#include <softkin/core/lanes.hpp>
#include <softkin/linear/kernels/front.hpp>

namespace softkin::linear::SOFTKIN_TARGET {

namespace {

using namespace softkin::SOFTKIN_TARGET;

constexpr Index block_width = front_block;

/// How products are cut into tiles whose sums fill the vector registers, with room for what is multiplied; without
/// fused operations for a product, too. A tile has `panels` panels of rows by `columns` columns.
template <class Number>
struct Tile {
  static constexpr Index lanes = lanes_of<Number>;
  static constexpr Index columns = vector_bytes == 64 ? 8 : 4;
  static constexpr Index rows = lanes > columns ? lanes : columns;  // of a panel
  static constexpr int vectors = rows / lanes;                      // of a panel
#if defined(__FMA__) || defined(__aarch64__)
  static constexpr Index sums = registers == 32 ? 24 : 12;
#else
  static constexpr Index sums = 8;
#endif
  static constexpr int panels = sums / (columns * vectors);
  static_assert(panels >= 1 && front_block % columns == 0);
};

template <int Panels, class Number>
using Sums = Vector<Number>[Panels * Tile<Number>::vectors][Tile<Number>::columns];

/// sums += left right^T over `depth` columns: `Panels` panels of left, which are `apart` values apart, and the rows of
/// right, `right_rows` a column.
template <int Panels, class Number>
[[gnu::always_inline]] inline void multiply(const Number* left, Index apart, const Number* right, Index right_rows,
                                            Index depth, Sums<Panels, Number>& sums) {
  using T = Tile<Number>;
  for (Index k = 0; k < depth; ++k) {
    Vector<Number> column[Panels * T::vectors];
#pragma GCC unroll 8
    for (int p = 0; p < Panels; ++p)
#pragma GCC unroll 8
      for (int v = 0; v < T::vectors; ++v)
        column[p * T::vectors + v] = load(left + p * static_cast<std::ptrdiff_t>(apart) + k * T::rows + v * T::lanes);
#pragma GCC unroll 8
    for (int c = 0; c < T::columns; ++c) {
      const Number factor = right[k * static_cast<std::ptrdiff_t>(right_rows) + c];
#pragma GCC unroll 8
      for (int v = 0; v < Panels * T::vectors; ++v) sums[v][c] += factor * column[v];
    }
  }
}

/// visit(place of the row, vector) for the vectors of some panels.
template <int Panels, class Number, class Visit>
[[gnu::always_inline]] inline void each_vector(const Visit& visit) {
#pragma GCC unroll 8
  for (int v = 0; v < Panels * Tile<Number>::vectors; ++v) visit(v * Tile<Number>::lanes, v);
}

/// From one panel of a block's `plain` and `scaled` to the next.
template <class Number>
[[gnu::always_inline]] inline Index apart_of(const FrontBlock<Number>& block) {
  return block.width * Tile<Number>::rows;
}

/// A group of columns of some panels of rows: what is left of A once the columns before the group are eliminated.
///
/// rows    A: the group's first column
/// corner  the group's L, `columns` values for each column of the block
/// plain   L D of those panels in the columns before, a panel every `block_width` columns
template <int Panels, class Number>
[[gnu::always_inline]] inline void reduce_group(const FrontBlock<Number>& block, Index row, Index group, Index columns,
                                                const Number* plain, Sums<Panels, Number>& sums) {
  using T = Tile<Number>;
#pragma GCC unroll 8
  for (int c = 0; c < T::columns; ++c)
    each_vector<Panels, Number>([&](Index, int v) { sums[v][c] = Vector<Number>{}; });
  const Number* rows = block.at(row, block.begin + group);
  multiply<Panels>(plain, apart_of(block), block.corner + group * block_width, T::columns, group, sums);
#pragma GCC unroll 8
  for (int c = 0; c < T::columns; ++c) {
    if (c < columns) {
      const Number* column = rows + c * static_cast<std::ptrdiff_t>(block.stride);
      each_vector<Panels, Number>([&](Index at, int v) { sums[v][c] = load(column + at) - sums[v][c]; });
    }
  }
}

/// The group's own columns eliminated: sums become L D.
template <int Panels, class Number>
[[gnu::always_inline]] inline void solve_group(const Number* corner, Index group, Sums<Panels, Number>& sums) {
  using T = Tile<Number>;
#pragma GCC unroll 8
  for (int c = 1; c < T::columns; ++c)
#pragma GCC unroll 8
    for (int k = 0; k < c; ++k) {
      const Number factor = corner[(group + k) * T::columns + c];
      each_vector<Panels, Number>([&](Index, int v) { sums[v][c] -= factor * sums[v][k]; });
    }
}

template <int Panels, class Number>
[[gnu::always_inline]] inline void store_group(Number* to, Index apart, const Sums<Panels, Number>& sums, int c) {
  using T = Tile<Number>;
#pragma GCC unroll 8
  for (int p = 0; p < Panels; ++p)
#pragma GCC unroll 8
    for (int v = 0; v < T::vectors; ++v)
      store(to + p * static_cast<std::ptrdiff_t>(apart) + v * T::lanes, sums[p * T::vectors + v][c]);
}

/// visit.operator()<Panels>(first panel) over panels [begin, end), a strip of them at a time.
template <class Number, int Panels = Tile<Number>::panels, class Visit>
void each_strip(Index begin, Index end, const Visit& visit) {
  for (; begin + Panels <= end; begin += Panels) visit.template operator()<Panels>(begin);
  if constexpr (Panels > 1) each_strip<Number, Panels - 1>(begin, end, visit);
}

/// A group's own triangle: its pivots, and its L into the corner.
template <class Number>
Index factor_group(const Number* rest, Index group, Index columns, Number least, Number* diagonal, Number* corner,
                   Number* inverse) {
  using T = Tile<Number>;
  Number a[T::columns][T::columns];
  for (Index c = 0; c < columns; ++c)
    for (Index r = c; r < columns; ++r) a[r][c] = rest[c * T::rows + r];
  for (Index k = 0; k < T::columns; ++k)
    for (Index c = 0; c < T::columns; ++c) corner[(group + k) * T::columns + c] = 0;
  Index negative = 0;
  for (Index k = 0; k < columns; ++k) {
    Number pivot = a[k][k];
    if (!(pivot >= least || pivot <= -least)) pivot = -least;
    negative += pivot < 0;
    diagonal[group + k] = pivot;
    inverse[group + k] = 1 / pivot;
    for (Index r = k + 1; r < columns; ++r) {
      const Number l = a[r][k] * inverse[group + k];
      corner[(group + k) * T::columns + r] = l;
      for (Index c = k + 1; c <= r; ++c) a[r][c] -= a[c][k] * l;
    }
  }
  return negative;
}

/// The pivots' L in place, from L D in `plain`; above the diagonal, where anything may stand, too.
template <class Number>
void scale_corner(const FrontBlock<Number>& block, const Number* inverse) {
  using T = Tile<Number>;
  const std::ptrdiff_t stride = block.stride;
  Number* rows = block.at(block.begin, block.begin);
  const Number* plain = block.plain;
  Index row = 0;
  for (; row + T::rows <= block.width; row += T::rows, rows += T::rows, plain += apart_of(block))
    for (Index c = 0; c < row + T::rows; ++c)
#pragma GCC unroll 8
      for (Index r = 0; r < T::rows; r += T::lanes)
        store(rows + c * stride + r, inverse[c] * load(plain + c * T::rows + r));
  for (; row < block.width; ++row, ++rows, ++plain)  // beside the rows below the block, which stay as they are
    for (Index c = 0; c < row; ++c) rows[c * stride] = inverse[c] * plain[c * T::rows];
}

}  // namespace

template <class Number>
Index factor_corner(const FrontBlock<Number>& block, Number least, Number* diagonal) {
  using T = Tile<Number>;
  const Index apart = apart_of(block);  // panels of `plain`, which is work space here
  const Index width = block.width, panels = (width + T::rows - 1) / T::rows;
  Number* inverse = block.corner + block_width * block_width;
  Index negative = 0;
  for (Index group = 0; group < width; group += T::columns) {
    const Index columns = width - group < T::columns ? width - group : T::columns;
    Number* corner = block.corner + group * block_width;
    const auto plain = [&](Index panel) { return block.plain + panel * static_cast<std::ptrdiff_t>(apart); };
    const auto row_of = [&](Index panel) { return block.begin + panel * T::rows; };
    {
      const Index panel = group / T::rows;
      const Number* row = plain(panel) + group % T::rows;
      for (Index k = 0; k < group; ++k)
        for (Index c = 0; c < T::columns; ++c) corner[k * T::columns + c] = inverse[k] * row[k * T::rows + c];
      Sums<1, Number> sums;
      reduce_group<1>(block, row_of(panel), group, columns, plain(panel), sums);
      Number rest[T::columns * T::rows];
      for (int c = 0; c < T::columns; ++c) store_group<1>(rest + c * T::rows, 0, sums, c);
      negative += factor_group(rest + group % T::rows, group, columns, least, diagonal, corner, inverse);
    }
    each_strip<Number>(group / T::rows, panels, [&]<int Panels>(Index panel) {
      Sums<Panels, Number> sums;
      reduce_group<Panels>(block, row_of(panel), group, columns, plain(panel), sums);
      solve_group<Panels>(corner, group, sums);
#pragma GCC unroll 8
      for (int c = 0; c < T::columns; ++c)
        if (c < columns) store_group<Panels>(plain(panel) + (group + c) * T::rows, apart, sums, c);
    });
  }
  scale_corner(block, inverse);
  return negative;
}

template <class Number>
Index strip_count(const FrontBlock<Number>& block) {
  constexpr Index rows = Tile<Number>::rows * Tile<Number>::panels;
  return (block.rest() + rows - 1) / rows;
}

namespace {

template <class Number>
Index panels_of(const FrontBlock<Number>& block, Index strip) {
  const Index panels = (block.rest() + Tile<Number>::rows - 1) / Tile<Number>::rows, to = strip * Tile<Number>::panels;
  return to < panels ? to : panels;
}

/// Where a panel of the rows below the block begins in `plain` or `scaled`.
template <class Number>
Number* panel_at(const FrontBlock<Number>& block, Number* all, Index panel) {
  return all + panel * static_cast<std::ptrdiff_t>(apart_of(block));
}

template <int Panels, class Number>
void solve_strip(const FrontBlock<Number>& block, Index panel) {
  using T = Tile<Number>;
  const Index apart = apart_of(block);
  const Number* inverse = block.corner + block_width * block_width;
  Number *plain = panel_at(block, block.plain, panel), *scaled = panel_at(block, block.scaled, panel);
  for (Index group = 0; group < block.width; group += T::columns) {
    const Index columns = block.width - group < T::columns ? block.width - group : T::columns;
    const Number* corner = block.corner + group * block_width;
    Number* rows = block.at(block.first() + panel * T::rows, block.begin + group);
    Sums<Panels, Number> sums;
    reduce_group<Panels>(block, block.first() + panel * T::rows, group, columns, plain, sums);
    solve_group<Panels>(corner, group, sums);
#pragma GCC unroll 8
    for (int c = 0; c < T::columns; ++c)
      if (c < columns) {
        store_group<Panels>(plain + (group + c) * T::rows, apart, sums, c);
        each_vector<Panels, Number>([&](Index, int v) { sums[v][c] = inverse[group + c] * sums[v][c]; });
        store_group<Panels>(scaled + (group + c) * T::rows, apart, sums, c);
        Number* column = rows + c * static_cast<std::ptrdiff_t>(block.stride);
        each_vector<Panels, Number>([&](Index at, int v) { store(column + at, sums[v][c]); });
      }
  }
}

/// Rows from `row` on and columns from `first` on; what stands from the column `fresh` on counts as zero.
template <int Panels, class Number>
[[gnu::always_inline]] inline void subtract(const FrontBlock<Number>& block, Index row, Index first, Index fresh,
                                            Sums<Panels, Number>& sums) {
  using T = Tile<Number>;
  Number* column = block.at(row, first);
  std::ptrdiff_t stride = first < block.pivots ? block.stride : block.left_stride;
#pragma GCC unroll 8
  for (int c = 0; c < T::columns; ++c, column += stride) {
    if (first + c >= block.size) break;
    if (first + c == block.pivots) {
      column = block.at(row, block.pivots);
      stride = block.left_stride;
    }
    if (first + c < fresh)
      each_vector<Panels, Number>([&](Index at, int v) { store(column + at, load(column + at) - sums[v][c]); });
    else
      each_vector<Panels, Number>([&](Index at, int v) { store(column + at, -sums[v][c]); });
  }
}

/// Columns [low, high) of some panels of rows.
template <int Panels, class Number>
void update_columns(const FrontBlock<Number>& block, Index panel, Index low, Index high) {
  using T = Tile<Number>;
  const Index apart = apart_of(block);
  for (Index c = low; c < high; c += T::columns) {
    Sums<Panels, Number> sums = {};
    multiply<Panels>(panel_at(block, block.scaled, panel), apart,
                     panel_at(block, block.plain, c / T::rows) + c % T::rows, T::rows, block.width, sums);
    subtract<Panels>(block, block.first() + panel * T::rows, block.first() + c,
                     block.begin == 0 ? block.pivots : block.size, sums);
  }
}

/// Columns from `low` to the diagonal, each for the panels that reach it.
template <int Panels, class Number>
void update_strip(const FrontBlock<Number>& block, Index panel, Index low) {
  const Index end = (panel + 1) * Tile<Number>::rows, rest = block.rest();
  update_columns<Panels>(block, panel, low, end < rest ? end : rest);
  if constexpr (Panels > 1) update_strip<Panels - 1>(block, panel + 1, end);
}

}  // namespace

template <class Number>
void solve_strips(const FrontBlock<Number>& block, Index low, Index high) {
  each_strip<Number>(panels_of(block, low), panels_of(block, high),
                     [&]<int Panels>(Index panel) { solve_strip<Panels>(block, panel); });
}

template <class Number>
void update_strips(const FrontBlock<Number>& block, Index low, Index high) {
  each_strip<Number>(panels_of(block, low), panels_of(block, high),
                     [&]<int Panels>(Index panel) { update_strip<Panels>(block, panel, 0); });
}

template Index factor_corner(const FrontBlock<double>&, double, double*);
template Index factor_corner(const FrontBlock<float>&, float, float*);
template Index strip_count(const FrontBlock<double>&);
template Index strip_count(const FrontBlock<float>&);
template void solve_strips(const FrontBlock<double>&, Index, Index);
template void solve_strips(const FrontBlock<float>&, Index, Index);
template void update_strips(const FrontBlock<double>&, Index, Index);
template void update_strips(const FrontBlock<float>&, Index, Index);

}  // namespace softkin::linear::SOFTKIN_TARGET
