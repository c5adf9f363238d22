#include <softkin/core/lanes.hpp>
#include <softkin/linear/kernels/front.hpp>

namespace softkin::linear::SOFTKIN_TARGET {

namespace {

using namespace softkin::SOFTKIN_TARGET;

/// to += from, less than 2 `Bytes` of them: halves, quarters and so on of a register.
template <class Number, int Bytes>
[[gnu::always_inline]] inline void add_few(Number* to, const Number* from, Index length) {
  constexpr Index lanes = Bytes / static_cast<Index>(sizeof(Number));
  if (length >= lanes) {
    typedef Number Some __attribute__((vector_size(Bytes)));
    Some a, b;
    std::memcpy(&a, to, sizeof a);
    std::memcpy(&b, from, sizeof b);
    a += b;
    std::memcpy(to, &a, sizeof a);
    to += lanes, from += lanes, length -= lanes;
  }
  if constexpr (lanes > 1) add_few<Number, Bytes / 2>(to, from, length);
}

/// to += from, for runs that are mostly short.
template <class Number>
[[gnu::always_inline]] inline void add_run(Number* to, const Number* from, Index length) {
  constexpr Index lanes = lanes_of<Number>;
  for (; length >= lanes; length -= lanes, to += lanes, from += lanes) store(to, load(to) + load(from));
#if defined(__AVX512F__)
  if (length == 0) return;
  if constexpr (sizeof(Number) == 8) {
    const auto some = static_cast<__mmask8>((1u << length) - 1);
    _mm512_mask_storeu_pd(to, some, _mm512_maskz_loadu_pd(some, to) + _mm512_maskz_loadu_pd(some, from));
  } else {
    const auto some = static_cast<__mmask16>((1u << length) - 1);
    _mm512_mask_storeu_ps(to, some, _mm512_maskz_loadu_ps(some, to) + _mm512_maskz_loadu_ps(some, from));
  }
#else
  add_few<Number, vector_bytes / 2>(to, from, length);
#endif
}

}  // namespace

template <class Number>
void add_run_columns(const FrontSum<Number>& sum, const RowRun* run, Index low, Index high) {
  for (Index c = low; c < high; ++c) {
    Number* to = sum.to + static_cast<std::ptrdiff_t>(run->to + c) * sum.to_stride;
    const Number* from = sum.from + static_cast<std::ptrdiff_t>(run->from + c) * sum.from_stride;
    add_run(to + run->to + c, from + run->from + c, run->length - c);
    for (const RowRun* below = run + 1; below < sum.last; ++below) {
      // no processor foresees where the next columns' short runs stand
      __builtin_prefetch(to + 2 * sum.to_stride + below->to, 1);
      __builtin_prefetch(from + 2 * sum.from_stride + below->from);
      add_run(to + below->to, from + below->from, below->length);
    }
  }
}

template void add_run_columns(const FrontSum<double>&, const RowRun*, Index, Index);
template void add_run_columns(const FrontSum<float>&, const RowRun*, Index, Index);

}  // namespace softkin::linear::SOFTKIN_TARGET
