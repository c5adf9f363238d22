#pragma once

#include <softkin/core/target.hpp>

namespace softkin::bench {

SOFTKIN_KERNELS(
    /// c = a b by Eigen as this target compiles it; size x size, column-major
    template <class Number> void multiply_dense(const Number* a, const Number* b, Number* c, Index size);)

}  // namespace softkin::bench
