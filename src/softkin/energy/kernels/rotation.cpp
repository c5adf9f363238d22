#include <softkin/energy/kernels/rotation.hpp>
#include <softkin/energy/kernels/rotation_wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

/// Solves the symmetric 3 x 3 system [a b c; b d e; c e f] w = g by LDL^T; false where it is not positive definite.
PackMask solve_positive_definite(const Pack (&m)[6], const Pack3& g, const Pack& tiny, Pack3& w) {
  const auto& [a, b, c, d, e, f] = m;
  const Pack ia = 1 / a;
  const Pack l1 = b * ia, l2 = c * ia;
  const Pack d2 = d - l1 * b;
  const Pack id2 = 1 / d2;
  const Pack e2 = e - l1 * c;
  const Pack l3 = e2 * id2;
  const Pack d3 = f - l2 * c - l3 * e2;
  const Pack y1 = g.y - l1 * g.x;
  const Pack y2 = g.z - l2 * g.x - l3 * y1;
  w.z = y2 / d3;
  w.y = y1 * id2 - l3 * w.z;
  w.x = g.x * ia - l1 * w.y - l2 * w.z;
  return (a > tiny) & (d2 > tiny) & (d3 > tiny);
}

/// q <- q * (1, w / 2) / |...|
void turn(PackRotation& q, const Pack3& w) {
  const Pack3 h = pack(0.5) * w;
  const PackRotation p = q;
  const Pack scale = 1 / sqrt(1 + dot(h, h));
  q.w = scale * (p.w - p.x * h.x - p.y * h.y - p.z * h.z);
  q.x = scale * (p.x + p.w * h.x + p.y * h.z - p.z * h.y);
  q.y = scale * (p.y + p.w * h.y + p.z * h.x - p.x * h.z);
  q.z = scale * (p.z + p.w * h.z + p.x * h.y - p.y * h.x);
}

void solve_lane(const Pack33& correlation, int lane, PackRotation& rotation) {
  double h[9], q[4];
  for (int i = 0; i < 3; ++i) {
    h[3 * i] = correlation.row[i].x[lane];
    h[3 * i + 1] = correlation.row[i].y[lane];
    h[3 * i + 2] = correlation.row[i].z[lane];
  }
  davenport(h, q);
  rotation.w[lane] = q[0];
  rotation.x[lane] = q[1];
  rotation.y[lane] = q[2];
  rotation.z[lane] = q[3];
}

}  // namespace

Pack33 to_matrix(const PackRotation& q) {
  const Pack xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const Pack xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  const Pack wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)},
           {2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)},
           {2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)}}};
}

void best_rotation(const Pack33& h, PackRotation& rotation) {
  constexpr int max_turns = 6;
  // Newton converges cubically here: the turn after one below this is below rounding
  constexpr double small = 1e-10;
  const Pack scale = abs(h.row[0].x) + abs(h.row[0].y) + abs(h.row[0].z) + abs(h.row[1].x) + abs(h.row[1].y) +
                     abs(h.row[1].z) + abs(h.row[2].x) + abs(h.row[2].y) + abs(h.row[2].z);
  const Pack tiny = 1e-6 * scale;
  PackMask certain{};
  for (int i = 0; i < max_turns; ++i) {
    const Pack33 m = transpose_times(to_matrix(rotation), h);
    const Pack& a = m.row[0].x;
    const Pack& b = m.row[1].y;
    const Pack& c = m.row[2].z;
    const Pack3 slope{m.row[2].y - m.row[1].z, m.row[0].z - m.row[2].x, m.row[1].x - m.row[0].y};
    const Pack curvature[6] = {b + c, -0.5 * (m.row[0].y + m.row[1].x), -0.5 * (m.row[0].z + m.row[2].x),
                               a + c, -0.5 * (m.row[1].z + m.row[2].y), a + b};
    Pack3 w;
    const PackMask definite = solve_positive_definite(curvature, slope, tiny, w);
    const Pack size = dot(w, w);
    const PackMask usable = definite & (size < 4);
    certain = usable & (size < small);
    const Pack zero{};
    turn(rotation, {select(usable, w.x, zero), select(usable, w.y, zero), select(usable, w.z, zero)});
    // lanes that are not usable are left to the eigenproblem; the others go on until the last one is there
    if (!any(usable & ~certain)) break;
  }
  if (!any(~certain)) return;
  for (int l = 0; l < lanes; ++l)
    if (!certain[l]) solve_lane(h, l, rotation);
}

void to_matrix_of_blocks(const energy::PackRotation& rotation, double* kept) {
  keep(to_matrix(wide(rotation)), kept);
}

void best_rotation_of_blocks(const energy::Pack33& correlation, energy::PackRotation& rotation) {
  best_rotation(wide(correlation), wide(rotation));
}

}  // namespace softkin::energy::SOFTKIN_TARGET
