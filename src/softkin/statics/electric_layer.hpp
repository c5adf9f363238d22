#pragma once

#include <softkin/model/model.hpp>

namespace softkin {

/// Permittivity of every prism of the model, times the square of the fraction of the voltage across it
/// [MPa per (kV/mm)^2]; 0 for prisms of other actuators or none.
[[nodiscard]] std::vector<double> layer_permittivity(const Model& model, Index actuator);

/// The electric state of the layer of a dea under voltage.
struct ElectricLayer {
  double capacitance_pF = 0;  // C = Q / V
  double charge_nC = 0;       // on its electrodes
  double field_kV_mm = 0;     // true field, the largest at a quadrature point,
  Vec3 at = Vec3::Zero();     // the centroid of that prism [mm]
  double thickness_mm = 0;    // and its thickness: volume over mean area
};

/// Physical formulation.
///
/// source  charge Q = -dE/dV of the electric energy of energy/dielectric.hpp, C = Q / V
[[nodiscard]] ElectricLayer electric_layer(const Model& model, Index actuator, const Points& positions,
                                           double voltage_kV);

}  // namespace softkin
