#pragma once

#include <cstdint>

namespace softkin::energy {

/// Elements that a kernel handles at once: a lane each.
inline constexpr int lanes = 8;

/// One truth a lane: all bits or none. As PackOf.
template <int Bytes>
struct MaskOf {
  static constexpr int parts = lanes * static_cast<int>(sizeof(std::int64_t)) / Bytes, each = lanes / parts;
  typedef std::int64_t Part __attribute__((vector_size(Bytes), may_alias));
  alignas(64) Part part[parts];

  [[nodiscard]] std::int64_t operator[](int lane) const { return part[lane / each][lane % each]; }
};

/// One number a lane, in vectors of so many bytes: the registers of the instruction set that works on it. All have the
/// same layout. Arithmetic and comparisons work lane by lane.
template <int Bytes>
struct PackOf {
  using Mask = MaskOf<Bytes>;
  static constexpr int parts = Mask::parts, each = Mask::each;
  typedef double Part __attribute__((vector_size(Bytes), may_alias));
  alignas(64) Part part[parts];

  [[nodiscard]] double operator[](int lane) const { return part[lane / each][lane % each]; }
  [[nodiscard]] double& operator[](int lane) { return reinterpret_cast<double*>(part)[lane]; }
};

#define SOFTKIN_INLINE [[gnu::always_inline]] inline

/// f of every part of one or more packs.
template <int B, class F, class... Others>
SOFTKIN_INLINE PackOf<B> each_part(const F& f, const PackOf<B>& a, const Others&... others) {
  PackOf<B> r;
#pragma GCC unroll 8
  for (int p = 0; p < PackOf<B>::parts; ++p) r.part[p] = f(a.part[p], others.part[p]...);
  return r;
}
template <int B, class F, class... Others>
SOFTKIN_INLINE MaskOf<B> mask_part(const F& f, const PackOf<B>& a, const Others&... others) {
  MaskOf<B> r;
#pragma GCC unroll 8
  for (int p = 0; p < PackOf<B>::parts; ++p) r.part[p] = f(a.part[p], others.part[p]...);
  return r;
}

#define SOFTKIN_OPERATOR(op)                                                         \
  template <int B>                                                                   \
  SOFTKIN_INLINE PackOf<B> operator op(const PackOf<B>& a, const PackOf<B>& b) {     \
    return each_part(                                                                \
        [](auto x, auto y) __attribute__((always_inline)) { return x op y; }, a, b); \
  }                                                                                  \
  template <int B>                                                                   \
  SOFTKIN_INLINE PackOf<B> operator op(const PackOf<B>& a, double b) {               \
    return each_part(                                                                \
        [b](auto x) __attribute__((always_inline)) { return x op b; }, a);           \
  }                                                                                  \
  template <int B>                                                                   \
  SOFTKIN_INLINE PackOf<B> operator op(double a, const PackOf<B>& b) {               \
    return each_part(                                                                \
        [a](auto y) __attribute__((always_inline)) { return a op y; }, b);           \
  }                                                                                  \
  template <int B, class Other>                                                      \
  SOFTKIN_INLINE PackOf<B>& operator op##=(PackOf<B>& a, const Other& b) {           \
    return a = a op b;                                                               \
  }
SOFTKIN_OPERATOR(+)
SOFTKIN_OPERATOR(-)
SOFTKIN_OPERATOR(*)
SOFTKIN_OPERATOR(/)
#undef SOFTKIN_OPERATOR

#define SOFTKIN_COMPARISON(op)                                                       \
  template <int B>                                                                   \
  SOFTKIN_INLINE MaskOf<B> operator op(const PackOf<B>& a, const PackOf<B>& b) {     \
    return mask_part(                                                                \
        [](auto x, auto y) __attribute__((always_inline)) { return x op y; }, a, b); \
  }                                                                                  \
  template <int B>                                                                   \
  SOFTKIN_INLINE MaskOf<B> operator op(const PackOf<B>& a, double b) {               \
    return mask_part(                                                                \
        [b](auto x) __attribute__((always_inline)) { return x op b; }, a);           \
  }
