#pragma once

// Vectors of the target that a kernel is compiled for; included by the files of `kernels` folders alone, which are
// compiled once for each target with SOFTKIN_TARGET and SOFTKIN_VECTOR_BYTES set (cmake/modules.cmake).
#ifndef SOFTKIN_TARGET
#error "for files in a folder `kernels` only"
#endif

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <cstring>
#include <softkin/core/index.hpp>

namespace softkin::SOFTKIN_TARGET {

inline constexpr int vector_bytes = SOFTKIN_VECTOR_BYTES;
/// Vector registers that there are.
#if defined(__AVX512F__) || defined(__aarch64__)
inline constexpr int registers = 32;
#else
inline constexpr int registers = 16;
#endif

template <class Number>
struct VectorOf {
  typedef Number Type __attribute__((vector_size(vector_bytes)));
};
/// As many numbers as one register holds. Arithmetic works lane by lane.
template <class Number>
using Vector = typename VectorOf<Number>::Type;
template <class Number>
inline constexpr Index lanes_of = vector_bytes / static_cast<Index>(sizeof(Number));

/// From and to any address.
template <class Number>
inline Vector<Number> load(const Number* from) {
  Vector<Number> v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <class Number>
inline void store(Number* to, const Vector<Number>& v) {
  std::memcpy(to, &v, sizeof v);
}

}  // namespace softkin::SOFTKIN_TARGET
