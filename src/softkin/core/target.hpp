#pragma once

#include <softkin/core/index.hpp>
#include <vector>

namespace softkin {

/// Instruction sets that the inner loops are compiled for. What has inner loops stands in the `kernels` folder of its
/// module and is compiled once for each (cmake/modules.cmake), in a namespace of that name.
enum class Target {
  sse4,    // SSE4.2
  avx2,    // AVX2, FMA
  avx512,  // AVX-512 F, BW, DQ, VL
  neon,    // Advanced SIMD of aarch64
  plain    // what any processor of an architecture has, where there is none of the above or SOFTKIN_PLAIN is set
};

/// "avx2"
[[nodiscard]] const char* name_of(Target target);

/// Those that this processor has, the best first. Never empty but on an x86-64 without SSE4.2.
[[nodiscard]] std::vector<Target> targets_here();

/// The one that runs, for the life of the process: the best that this processor has, or what the environment's
/// SOFTKIN_TARGET names. The same commands give the same bits on every machine with the same target, whatever the
/// number of threads; between targets sums are rounded in another order.
///
/// throws  InvalidInput where SOFTKIN_TARGET names none, or one that this processor has not
[[nodiscard]] Target target();

}  // namespace softkin

// SOFTKIN_KERNELS(declarations) declares them in the namespace of each target that this architecture knows, and
// SOFTKIN_RUN_KERNEL(f(x)) returns what f of the running target does.
#if defined(__x86_64__) && !defined(SOFTKIN_PLAIN)
#define SOFTKIN_KERNELS(...) \
  namespace sse4 {           \
  __VA_ARGS__                \
  }                          \
  namespace avx2 {           \
  __VA_ARGS__                \
  }                          \
  namespace avx512 {         \
  __VA_ARGS__                \
  }
#define SOFTKIN_RUN_KERNEL(...)   \
  switch (::softkin::target()) {  \
    case Target::avx512:          \
      return avx512::__VA_ARGS__; \
    case Target::avx2:            \
      return avx2::__VA_ARGS__;   \
    default:                      \
      return sse4::__VA_ARGS__;   \
  }
#elif defined(__aarch64__) && !defined(SOFTKIN_PLAIN)
#define SOFTKIN_KERNELS(...) \
  namespace neon {           \
  __VA_ARGS__                \
  }
#define SOFTKIN_RUN_KERNEL(...) return neon::__VA_ARGS__
#else
#define SOFTKIN_KERNELS(...) \
  namespace plain {          \
  __VA_ARGS__                \
  }
#define SOFTKIN_RUN_KERNEL(...) return plain::__VA_ARGS__
#endif