SOFTKIN_COMPARISON(<)
SOFTKIN_COMPARISON(>)
SOFTKIN_COMPARISON(<=)
SOFTKIN_COMPARISON(>=)
SOFTKIN_COMPARISON(==)
#undef SOFTKIN_COMPARISON

#define SOFTKIN_MASKS(op)                                                          \
  template <int B>                                                                 \
  SOFTKIN_INLINE MaskOf<B> operator op(const MaskOf<B>& a, const MaskOf<B>& b) {   \
    MaskOf<B> r;                                                                   \
    for (int p = 0; p < MaskOf<B>::parts; ++p) r.part[p] = a.part[p] op b.part[p]; \
    return r;                                                                      \
  }                                                                                \
  template <int B>                                                                 \
  SOFTKIN_INLINE MaskOf<B>& operator op##=(MaskOf<B>& a, const MaskOf<B>& b) {     \
    return a = a op b;                                                             \
  }
SOFTKIN_MASKS(&)
SOFTKIN_MASKS(|)
#undef SOFTKIN_MASKS

template <int B>
SOFTKIN_INLINE MaskOf<B> operator~(const MaskOf<B>& a) {
  MaskOf<B> r;
  for (int p = 0; p < MaskOf<B>::parts; ++p) r.part[p] = ~a.part[p];
  return r;
}

template <int B>
SOFTKIN_INLINE PackOf<B> operator-(const PackOf<B>& a) {
  return each_part(
      [](auto x) __attribute__((always_inline)) { return -x; }, a);
}

template <class Pack>
SOFTKIN_INLINE Pack pack_of(double value) {
  return Pack{} + value;
}

/// f of every lane.
template <int B, class F>
SOFTKIN_INLINE PackOf<B> each_lane(const PackOf<B>& a, const F& f) {
  PackOf<B> r;
  for (int p = 0; p < PackOf<B>::parts; ++p)
    for (int l = 0; l < PackOf<B>::each; ++l) r.part[p][l] = f(a.part[p][l]);
  return r;
}

template <int B>
inline PackOf<B> sqrt(const PackOf<B>& a) {
  return each_lane(a, [](double x) { return __builtin_sqrt(x); });
}

template <int B>
inline PackOf<B> log(const PackOf<B>& a) {
  return each_lane(a, [](double x) { return __builtin_log(x); });
}

template <int B>
SOFTKIN_INLINE PackOf<B> select(const MaskOf<B>& condition, const PackOf<B>& yes, const PackOf<B>& no) {
  return each_part(
      [](auto y, auto n, auto c) __attribute__((always_inline)) { return c ? y : n; }, yes, no, condition);
}

template <int B>
SOFTKIN_INLINE PackOf<B> min(const PackOf<B>& a, const PackOf<B>& b) {
  return each_part(
      [](auto x, auto y) __attribute__((always_inline)) { return x < y ? x : y; }, a, b);
}

template <int B>
SOFTKIN_INLINE PackOf<B> max(const PackOf<B>& a, const PackOf<B>& b) {
  return each_part(
      [](auto x, auto y) __attribute__((always_inline)) { return x > y ? x : y; }, a, b);
}

template <int B>
SOFTKIN_INLINE PackOf<B> abs(const PackOf<B>& a) {
  return each_part(
      [](auto x) __attribute__((always_inline)) { return x < 0 ? -x : x; }, a);
}

template <int B>
SOFTKIN_INLINE bool any(const MaskOf<B>& mask) {
  auto all = mask.part[0];
  for (int p = 1; p < MaskOf<B>::parts; ++p) all |= mask.part[p];
  std::int64_t some = 0;
  for (int l = 0; l < MaskOf<B>::each; ++l) some |= all[l];
  return some != 0;
}

