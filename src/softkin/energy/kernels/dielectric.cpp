#include <softkin/energy/kernels/elastic_law_point.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

constexpr int nodes = 6, points = 6;

/// A quadrature point: h = F^-T E_0, the true field, and s_a = F^-T slope_a.
struct FieldPoint {
  Pack jacobian;
  Pack weight;  // eps / 2 J times the rest volume
  Pack square;  // |h|^2
  Pack3 field;
  Pack3 slope[nodes];
  Pack along[nodes];  // h . s_a
};

FieldPoint field_point(const DielectricPrisms& prisms, int q, const Pack& permittivity, double voltage_kV,
                       const Shape<nodes>& current) {
  const Pack33 f = deformation_gradient<nodes>(prisms.slope[q], current);
  const Pack33 turned = cofactor(f);
  FieldPoint point;
  point.jacobian = dot(f.row[0], turned.row[0]);
  const Pack j = positive_jacobian(point.jacobian), per_j = 1 / j;
  for (int a = 0; a < nodes; ++a) point.slope[a] = per_j * (turned * prisms.slope[q][a]);
  point.field = pack(voltage_kV) * (point.slope[3] + point.slope[4] + point.slope[5]);
  point.square = dot(point.field, point.field);
  point.weight = 0.5 * permittivity * j * prisms.volume[q];
  for (int a = 0; a < nodes; ++a) point.along[a] = dot(point.field, point.slope[a]);
  return point;
}

/// From J' = J s_b . x_b', h' = -s_b (h . x_b') and s_a' = -s_b (s_a . x_b').
void add_second(const FieldPoint& p, int a, int b, Pack33& k) {
  const Pack3 &sa = p.slope[a], &sb = p.slope[b], &h = p.field;
  const Pack &ha = p.along[a], &hb = p.along[b];
  Pack33 block{};
  add_outer(block, p.square * sa - 2 * ha * h, sb);
  add_outer(block, -2 * hb * sa + 2 * ha * sb, h);
  add_outer(block, 2 * hb * h - p.square * sb, sa);
  add_outer(block, 2 * dot(sa, sb) * h, h);
  for (int i = 0; i < 3; ++i) k.row[i] = k.row[i] - p.weight * block.row[i];
}

}  // namespace

void add_dielectric_force(const energy::DielectricPrisms& elements, const energy::Pack& constant, double voltage_kV,
                          const energy::Shape<nodes>& shape, energy::ElasticForce<nodes>& force) {
  const DielectricPrisms& prisms = wide(elements);
  const Pack& permittivity = wide(constant);
  const Shape<nodes>& current = wide(shape);
  ElasticForce<nodes>& out = wide(force);
  const PackMask charged = permittivity * voltage_kV * voltage_kV > 0;
  for (int q = 0; q < points; ++q) {
    const FieldPoint p = field_point(prisms, q, permittivity, voltage_kV, current);
    out.energy -= p.weight * p.square;
    out.forbidden |= (p.jacobian <= 0) & (prisms.volume[q] > 0) & charged;
    for (int a = 0; a < nodes; ++a)
      out.gradient[a] = out.gradient[a] - p.weight * (p.square * p.slope[a] - 2 * p.along[a] * p.field);
  }
}

void add_maxwell_stress(const energy::DielectricPrisms& elements, const energy::Pack& constant, double voltage_kV,
                        const energy::Shape<nodes>& shape, energy::Pack33 (&out)[points]) {
  const DielectricPrisms& prisms = wide(elements);
  const Pack& permittivity = wide(constant);
  const Shape<nodes>& current = wide(shape);
  Pack33(&stress)[points] = wide(out);
  for (int q = 0; q < points; ++q) {
    const FieldPoint p = field_point(prisms, q, permittivity, voltage_kV, current);
    add_outer(stress[q], permittivity * p.field, p.field);
    add_to_diagonal(stress[q], -0.5 * permittivity * p.square);
  }
}

void add_dielectric_stiffness(const energy::DielectricPrisms& elements, const energy::Pack& constant, double voltage_kV,
                              const energy::Shape<nodes>& shape, energy::ElasticStiffness<nodes>& stiffness) {
  const DielectricPrisms& prisms = wide(elements);
  const Pack& permittivity = wide(constant);
  const Shape<nodes>& current = wide(shape);
  ElasticStiffness<nodes>& out = wide(stiffness);
  FieldPoint at[points];
  for (int q = 0; q < points; ++q) at[q] = field_point(prisms, q, permittivity, voltage_kV, current);
  for (int a = 0, ab = 0; a < nodes; ++a)
    for (int b = 0; b <= a; ++b, ++ab)
      for (const FieldPoint& p : at) add_second(p, a, b, out.block[ab]);
}

}  // namespace softkin::energy::SOFTKIN_TARGET
