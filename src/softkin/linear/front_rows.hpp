#pragma once

#include <cstring>
#include <softkin/core/types.hpp>

namespace softkin::linear {

/// Eight rows of a column, wherever they begin.
typedef double Rows __attribute__((vector_size(64)));
inline constexpr Index panel_rows = 8;

inline Rows load(const double* p) {
  Rows r;
  std::memcpy(&r, p, sizeof r);
  return r;
}

inline void store(double* p, const Rows& r) {
  std::memcpy(p, &r, sizeof r);
}

}  // namespace softkin::linear