/// a^(-1/3) to a few units in the last place, without a division.
///
/// source  a third of the exponent's bits, 3 % off (W. Kahan), then twice the series of (1 - h)^(-1/3), h = 1 - a r^3:
///         |h| < 0.103, then 5e-6
template <int B>
inline PackOf<B> inverse_cbrt(const PackOf<B>& a) {
  const MaskOf<B> ordinary = (a > 1e-290) & (a < 1e290);
  if (any(~ordinary)) return each_lane(a, [](double x) { return 1 / __builtin_cbrt(x); });
  return each_part(
      [](auto x) __attribute__((always_inline)) {
        using Bits = typename MaskOf<B>::Part;
        using Part = typename PackOf<B>::Part;
        const Bits third = (((Bits)x >> 32) * 0x55555556) >> 32;
        const Bits guess = (1430186000 - third) << 32;
        Part root = (Part)guess;
        const Part first = 1 - x * root * root * root;
        root += root * first * (1.0 / 3 + first * (2.0 / 9 + first * (14.0 / 81 + first * (35.0 / 243))));
        const Part second = 1 - x * root * root * root;
        return root + root * second * (1.0 / 3 + second * (2.0 / 9));
      },
      a);
}

/// As inverse_cbrt(); 0 of 0.
template <int B>
inline PackOf<B> cbrt(const PackOf<B>& a) {
  const PackOf<B> root = inverse_cbrt(a);
  return select(a == 0, a, a * root * root);
}

template <int B>
SOFTKIN_INLINE double sum(const PackOf<B>& a) {
  double total = 0;
  for (int l = 0; l < lanes; ++l) total += a[l];
  return total;
}

/// Three coordinates of a point in every lane.
template <class Pack>
struct Pack3Of {
  Pack x, y, z;
};

template <class P>
SOFTKIN_INLINE Pack3Of<P> operator+(const Pack3Of<P>& a, const Pack3Of<P>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class P>
SOFTKIN_INLINE Pack3Of<P> operator-(const Pack3Of<P>& a, const Pack3Of<P>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class P>
SOFTKIN_INLINE Pack3Of<P> operator*(const P& s, const Pack3Of<P>& a) {
  return {s * a.x, s * a.y, s * a.z};
}

template <class P>
SOFTKIN_INLINE P dot(const Pack3Of<P>& a, const Pack3Of<P>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class P>
SOFTKIN_INLINE Pack3Of<P> cross(const Pack3Of<P>& a, const Pack3Of<P>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class P>
SOFTKIN_INLINE P norm(const Pack3Of<P>& a) {
  return sqrt(dot(a, a));
}

/// A 3 x 3 matrix in every lane, by rows.
template <class Pack>
struct Pack33Of {
  Pack3Of<Pack> row[3];
};

template <class P>
SOFTKIN_INLINE Pack3Of<P> operator*(const Pack33Of<P>& a, const Pack3Of<P>& b) {
  return {dot(a.row[0], b), dot(a.row[1], b), dot(a.row[2], b)};
}

/// a^T b
template <class P>
SOFTKIN_INLINE Pack33Of<P> transpose_times(const Pack33Of<P>& a, const Pack33Of<P>& b) {
  Pack33Of<P> c;
  c.row[0] = a.row[0].x * b.row[0] + a.row[1].x * b.row[1] + a.row[2].x * b.row[2];
  c.row[1] = a.row[0].y * b.row[0] + a.row[1].y * b.row[1] + a.row[2].y * b.row[2];
  c.row[2] = a.row[0].z * b.row[0] + a.row[1].z * b.row[1] + a.row[2].z * b.row[2];
  return c;
}

/// Moves the shape's mean to the origin: V <- N V, N = I - 11^T / K, Eq. (2).
template <int K, class P>
SOFTKIN_INLINE void center(Pack3Of<P> (&shape)[K]) {
  Pack3Of<P> mean = shape[0];
  for (int i = 1; i < K; ++i) mean = mean + shape[i];
  mean = pack_of<P>(1.0 / K) * mean;
  for (int i = 0; i < K; ++i) shape[i] = shape[i] - mean;
}

/// Unit quaternions, one per lane; w is the real part.
template <class Pack>
struct PackRotationOf {
  Pack w = pack_of<Pack>(1), x{}, y{}, z{};
};

/// As blocks of elements have them, whatever instruction set works on them.
using Pack = PackOf<16>;
using PackMask = MaskOf<16>;
using Pack3 = Pack3Of<Pack>;
using Pack33 = Pack33Of<Pack>;
using PackRotation = PackRotationOf<Pack>;
/// The same K points of a shape in every lane.
template <int K>
using Shape = Pack3[K];

inline Pack pack(double value) {
  return pack_of<Pack>(value);
}

}  // namespace softkin::energy
