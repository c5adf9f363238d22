#include <algorithm>
#include <cstring>
#include <softkin/linear/front_solve.hpp>

namespace softkin::linear {

namespace {

/// Eight rows of a column, wherever they begin.
typedef double Eight __attribute__((vector_size(64)));
constexpr Index rows_together = 8;

inline Eight load(const double* p) {
  Eight r;
  std::memcpy(&r, p, sizeof r);
  return r;
}

inline void store(double* p, const Eight& r) {
  std::memcpy(p, &r, sizeof r);
}

inline double sum(const Eight& r) {
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
  for (Index r = k + Width; r < size; r += rows_together) {
    Eight rest[Columns];
    for (int c = 0; c < Columns; ++c) rest[c] = load(y + c * static_cast<std::ptrdiff_t>(stride) + r);
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      const Eight column = load(l + static_cast<std::ptrdiff_t>(j) * size + r);
      for (int c = 0; c < Columns; ++c) rest[c] -= own[c][j] * column;
    }
    for (int c = 0; c < Columns; ++c) store(y + c * static_cast<std::ptrdiff_t>(stride) + r, rest[c]);
  }
}

/// Backward by `Width` columns of L that begin at column k: all rows below their triangle, then that.
template <int Columns, int Width>
void backward_block(const double* panel, Index size, Index k, double* y, Index stride) {
  const double* l = panel + static_cast<std::ptrdiff_t>(k) * size;
  Eight sums[Columns][Width] = {};
  for (Index r = k + Width; r < size; r += rows_together) {
    Eight known[Columns];
    for (int c = 0; c < Columns; ++c) known[c] = load(y + c * static_cast<std::ptrdiff_t>(stride) + r);
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      const Eight column = load(l + static_cast<std::ptrdiff_t>(j) * size + r);
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

}  // namespace

void solve_forward(const double* panel, Index size, Index pivots, double* y, Index stride, Index columns) {
  switch (columns) {
    case 1:
      return forward<1>(panel, size, pivots, y, stride);
    case 2:
      return forward<2>(panel, size, pivots, y, stride);
    case 3:
      return forward<3>(panel, size, pivots, y, stride);
    default:
      return forward<4>(panel, size, pivots, y, stride);
  }
}

void solve_backward(const double* panel, Index size, Index pivots, double* y, Index stride, Index columns) {
  switch (columns) {
    case 1:
      return backward<1>(panel, size, pivots, y, stride);
    case 2:
      return backward<2>(panel, size, pivots, y, stride);
    case 3:
      return backward<3>(panel, size, pivots, y, stride);
    default:
      return backward<4>(panel, size, pivots, y, stride);
  }
}

}  // namespace softkin::linear
