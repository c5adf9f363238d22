#include <softkin/core/lanes.hpp>
#include <softkin/linear/kernels/front.hpp>

namespace softkin::linear::SOFTKIN_TARGET {

namespace {

using namespace softkin::SOFTKIN_TARGET;

using Few = Vector<double>;
constexpr Index height = lanes_of<double>;

/// Values of L, in double precision.
Few values(const double* l) {
  return load(l);
}
Few values(const float* l) {
#if defined(__AVX512F__)
  return _mm512_cvtps_pd(_mm256_loadu_ps(l));  // gcc 12 makes two halves of the conversion below
#else
  typedef float Half __attribute__((vector_size(vector_bytes / 2)));
  Half r;
  std::memcpy(&r, l, sizeof r);
  return __builtin_convertvector(r, Few);
#endif
}

template <class Lanes>
double sum(const Lanes& r) {
  if constexpr (sizeof(Lanes) == 64)
    return ((r[0] + r[4]) + (r[2] + r[6])) + ((r[1] + r[5]) + (r[3] + r[7]));
  else if constexpr (sizeof(Lanes) == 32)
    return (r[0] + r[2]) + (r[1] + r[3]);
  else
    return r[0] + r[1];
}

/// Forward by `Width` columns of L that begin at column k: their triangle, then all rows below it.
template <int Columns, int Width, class Number>
void forward_block(const FrontColumns<Number>& front, Index k, double* y, Index stride) {
  const std::ptrdiff_t apart = front.stride;
  const Number* l = front.values + k * apart;
  double own[Columns][Width];
  for (int c = 0; c < Columns; ++c) {
    double* at = y + c * static_cast<std::ptrdiff_t>(stride) + k;
    for (int i = 0; i < Width; ++i) own[c][i] = at[i];
    for (int j = 0; j < Width; ++j)
      for (int i = j + 1; i < Width; ++i) own[c][i] -= l[j * apart + k + i] * own[c][j];
    for (int i = 0; i < Width; ++i) at[i] = own[c][i];
  }
  for (Index r = k + Width; r < front.size; r += height) {
    Few rest[Columns];
    for (int c = 0; c < Columns; ++c) rest[c] = load(y + c * static_cast<std::ptrdiff_t>(stride) + r);
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      const Few column = values(l + j * apart + r);
      for (int c = 0; c < Columns; ++c) rest[c] -= own[c][j] * column;
    }
    for (int c = 0; c < Columns; ++c) store(y + c * static_cast<std::ptrdiff_t>(stride) + r, rest[c]);
  }
}

/// Backward by `Width` columns of L that begin at column k: all rows below their triangle, then that.
template <int Columns, int Width, class Number>
void backward_block(const FrontColumns<Number>& front, Index k, double* y, Index stride) {
  const std::ptrdiff_t apart = front.stride;
  const Number* l = front.values + k * apart;
  Few sums[Columns][Width] = {};
  for (Index r = k + Width; r < front.size; r += height) {
    Few known[Columns];
    for (int c = 0; c < Columns; ++c) known[c] = load(y + c * static_cast<std::ptrdiff_t>(stride) + r);
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      const Few column = values(l + j * apart + r);
      for (int c = 0; c < Columns; ++c) sums[c][j] += column * known[c];
    }
  }
  for (int c = 0; c < Columns; ++c) {
    double* at = y + c * static_cast<std::ptrdiff_t>(stride) + k;
    for (int j = Width - 1; j >= 0; --j) {
      double value = at[j] - sum(sums[c][j]);
      for (int i = j + 1; i < Width; ++i) value -= l[j * apart + k + i] * at[i];
      at[j] = value;
    }
  }
}

/// Columns of L by eights, the few that are left by fours, twos and ones.
template <int Columns, int Width, class Number>
void forward_rest(const FrontColumns<Number>& front, Index k, double* y, Index stride) {
  if (k + Width <= front.pivots) {
    forward_block<Columns, Width>(front, k, y, stride);
    k += Width;
  }
  if constexpr (Width > 1) forward_rest<Columns, Width / 2>(front, k, y, stride);
}

template <int Columns, class Number>
void forward(const FrontColumns<Number>& front, double* y, Index stride) {
  constexpr int width = 8;
  Index k = 0;
  for (; k + width <= front.pivots; k += width) forward_block<Columns, width>(front, k, y, stride);
  forward_rest<Columns, width / 2>(front, k, y, stride);
}

/// The last columns of L that fill no block: `Width` of them where k says so, then twice as many.
template <int Columns, int Width, int Most, class Number>
Index backward_rest(const FrontColumns<Number>& front, Index k, double* y, Index stride) {
  if constexpr (Width < Most) {
    if (k % (2 * Width) != 0) backward_block<Columns, Width>(front, k -= Width, y, stride);
    k = backward_rest<Columns, 2 * Width, Most>(front, k, y, stride);
  }
  return k;
}

template <int Columns, class Number>
void backward(const FrontColumns<Number>& front, double* y, Index stride) {
  // sums that the vector registers hold
  constexpr int most = registers / 2 / Columns, width = most >= 8 ? 8 : most >= 4 ? 4 : 2;
  Index k = backward_rest<Columns, 1, width>(front, front.pivots, y, stride);
  for (; k > 0; k -= width) backward_block<Columns, width>(front, k - width, y, stride);
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
void solve_forward(const FrontColumns<Number>& front, double* y, Index stride, Index columns) {
  with_columns(columns, [&]<int Columns>() { forward<Columns>(front, y, stride); });
}

template <class Number>
void solve_backward(const FrontColumns<Number>& front, double* y, Index stride, Index columns) {
  with_columns(columns, [&]<int Columns>() { backward<Columns>(front, y, stride); });
}

template void solve_forward(const FrontColumns<double>&, double*, Index, Index);
template void solve_forward(const FrontColumns<float>&, double*, Index, Index);
template void solve_backward(const FrontColumns<double>&, double*, Index, Index);
template void solve_backward(const FrontColumns<float>&, double*, Index, Index);

}  // namespace softkin::linear::SOFTKIN_TARGET
