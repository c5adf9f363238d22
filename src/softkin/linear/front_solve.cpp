#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include <softkin/linear/front_rows.hpp>
#include <softkin/linear/front_solve.hpp>

namespace softkin::linear {

namespace {

using Eight = Rows<double>;
constexpr Index height = panel_rows<double>;

/// Eight values of L, in double precision.
Eight values(const double* l) {
  return load(l);
}
Eight values(const float* l) {
#ifdef __AVX512F__
  return _mm512_cvtps_pd(_mm256_loadu_ps(l));  // gcc 12 makes two halves of the conversion below
#else
  typedef float Half __attribute__((vector_size(32)));
  Half r;
  std::memcpy(&r, l, sizeof r);
  return __builtin_convertvector(r, Eight);
#endif
}

double sum(const Eight& r) {
  return ((r[0] + r[4]) + (r[2] + r[6])) + ((r[1] + r[5]) + (r[3] + r[7]));
}

/// Forward by `Width` columns of L that begin at column k: their triangle, then all rows below it.
template <int Columns, int Width, class Number>
void forward_block(const Number* panel, Index size, Index k, double* y, Index stride) {
  const Number* l = panel + static_cast<std::ptrdiff_t>(k) * size;
  double own[Columns][Width];
  for (int c = 0; c < Columns; ++c) {
    double* at = y + c * static_cast<std::ptrdiff_t>(stride) + k;
    for (int i = 0; i < Width; ++i) own[c][i] = at[i];
    for (int j = 0; j < Width; ++j)
      for (int i = j + 1; i < Width; ++i) own[c][i] -= l[static_cast<std::ptrdiff_t>(j) * size + k + i] * own[c][j];
    for (int i = 0; i < Width; ++i) at[i] = own[c][i];
  }
  for (Index r = k + Width; r < size; r += height) {
    Eight rest[Columns];
    for (int c = 0; c < Columns; ++c) rest[c] = load(y + c * static_cast<std::ptrdiff_t>(stride) + r);
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      const Eight column = values(l + static_cast<std::ptrdiff_t>(j) * size + r);
      for (int c = 0; c < Columns; ++c) rest[c] -= own[c][j] * column;
    }
    for (int c = 0; c < Columns; ++c) store(y + c * static_cast<std::ptrdiff_t>(stride) + r, rest[c]);
  }
}

/// Backward by `Width` columns of L that begin at column k: all rows below their triangle, then that.
template <int Columns, int Width, class Number>
void backward_block(const Number* panel, Index size, Index k, double* y, Index stride) {
  const Number* l = panel + static_cast<std::ptrdiff_t>(k) * size;
  Eight sums[Columns][Width] = {};
  for (Index r = k + Width; r < size; r += height) {
    Eight known[Columns];
    for (int c = 0; c < Columns; ++c) known[c] = load(y + c * static_cast<std::ptrdiff_t>(stride) + r);
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      const Eight column = values(l + static_cast<std::ptrdiff_t>(j) * size + r);
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

/// Columns of L by eights, the few that are left by fours, twos and ones.
template <int Columns, int Width, class Number>
void forward_rest(const Number* panel, Index size, Index k, Index pivots, double* y, Index stride) {
  if (k + Width <= pivots) {
    forward_block<Columns, Width>(panel, size, k, y, stride);
    k += Width;
  }
  if constexpr (Width > 1) forward_rest<Columns, Width / 2>(panel, size, k, pivots, y, stride);
}

template <int Columns, class Number>
void forward(const Number* panel, Index size, Index pivots, double* y, Index stride) {
  constexpr int width = 8;
  Index k = 0;
  for (; k + width <= pivots; k += width) forward_block<Columns, width>(panel, size, k, y, stride);
  forward_rest<Columns, width / 2>(panel, size, k, pivots, y, stride);
}

template <int Columns, class Number>
void backward(const Number* panel, Index size, Index pivots, double* y, Index stride) {
  constexpr int width = Columns <= 2 ? 8 : 4;  // sums that the vector registers hold
  Index k = pivots;
  if (k % 2 != 0) backward_block<Columns, 1>(panel, size, k -= 1, y, stride);
  if (k % 4 != 0) backward_block<Columns, 2>(panel, size, k -= 2, y, stride);
  if (k % width != 0) backward_block<Columns, 4>(panel, size, k -= 4, y, stride);
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

template <class Number>
void solve_forward(const Number* panel, Index size, Index pivots, double* y, Index stride, Index columns) {
  with_columns(columns, [&]<int Columns>() { forward<Columns>(panel, size, pivots, y, stride); });
}

template <class Number>
void solve_backward(const Number* panel, Index size, Index pivots, double* y, Index stride, Index columns) {
  with_columns(columns, [&]<int Columns>() { backward<Columns>(panel, size, pivots, y, stride); });
}

template void solve_forward(const double*, Index, Index, double*, Index, Index);
template void solve_forward(const float*, Index, Index, double*, Index, Index);
template void solve_backward(const double*, Index, Index, double*, Index, Index);
template void solve_backward(const float*, Index, Index, double*, Index, Index);

}  // namespace softkin::linear
