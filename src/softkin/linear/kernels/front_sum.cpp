#include <softkin/core/lanes.hpp>
#include <softkin/linear/kernels/front.hpp>
#include <type_traits>

namespace softkin::linear::SOFTKIN_TARGET {

namespace {

using namespace softkin::SOFTKIN_TARGET;

#if defined(__AVX512F__)

/// A child's next rows in the places of a pack, zero in the others.
class Spread {
 public:
  explicit Spread(std::uint32_t bits) : bits_(bits) {}

  Vector<double> operator()(const double* from) const {
    return _mm512_maskz_expand_pd(static_cast<__mmask8>(bits_), in_register(load(from)));
  }
  Vector<float> operator()(const float* from) const {
    return _mm512_maskz_expand_ps(static_cast<__mmask16>(bits_), in_register(load(from)));
  }

 private:
  /// AMD's processors take 2.6 times as long to spread what the instruction itself reads from memory.
  template <class Values>
  static Values in_register(Values values) {
    asm("" : "+v"(values));
    return values;
  }

  std::uint32_t bits_;
};
template <class Number>
using SpreadOf = Spread;

#else

// Of places a machine without AVX-512 permutes 32 bits in registers of 32 bytes, else bytes.
constexpr int moved_bytes = vector_bytes == 32 ? 4 : 1, moved = vector_bytes / moved_bytes;
typedef std::conditional_t<moved_bytes == 4, std::int32_t, std::int8_t> Place;
typedef Place Places __attribute__((vector_size(vector_bytes)));

/// Which of a child's next rows comes to each place, by the pack's bits but for the first, which is set; -1: none.
template <int Lanes>
struct Moves {
  static constexpr int patterns = 1 << (Lanes - 1), each = moved / Lanes;
  alignas(vector_bytes) Place of[patterns][moved];
};
template <int Lanes>
constexpr Moves<Lanes> make_moves() {
  Moves<Lanes> moves{};
  for (int pattern = 0; pattern < Moves<Lanes>::patterns; ++pattern) {
    const int bits = 2 * pattern + 1;
    for (int lane = 0, next = 0; lane < Lanes; ++lane) {
      const bool set = (bits >> lane & 1) != 0;
      for (int i = 0; i < Moves<Lanes>::each; ++i)
        moves.of[pattern][lane * Moves<Lanes>::each + i] = static_cast<Place>(set ? next * Moves<Lanes>::each + i : -1);
      next += set;
    }
  }
  return moves;
}
template <int Lanes>
constexpr Moves<Lanes> moves = make_moves<Lanes>();

/// Each place by where it comes from; of -1 anything.
[[gnu::always_inline]] inline Places permuted(const Places& rows, const Places& from) {
#if defined(__AVX2__)
  return reinterpret_cast<Places>(
      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(rows), reinterpret_cast<__m256i>(from)));
#elif defined(__SSSE3__)
  return reinterpret_cast<Places>(_mm_shuffle_epi8(reinterpret_cast<__m128i>(rows), reinterpret_cast<__m128i>(from)));
#elif defined(__clang__)
  Places to;
  for (int i = 0; i < moved; ++i) to[i] = rows[from[i] & (moved - 1)];
  return to;
#else
  return __builtin_shuffle(rows, from);
#endif
}

/// A child's next rows in the places of a pack, zero in the others.
template <class Number>
class SpreadOf {
 public:
  explicit SpreadOf(std::uint32_t bits) {
    std::memcpy(&from_, moves<static_cast<int>(lanes_of<Number>)>.of[bits >> 1], sizeof from_);
    keep_ = from_ >= 0;
  }
  Vector<Number> operator()(const Number* from) const {
    Places rows;
    std::memcpy(&rows, from, sizeof rows);
    if constexpr (lanes_of < Number >> 2) rows = permuted(rows, from_);
    rows &= keep_;
    Vector<Number> spread;
    std::memcpy(&spread, &rows, sizeof spread);
    return spread;
  }

 private:
  Places from_, keep_;
};

#endif

/// A child's columns, and where their rows go.
template <class Number>
struct Columns {
  const RowPack *first, *last;
  const Number* from;  // the next column
  std::ptrdiff_t from_stride;

  /// The next ones, as many as `to` has, each to the parent's column there.
  template <int Count>
  [[gnu::always_inline]] void add_to(Number* const (&to)[Count]) {
    for (const RowPack* pack = first; pack < last; ++pack) {
      const SpreadOf<Number> spread(pack->bits);
      const std::ptrdiff_t at = pack->to;
      const Number* child = from + pack->from;
#pragma GCC unroll 4
      for (int c = 0; c < Count; ++c, child += from_stride) {
        __builtin_prefetch(child + Count * from_stride);  // processors do not predict where the next columns' packs are
        store(to[c] + at, load(to[c] + at) + spread(child));
      }
    }
    from += Count * from_stride;
  }
};

}  // namespace

template <class Number>
Index pack_rows() {
  return lanes_of<Number>;
}

template <class Number>
void add_pack_columns(const FrontSum<Number>& sum, const RowPack* pack) {
  const std::ptrdiff_t to_stride = sum.to_stride;
  Columns<Number> columns{pack, sum.last, sum.from + pack->from * static_cast<std::ptrdiff_t>(sum.from_stride),
                          sum.from_stride};
  Number* const to = sum.to + (pack->to - sum.first) * to_stride - sum.first;
  std::uint32_t bits = pack->bits;
  const auto next = [&] {
    const int bit = __builtin_ctz(bits);
    bits &= bits - 1;
    return to + bit * to_stride;
  };
  int left = __builtin_popcount(bits);
  for (; left >= 4; left -= 4) columns.template add_to<4>({next(), next(), next(), next()});
  if (left >= 2) columns.template add_to<2>({next(), next()});
  if (left % 2 == 1) columns.template add_to<1>({next()});
}

template Index pack_rows<double>();
template Index pack_rows<float>();
template void add_pack_columns(const FrontSum<double>&, const RowPack*);
template void add_pack_columns(const FrontSum<float>&, const RowPack*);

}  // namespace softkin::linear::SOFTKIN_TARGET
