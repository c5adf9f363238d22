#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <softkin/energy/dielectric.hpp>
#include <softkin/statics/electric_layer.hpp>

namespace softkin {

namespace {

using PrismNodes = Eigen::Matrix<double, 6, 3>;

PrismNodes nodes_of(const Points& positions, const Prism& prism) {
  PrismNodes nodes;
  for (int i = 0; i < 6; ++i) nodes.row(i) = positions.row(prism[i]);
  return nodes;
}

double thickness(const PrismNodes& nodes, double volume_mm3) {
  double area = 0;
  for (int t = 0; t < 6; t += 3) {
    const Vec3 u = nodes.row(t + 1) - nodes.row(t), v = nodes.row(t + 2) - nodes.row(t);
    area += 0.25 * u.cross(v).norm();
  }
  return volume_mm3 / area;
}

/// Capacity of a prism, its largest true field per voltage [1/mm], and its volume [mm^3].
struct PrismField {
  double capacity_mm = 0;  // integral of J |F^-T grad zeta|^2
  double field_per_mm = 0;
  double volume_mm3 = 0;
};

PrismField field_of(const PrismNodes& rest, const PrismNodes& nodes) {
  const energy::ElasticRest<6, 6> shape = energy::elastic_rest(rest);
  PrismField field;
  for (int q = 0; q < 6; ++q) {
    const Mat3 gradient = nodes.transpose() * shape.slope[q];
    const double j = gradient.determinant();
    const Vec3 across = shape.slope[q].bottomRows<3>().colwise().sum().transpose();
    const Vec3 spread = gradient.transpose().inverse() * across;
    field.capacity_mm += j * spread.squaredNorm() * shape.volume[q];
    field.field_per_mm = std::max(field.field_per_mm, spread.norm());
    field.volume_mm3 += j * shape.volume[q];
  }
  return field;
}

}  // namespace

std::vector<double> layer_permittivity(const Model& model, Index actuator) {
  std::vector<double> permittivity(model.elements.prisms.size(), 0);
  const auto& dea = std::get<DeaDrive>(model.actuators[actuator].drive);
  for (std::size_t i = 0; i < dea.prisms.size(); ++i) {
    const Index e = dea.prisms[i];
    permittivity[e] = energy::vacuum_permittivity_MPa *
                      model.elements.materials[model.elements.prism_roles[e].material].permittivity * dea.fractions[i] *
                      dea.fractions[i];
  }
  return permittivity;
}

ElectricLayer electric_layer(const Model& model, Index actuator, const Points& positions, double voltage_kV) {
  constexpr double pF_per_unit = 1e3;  // mJ per kV^2 are nF
  const auto& dea = std::get<DeaDrive>(model.actuators[actuator].drive);
  const std::vector<double> permittivity = layer_permittivity(model, actuator);
  ElectricLayer layer;
  double most = -1;
  for (std::size_t i = 0; i < dea.prisms.size(); ++i) {
    const Prism& prism = model.elements.prisms[dea.prisms[i]];
    const PrismNodes nodes = nodes_of(positions, prism);
    const PrismField field = field_of(nodes_of(model.rest, prism), nodes);
    layer.capacitance_pF += pF_per_unit * permittivity[dea.prisms[i]] * field.capacity_mm;
    if (dea.fractions[i] * field.field_per_mm <= most) continue;
    most = dea.fractions[i] * field.field_per_mm;
    layer.at = nodes.colwise().mean().transpose();
    layer.thickness_mm = thickness(nodes, field.volume_mm3);
  }
  layer.field_kV_mm = most * voltage_kV;
  layer.charge_nC = layer.capacitance_pF * voltage_kV;
  return layer;
}

}  // namespace softkin
