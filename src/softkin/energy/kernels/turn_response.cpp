#include <softkin/energy/kernels/turn_response.hpp>
#include <softkin/energy/kernels/turn_response_wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

typedef Pack Matrix[3][3];

Pack trace(const Pack33& a) {
  return a.row[0].x + a.row[1].y + a.row[2].z;
}

/// Inverse of the lower Cholesky factor; `tiny` is added where a pivot is below it.
void inverse_factor(const Pack33& a, const Pack& tiny, Matrix& inverse) {
  const Pack l00 = sqrt(max(a.row[0].x, tiny));
  const Pack l10 = a.row[1].x / l00, l20 = a.row[2].x / l00;
  const Pack l11 = sqrt(max(a.row[1].y - l10 * l10, tiny));
  const Pack l21 = (a.row[2].y - l20 * l10) / l11;
  const Pack l22 = sqrt(max(a.row[2].z - l20 * l20 - l21 * l21, tiny));
  for (auto& row : inverse)
    for (Pack& entry : row) entry = pack(0);
  inverse[0][0] = 1 / l00;
  inverse[1][1] = 1 / l11;
  inverse[2][2] = 1 / l22;
  inverse[1][0] = -l10 * inverse[0][0] * inverse[1][1];
  inverse[2][1] = -l21 * inverse[1][1] * inverse[2][2];
  inverse[2][0] = -(l20 * inverse[0][0] + l21 * inverse[1][0]) * inverse[2][2];
}

/// One Jacobi rotation: makes a[p][q] zero, turns the columns p, q of `vectors` along.
void turn(int p, int q, Matrix& a, Matrix& vectors) {
  const Pack difference = a[q][q] - a[p][p], twice = 2 * a[p][q];
  const Pack root = sqrt(difference * difference + twice * twice);
  const Pack below = select(difference < 0, -1 * (abs(difference) + root), abs(difference) + root);
  const Pack tangent = select(below == 0, pack(0), twice / select(below == 0, pack(1), below));
  const Pack c = 1 / sqrt(1 + tangent * tangent), s = tangent * c;
  for (int k = 0; k < 3; ++k) {  // columns
    const Pack x = a[k][p], y = a[k][q];
    a[k][p] = c * x - s * y;
    a[k][q] = s * x + c * y;
    const Pack u = vectors[k][p], v = vectors[k][q];
    vectors[k][p] = c * u - s * v;
    vectors[k][q] = s * u + c * v;
  }
  for (int k = 0; k < 3; ++k) {  // rows
    const Pack x = a[p][k], y = a[q][k];
    a[p][k] = c * x - s * y;
    a[q][k] = s * x + c * y;
  }
}

}  // namespace

Pack33 turn_response(const Pack33& m) {
  constexpr double singular = 1e-12;
  const Pack3 a = cross(m.row[1], m.row[2]), b = cross(m.row[2], m.row[0]), c = cross(m.row[0], m.row[1]);
  const Pack determinant = dot(m.row[0], a), size = trace(m);
  const Pack scale = select(determinant > singular * size * size * size, 1 / determinant, pack(0));
  return {{{scale * a.x, scale * b.x, scale * c.x},
           {scale * a.y, scale * b.y, scale * c.y},
           {scale * a.z, scale * b.z, scale * c.z}}};
}

Pack33 turn_response(const Pack33& stiffness, const Pack33& metric, const Pack& least) {
  constexpr double relative = 1e-14;
  constexpr int sweeps = 5;  // quadratic: the off-diagonal is below rounding after four
  const Pack size = trace(metric);
  const PackMask usable = size > 0;
  Matrix lower, scaled, turned{}, half;
  inverse_factor(metric, select(usable, relative * size, pack(1)), lower);
  const Pack33& m = stiffness;
  const Matrix full{
      {m.row[0].x, m.row[0].y, m.row[0].z}, {m.row[1].x, m.row[1].y, m.row[1].z}, {m.row[2].x, m.row[2].y, m.row[2].z}};
  for (int i = 0; i < 3; ++i) {
    turned[i][i] = pack(1);
    for (int j = 0; j < 3; ++j)
      half[i][j] = lower[i][0] * full[0][j] + lower[i][1] * full[1][j] + lower[i][2] * full[2][j];
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      scaled[i][j] = half[i][0] * lower[j][0] + half[i][1] * lower[j][1] + half[i][2] * lower[j][2];
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    turn(0, 1, scaled, turned);
    turn(0, 2, scaled, turned);
    turn(1, 2, scaled, turned);
  }
  Pack3 vectors[3];  // L^-T Q
  Pack33 out{};
  for (int k = 0; k < 3; ++k) {
    Pack* entries[3] = {&vectors[k].x, &vectors[k].y, &vectors[k].z};
    for (int i = 0; i < 3; ++i)
      *entries[i] = lower[0][i] * turned[0][k] + lower[1][i] * turned[1][k] + lower[2][i] * turned[2][k];
    const Pack fraction = select(usable, 1 / max(scaled[k][k], least), pack(0));
    out.row[0] = out.row[0] + (fraction * vectors[k].x) * vectors[k];
    out.row[1] = out.row[1] + (fraction * vectors[k].y) * vectors[k];
    out.row[2] = out.row[2] + (fraction * vectors[k].z) * vectors[k];
  }
  return out;
}

void turn_response_of_blocks(const energy::Pack33& stiffness, double* kept) {
  keep(turn_response(wide(stiffness)), kept);
}
void turn_response_of_blocks(const energy::Pack33& stiffness, const energy::Pack33& metric, const energy::Pack& least,
                             double* kept) {
  keep(turn_response(wide(stiffness), wide(metric), wide(least)), kept);
}

}  // namespace softkin::energy::SOFTKIN_TARGET
