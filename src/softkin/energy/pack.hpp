#pragma once

#include <cmath>

namespace softkin::energy {

/// Elements that a kernel handles at once: a lane each.
inline constexpr int lanes = 8;

/// One number per lane. Arithmetic and comparisons work lane by lane.
typedef double Pack __attribute__((vector_size(lanes * sizeof(double))));
typedef long long PackMask __attribute__((vector_size(lanes * sizeof(long long))));

inline Pack pack(double value) {
  return Pack{} + value;
}

inline Pack sqrt(const Pack& a) {
  Pack root;
  for (int l = 0; l < lanes; ++l) root[l] = std::sqrt(a[l]);
  return root;
}

inline Pack log(const Pack& a) {
  Pack logarithm;
  for (int l = 0; l < lanes; ++l) logarithm[l] = std::log(a[l]);
  return logarithm;
}

inline Pack select(const PackMask& condition, const Pack& yes, const Pack& no) {
  return condition ? yes : no;
}

inline Pack min(const Pack& a, const Pack& b) {
  return a < b ? a : b;
}

inline Pack max(const Pack& a, const Pack& b) {
  return a > b ? a : b;
}

inline Pack abs(const Pack& a) {
  return a < 0 ? -a : a;
}

inline bool any(const PackMask& mask) {
  long long all = 0;
  for (int l = 0; l < lanes; ++l) all |= mask[l];
  return all != 0;
}

/// a^(-1/3) to a few units in the last place, without a division.
///
/// source  a third of the exponent's bits, 3 % off (W. Kahan), then twice the series of (1 - h)^(-1/3), h = 1 - a r^3:
///         |h| < 0.103, then 5e-6
inline Pack inverse_cbrt(const Pack& a) {
  const PackMask ordinary = (a > 1e-290) & (a < 1e290);
  if (any(~ordinary)) {
    Pack root;
    for (int l = 0; l < lanes; ++l) root[l] = 1 / std::cbrt(a[l]);
    return root;
  }
  const PackMask third = (((PackMask)a >> 32) * 0x55555556) >> 32;
  Pack root = (Pack)((1430186000 - third) << 32);
  const Pack first = 1 - a * root * root * root;
  root += root * first * (1.0 / 3 + first * (2.0 / 9 + first * (14.0 / 81 + first * (35.0 / 243))));
  const Pack second = 1 - a * root * root * root;
  return root + root * second * (1.0 / 3 + second * (2.0 / 9));
}

/// As inverse_cbrt(); 0 of 0.
inline Pack cbrt(const Pack& a) {
  const Pack root = inverse_cbrt(a);
  return select(a == 0, a, a * root * root);
}

inline double sum(const Pack& a) {
  double total = 0;
  for (int l = 0; l < lanes; ++l) total += a[l];
  return total;
}

/// Three coordinates of a point in every lane.
struct Pack3 {
  Pack x, y, z;
};

inline Pack3 operator+(const Pack3& a, const Pack3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

inline Pack3 operator-(const Pack3& a, const Pack3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline Pack3 operator*(const Pack& s, const Pack3& a) {
  return {s * a.x, s * a.y, s * a.z};
}

inline Pack dot(const Pack3& a, const Pack3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline Pack3 cross(const Pack3& a, const Pack3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline Pack norm(const Pack3& a) {
  return sqrt(dot(a, a));
}

/// A 3 x 3 matrix in every lane, by rows.
struct Pack33 {
  Pack3 row[3];
};

inline Pack3 operator*(const Pack33& a, const Pack3& b) {
  return {dot(a.row[0], b), dot(a.row[1], b), dot(a.row[2], b)};
}

/// a^T b
inline Pack33 transpose_times(const Pack33& a, const Pack33& b) {
  Pack33 c;
  c.row[0] = a.row[0].x * b.row[0] + a.row[1].x * b.row[1] + a.row[2].x * b.row[2];
  c.row[1] = a.row[0].y * b.row[0] + a.row[1].y * b.row[1] + a.row[2].y * b.row[2];
  c.row[2] = a.row[0].z * b.row[0] + a.row[1].z * b.row[1] + a.row[2].z * b.row[2];
  return c;
}

/// The same K points of a shape in every lane.
template <int K>
using Shape = Pack3[K];

/// Moves the shape's mean to the origin: V <- N V, N = I - 11^T / K, Eq. (2).
template <int K>
inline void center(Shape<K>& shape) {
  Pack3 mean = shape[0];
  for (int i = 1; i < K; ++i) mean = mean + shape[i];
  mean = pack(1.0 / K) * mean;
  for (int i = 0; i < K; ++i) shape[i] = shape[i] - mean;
}

}  // namespace softkin::energy
