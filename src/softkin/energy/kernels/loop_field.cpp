#include <softkin/energy/kernels/loop_field.hpp>
#include <softkin/energy/kernels/wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

using FluxPoint = FluxPointOf<Pack>;

constexpr double pi = 3.14159265358979323846;

/// A number that depends on q = r^2 and z, from a loop's centre and along its axis: with its first derivatives, and its
/// second ones where they are requested.
template <bool Second>
struct Local {
  Pack value, q, z;
  Pack qq, qz, zz;
};

template <bool Second>
Local<Second> operator*(const Local<Second>& a, const Local<Second>& b) {
  Local<Second> product;
  product.value = a.value * b.value;
  product.q = a.value * b.q + b.value * a.q;
  product.z = a.value * b.z + b.value * a.z;
  if constexpr (Second) {
    product.qq = a.value * b.qq + b.value * a.qq + 2 * (a.q * b.q);
    product.qz = a.value * b.qz + b.value * a.qz + a.q * b.z + a.z * b.q;
    product.zz = a.value * b.zz + b.value * a.zz + 2 * (a.z * b.z);
  }
  return product;
}

template <bool Second>
Local<Second> combined(double x, const Local<Second>& a, double y, const Local<Second>& b) {
  Local<Second> sum;
  sum.value = x * a.value + y * b.value;
  sum.q = x * a.q + y * b.q;
  sum.z = x * a.z + y * b.z;
  if constexpr (Second) {
    sum.qq = x * a.qq + y * b.qq;
    sum.qz = x * a.qz + y * b.qz;
    sum.zz = x * a.zz + y * b.zz;
  }
  return sum;
}

/// f(a), by f and its derivatives there.
template <bool Second>
Local<Second> composed(const Local<Second>& a, const Pack& f, const Pack& f1, const Pack& f2) {
  Local<Second> of;
  of.value = f;
  of.q = f1 * a.q;
  of.z = f1 * a.z;
  if constexpr (Second) {
    of.qq = f1 * a.qq + f2 * (a.q * a.q);
    of.qz = f1 * a.qz + f2 * (a.q * a.z);
    of.zz = f1 * a.zz + f2 * (a.z * a.z);
  }
  return of;
}

/// (q + a^2)^(-n/2), by its value.
template <bool Second>
Local<Second> power(int n, const Pack& value, const Pack& inverse) {
  const Pack first = (-0.5 * n) * value * inverse;
  Local<Second> of{value, first, Pack{}, Pack{}, Pack{}, Pack{}};
  if constexpr (Second) of.qq = (-0.5 * n - 1) * first * inverse;
  return of;
}

/// Integrals over a loop's angle, k^2 = t: f of (1 - k cos)^-3/2 and g of cos (1 - k cos)^-3/2 / k, with derivatives by
/// t; h, of (1 - k cos)^-1/2, is 2 pi F(1/4, 3/4; 1; t), and f = h + t g, h' = g / 4.
struct LoopIntegrals {
  Pack f, f1, f2, g, g1, g2;
};

struct Series {
  static constexpr int terms = 32;  // of a quarter's powers, below rounding
  double h[terms], g[terms];
};
constexpr Series make_series() {
  Series series{};
  double of_h = 2 * pi, of_g = 1.5 * pi;
  for (int n = 0; n < Series::terms; ++n) {
    series.h[n] = of_h;
    series.g[n] = of_g;
    of_h *= (0.25 + n) * (0.75 + n) / ((1.0 + n) * (1.0 + n));
    of_g *= (1.25 + n) * (1.75 + n) / ((2.0 + n) * (1.0 + n));
  }
  return series;
}

LoopIntegrals by_series(const Pack& t) {
  static constexpr Series series = make_series();
  const int terms = any(t >= 0.08) ? Series::terms : any(t >= 0.02) ? 18 : 12;  // likewise of these powers
  LoopIntegrals of{};
  Pack h{}, half{};                       // half the second derivative of g
  for (int n = terms - 1; n >= 0; --n) {  // Horner's scheme, with the derivatives
    half = half * t + of.g1;
    of.g1 = of.g1 * t + of.g;
    of.g = of.g * t + series.g[n];
    h = h * t + series.h[n];
  }
  of.g2 = 2 * half;
  of.f = h + t * of.g;
  return of;
}

/// Complete elliptic integrals of m = 2 k / (1 + k) by arithmetic-geometric means.
LoopIntegrals by_means(const Pack& t) {
  const Pack k = sqrt(t), over = 1 / (1 + k);
  Pack a = pack(1), b = sqrt((1 - k) * over), sum = k * over;
  double weight = 0.5;
  for (int i = 0; i < 40 && any(a - b > 1e-16 * a); ++i) {
    const Pack c = 0.5 * (a - b), next = 0.5 * (a + b);
    b = sqrt(a * b);
    a = next;
    weight *= 2;
    sum += weight * c * c;
  }
  const Pack first = (0.5 * pi) / a, root = sqrt(over);
  const Pack h = 4 * first * root;
  LoopIntegrals of;
  of.f = 4 * first * (1 - sum) * root / (1 - k);
  of.g = (of.f - h) / t;
  // the hypergeometric equation of h, and its derivative
  const Pack per = 1 / (t * (1 - t)), slant = 1 - 2 * t;
  of.g1 = (0.75 * h - slant * of.g) * per;
  of.g2 = ((35.0 / 16) * of.g - 2 * slant * of.g1) * per;
  return of;
}

