#include <softkin/linear/front_rows.hpp>
#include <softkin/linear/front_solve.hpp>

namespace softkin::linear {

namespace {

inline double sum(const Rows& r) {
  return ((r[0] + r[4]) + (r[2] + r[6])) + ((r[1] + r[5]) + (r[3] + r[7]));
}

/// Forward by `Width` columns of L that begin at column k: their triangle, then all rows below it.
template <int Columns, int Width>
void forward_block(const double* panel, Index size, Index k, double* y, Index stride) {
  const double* l = panel + static_cast<std::ptrdiff_t>(k) * size;
  double own[Columns][Width];
  for (int c = 0; c < Columns; ++c) {
    double* at = y + c * static_cast<std::ptrdiff_t>(stride) + k;
    for (int i = 0; i < Width; ++i) own[c][i] = at[i];
    for (int j = 0; j < Width; ++j)
      for (int i = j + 1; i < Width; ++i) own[c][i] -= l[static_cast<std::ptrdiff_t>(j) * size + k + i] * own[c][j];
    for (int i = 0; i < Width; ++i) at[i] = own[c][i];
  }
  for (Index r = k + Width; r < size; r += panel_rows) {
    Rows rest[Columns];
    for (int c = 0; c < Columns; ++c) rest[c] = load(y + c * static_cast<std::ptrdiff_t>(stride) + r);
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      const Rows column = load(l + static_cast<std::ptrdiff_t>(j) * size + r);
      for (int c = 0; c < Columns; ++c) rest[c] -= own[c][j] * column;
    }
    for (int c = 0; c < Columns; ++c) store(y + c * static_cast<std::ptrdiff_t>(stride) + r, rest[c]);
  }
}

/// Backward by `Width` columns of L that begin at column k: all rows below their triangle, then that.
template <int Columns, int Width>
void backward_block(const double* panel, Index size, Index k, double* y, Index stride) {
  const double* l = panel + static_cast<std::ptrdiff_t>(k) * size;
  Rows sums[Columns][Width] = {};
  for (Index r = k + Width; r < size; r += panel_rows) {
    Rows known[Columns];
    for (int c = 0; c < Columns; ++c) known[c] = load(y + c * static_cast<std::ptrdiff_t>(stride) + r);
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      const Rows column = load(l + static_cast<std::ptrdiff_t>(j) * size + r);
      for (int c = 0; c < Columns; ++c) sums[c][j] += column * known[c];
    }
  }
  for (int c = 0; c < Columns; ++c) {
    double* at = y + c * static_cast<std::ptrdiff_t>(stride) + k;
    for (int j = Width - 1; j >= 0; --j) {
      double value = at[j] - sum(sums[c][j]);
      for (int i = j + 1; i < Width; ++i) value -= l[static_cast<std::ptrdiff_t>(j) * size + k + i] * at[i];
      at[j] = value;
    }
  }
}

constexpr Index forward_width = 8;

template <int Columns>
void forward(const double* panel, Index size, Index pivots, double* y, Index stride) {
  Index k = 0;
  for (; k + forward_width <= pivots; k += forward_width)
    forward_block<Columns, forward_width>(panel, size, k, y, stride);
  for (; k < pivots; ++k) forward_block<Columns, 1>(panel, size, k, y, stride);
}

template <int Columns>
void backward(const double* panel, Index size, Index pivots, double* y, Index stride) {
  constexpr int width = Columns <= 2 ? 8 : 4;  // sums that the vector registers hold
  Index k = pivots;
  for (; k % width != 0; --k) backward_block<Columns, 1>(panel, size, k - 1, y, stride);
  for (; k > 0; k -= width) backward_block<Columns, width>(panel, size, k - width, y, stride);
}

/// visit.operator()<columns>()
template <class Visit>
void with_columns(Index columns, const Visit& visit) {
  switch (columns) {
    case 1:
      return visit.template operator()<1>();
    case 2:
      return visit.template operator()<2>();
    case 3:
      return visit.template operator()<3>();
    default:
      return visit.template operator()<4>();
  }
}

}  // namespace

void solve_forward(const double* panel, Index size, Index pivots, double* y, Index stride, Index columns) {
  with_columns(columns, [&]<int Columns>() { forward<Columns>(panel, size, pivots, y, stride); });
}

void solve_backward(const double* panel, Index size, Index pivots, double* y, Index stride, Index columns) {
  with_columns(columns, [&]<int Columns>() { backward<Columns>(panel, size, pivots, y, stride); });
}

}  // namespace softkin::linear
