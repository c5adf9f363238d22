#include <softkin/energy/kernels/elastic_law_point.hpp>
#include <softkin/energy/kernels/elastic_polar.hpp>
#include <softkin/energy/kernels/rotation_wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

/// a / |a|, or 0
Pack3 unit(const Pack3& a) {
  constexpr double smallest = 1e-300;
  return (1 / sqrt(max(dot(a, a), pack(smallest)))) * a;
}

struct Quaternion {
  Pack largest;  // four times the square of the component that the candidate is built on
  PackRotation value;
};

void keep_larger(Quaternion& best, const Quaternion& other) {
  const PackMask take = other.largest > best.largest;
  best.largest = select(take, other.largest, best.largest);
  best.value.w = select(take, other.value.w, best.value.w);
  best.value.x = select(take, other.value.x, best.value.x);
  best.value.y = select(take, other.value.y, best.value.y);
  best.value.z = select(take, other.value.z, best.value.z);
}

/// Unit quaternion of a rotation matrix; of any other matrix, some unit quaternion.
PackRotation to_quaternion(const Pack33& r) {
  const Pack a = r.row[0].x, b = r.row[1].y, c = r.row[2].z;
  const Pack yz = r.row[2].y + r.row[1].z, zx = r.row[0].z + r.row[2].x, xy = r.row[1].x + r.row[0].y;
  const Pack wx = r.row[2].y - r.row[1].z, wy = r.row[0].z - r.row[2].x, wz = r.row[1].x - r.row[0].y;
  const Pack w = 1 + a + b + c, x = 1 + a - b - c, y = 1 - a + b - c, z = 1 - a - b + c;
  // the four squares add up to 4, so the largest component is well away from 0
  Quaternion best{w, {w, wx, wy, wz}};
  keep_larger(best, {x, {wx, x, xy, zx}});
  keep_larger(best, {y, {wy, xy, y, yz}});
  keep_larger(best, {z, {wz, zx, yz, z}});
  PackRotation& q = best.value;
  const Pack scale = 1 / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {scale * q.w, scale * q.x, scale * q.y, scale * q.z};
}

/// A rotation near the best one: the frame of the first two columns. Newton from the identity would not arrive in
/// elements that have turned far.
PackRotation guess_rotation(const Pack33& f) {
  const Pack33 columns = transposed(f);
  const Pack3 x = unit(columns.row[0]);
  const Pack3 y = unit(columns.row[1] - dot(columns.row[1], x) * x);
  return to_quaternion(transposed({{x, y, cross(x, y)}}));
}

/// One Jacobi rotation: makes pq zero. r is the index that is neither p nor q; of the axes, columns p and q turn.
struct Plane {
  Pack &pp, &qq, &pq, &pr, &qr;
  Pack3 &axis_p, &axis_q;
};

void turn_to_zero(const Plane& m) {
  // the smaller root of t^2 + t (qq - pp) / pq - 1 = 0; the tiny number keeps 0 / 0 away
  constexpr double smallest = 1e-300;
  const Pack difference = m.qq - m.pp, twice = 2 * m.pq;
  const Pack root = sqrt(difference * difference + twice * twice) + smallest;
  const Pack t = twice / select(difference < 0, difference - root, difference + root);
  const Pack c = 1 / sqrt(1 + t * t), s = t * c;
  m.pp -= t * m.pq;
  m.qq += t * m.pq;
  m.pq = pack(0);
  const Pack pr = m.pr;
  m.pr = c * pr - s * m.qr;
  m.qr = s * pr + c * m.qr;
  const Pack3 axis = m.axis_p;
  m.axis_p = c * axis - s * m.axis_q;
  m.axis_q = s * axis + c * m.axis_q;
}

}  // namespace

Polar polar(const Pack33& gradient) {
  PackRotation rotation = guess_rotation(gradient);
  best_rotation(gradient, rotation);
  Polar result;
  result.rotation = to_matrix(rotation);
  const Pack33 s = transpose_times(result.rotation, gradient);
  const Pack xy = 0.5 * (s.row[0].y + s.row[1].x), xz = 0.5 * (s.row[0].z + s.row[2].x),
             yz = 0.5 * (s.row[1].z + s.row[2].y);
  result.stretch = {{{s.row[0].x, xy, xz}, {xy, s.row[1].y, yz}, {xz, yz, s.row[2].z}}};
  return result;
}

Pack33 polar_turn_compliance(const Pack33& s) {
  // below this the smallest of the three stiffnesses is rounding
  constexpr double singular = 1e-9, smallest = 1e-60;
  const Pack total = trace(s);
  Pack33 g{{{-s.row[0].x, -s.row[0].y, -s.row[0].z},
            {-s.row[1].x, -s.row[1].y, -s.row[1].z},
            {-s.row[2].x, -s.row[2].y, -s.row[2].z}}};
  add_to_diagonal(g, total);
  Pack33 inverse = cofactor(g);
  const Pack determinant = dot(g.row[0], inverse.row[0]);
  const Pack scale = 1 / max(determinant, singular * abs(total * total * total) + smallest);
  for (Pack3& row : inverse.row) row = scale * row;
  return inverse;
}

Principal principal(const Pack33& symmetric) {
  constexpr int max_sweeps = 8;
  constexpr double negligible = 1e-34;  // of the squared size: off-diagonals below rounding
  Pack a = symmetric.row[0].x, b = symmetric.row[1].y, c = symmetric.row[2].z;
  Pack ab = symmetric.row[0].y, ac = symmetric.row[0].z, bc = symmetric.row[1].z;
  const Pack one = pack(1), zero = pack(0);
  Pack3 axis[3] = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  const Pack limit = negligible * inner(symmetric, symmetric);
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    if (!any(ab * ab + ac * ac + bc * bc > limit)) break;
    turn_to_zero({a, b, ab, ac, bc, axis[0], axis[1]});
    turn_to_zero({a, c, ac, ab, bc, axis[0], axis[2]});
    turn_to_zero({b, c, bc, ab, ac, axis[1], axis[2]});
  }
  return {{a, b, c}, transposed({{axis[0], axis[1], axis[2]}})};
}

}  // namespace softkin::energy::SOFTKIN_TARGET