LoopIntegrals integrals(const Pack& t) {
  const PackMask small = t < 0.25;
  LoopIntegrals of{};
  if (any(small)) of = by_series(min(t, pack(0.25)));
  if (any(~small)) {
    const LoopIntegrals large = by_means(max(t, pack(0.25)));
    of = {select(small, of.f, large.f),  Pack{}, Pack{}, select(small, of.g, large.g), select(small, of.g1, large.g1),
          select(small, of.g2, large.g2)};
  }
  of.f1 = 1.25 * of.g + t * of.g1;
  of.f2 = 2.25 * of.g1 + t * of.g2;
  return of;
}

/// Along the axis and, over rho, away from it, times what is common.
template <bool Second>
struct Parts {
  Local<Second> axial, radial;
};

template <bool Second>
Parts<Second> parts_of(double radius, double scale, const Pack& q, const Pack& z, PackMask& known) {
  const double a = radius, aa = radius * radius;
  const Pack one = pack(1), none{};
  const Pack inverse = 1 / (q + aa), root = sqrt(inverse), square = inverse * inverse;
  const Local<Second> across{max(q - z * z, none), one, -2 * z, none, none, pack(-2)};  // rho^2
  const Local<Second> along{z, none, one, none, none, none};
  Local<Second> t = across * power<Second>(4, square, inverse);
  t = combined(4 * aa, t, 0, t);
  known = t.value < 1;
  t.value = select(known, t.value, none);
  const LoopIntegrals of = integrals(t.value);
  const Local<Second> f = composed(t, of.f, of.f1, of.f2), g = composed(t, of.g, of.g1, of.g2);
  const Local<Second> third = power<Second>(3, root * inverse, inverse);
  Parts<Second> parts;
  const Local<Second> less = across * power<Second>(2, inverse, inverse) * g;
  const Local<Second> straight = third * combined(a * a * scale, f, -2 * aa * scale, less);
  parts.radial = along * power<Second>(5, root * square, inverse) * g;
  parts.radial = combined(2 * aa * scale, parts.radial, 0, parts.radial);
  parts.axial = combined(1, straight, -1, parts.radial * along);
  return parts;
}

Pack33 outer(const Pack3& a, const Pack3& b) {
  return {{a.x * b, a.y * b, a.z * b}};
}
void add(Pack33& sum, const Pack& scale, const Pack33& a) {
  for (int i = 0; i < 3; ++i) sum.row[i] = sum.row[i] + scale * a.row[i];
}

/// By place: of a number that depends on q and z.
template <bool Second>
Pack3 gradient(const Local<Second>& a, const Pack3& from, const Pack3& axis) {
  return 2 * a.q * from + a.z * axis;
}
Pack33 curvature(const Local<true>& a, const Pack3& from, const Pack3& axis) {
  Pack33 second{};
  const Pack3 mixed = 2 * a.qz * axis + 4 * a.qq * from;
  add(second, pack(1), outer(from, mixed));
  add(second, pack(1), outer(axis, 2 * a.qz * from + a.zz * axis));
  for (int i = 0; i < 3; ++i) (&second.row[i].x)[i] += 2 * a.q;
  return second;
}

template <bool Second>
void add_parts(const Parts<Second>& parts, const Pack3& from, const Pack3& axis, FluxPoint& out) {
  const Pack3 axial = gradient(parts.axial, from, axis), radial = gradient(parts.radial, from, axis);
  const Pack *direction = &axis.x, *offset = &from.x;
  out.value = out.value + parts.axial.value * axis + parts.radial.value * from;
  for (int i = 0; i < 3; ++i) {
    Pack3& row = out.slope.row[i];
    row = row + direction[i] * axial + offset[i] * radial;
    (&row.x)[i] += parts.radial.value;
  }
  if constexpr (Second) {
    const Pack33 of_axial = curvature(parts.axial, from, axis), of_radial = curvature(parts.radial, from, axis);
    for (int i = 0; i < 3; ++i) {
      Pack33& second = out.second[i];
      add(second, direction[i], of_axial);
      add(second, offset[i], of_radial);
      second.row[i] = second.row[i] + radial;
      for (int j = 0; j < 3; ++j) (&second.row[j].x)[i] += (&radial.x)[j];
    }
  }
}

template <bool Second>
void add_loop(const LoopOfCurrent& loop, const Pack3& place, FluxPoint& out, PackMask& known) {
  const Pack3 axis{pack(loop.axis[0]), pack(loop.axis[1]), pack(loop.axis[2])};
  const Pack3 from{place.x - loop.center[0], place.y - loop.center[1], place.z - loop.center[2]};
  add_parts(parts_of<Second>(loop.radius_mm, loop.scale, dot(from, from), dot(from, axis), known), from, axis, out);
}

}  // namespace

void add_loop(const LoopOfCurrent& loop, const energy::Pack3& place, bool second, energy::FluxPoint& out,
              energy::PackMask& known) {
  FluxPoint& sum = reinterpret_cast<FluxPoint&>(out);
  PackMask& where = reinterpret_cast<PackMask&>(known);
  second ? add_loop<true>(loop, wide(place), sum, where) : add_loop<false>(loop, wide(place), sum, where);
}

}  // namespace softkin::energy::SOFTKIN_TARGET
