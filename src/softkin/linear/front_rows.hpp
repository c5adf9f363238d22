#pragma once

#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include <cstring>
#include <softkin/core/types.hpp>

namespace softkin::linear {

/// Rows of a column that are worked on together, wherever they begin: eight in double, sixteen in single precision.
template <class Number>
inline constexpr Index panel_rows = 64 / static_cast<Index>(sizeof(Number));

template <class Number>
struct Lanes {
  typedef Number Type __attribute__((vector_size(64)));
};
template <class Number>
using Rows = typename Lanes<Number>::Type;

template <class Number>
Rows<Number> load(const Number* p) {
  Rows<Number> r;
  std::memcpy(&r, p, sizeof r);
  return r;
}

template <class Number>
void store(Number* p, const Rows<Number>& r) {
  std::memcpy(p, &r, sizeof r);
}

/// to += from, for runs that are mostly short.
inline void add_run(double* to, const double* from, Index length) {
#ifdef __AVX512F__
  for (; length >= 8; length -= 8, to += 8, from += 8) store(to, load(to) + load(from));
  if (length == 0) return;
  const auto lanes = static_cast<__mmask8>((1u << length) - 1);
  _mm512_mask_storeu_pd(to, lanes, _mm512_maskz_loadu_pd(lanes, to) + _mm512_maskz_loadu_pd(lanes, from));
#else
  for (Index i = 0; i < length; ++i) to[i] += from[i];
#endif
}
inline void add_run(float* to, const float* from, Index length) {
#ifdef __AVX512F__
  for (; length >= 16; length -= 16, to += 16, from += 16) store(to, load(to) + load(from));
  if (length == 0) return;
  const auto lanes = static_cast<__mmask16>((1u << length) - 1);
  _mm512_mask_storeu_ps(to, lanes, _mm512_maskz_loadu_ps(lanes, to) + _mm512_maskz_loadu_ps(lanes, from));
#else
  for (Index i = 0; i < length; ++i) to[i] += from[i];
#endif
}

}  // namespace softkin::linear
