#pragma once

namespace softkin {

/// Strain energy per rest volume W [MPa = mJ/mm^3] of an isotropic material in the deformation gradient F; J = det F,
/// C = F^T F, I1 = tr C, I2 = (I1^2 - tr C^2) / 2. Barred invariants: J^(-2/3) I1, J^(-4/3) I2.
enum class Law {
  st_venant_kirchhoff,  // mu tr(E^2) + lambda/2 tr(E)^2, E = (C - I) / 2
  corotational,         // mu |F - R|^2 + lambda/2 tr(R^T F - I)^2, R the best rotation
  neo_hookean,          // mu/2 (I1 - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2: Smith et al. 2018, Eq. (13)
  mooney_rivlin,        // c10 (bar I1 - 3) + c01 (bar I2 - 3) + bulk/2 (J - 1)^2
  yeoh,                 // c10 (bar I1 - 3) + c20 (bar I1 - 3)^2 + c30 (bar I1 - 3)^3 + bulk/2 (J - 1)^2
  gent                  // -mu/2 jm ln(1 - (bar I1 - 3) / jm) + bulk/2 (J - 1)^2: Gent 1996
};

/// A law and its constants [MPa]; those that the law does not use are 0.
struct ElasticLaw {
  Law law = Law::neo_hookean;                           // which energy
  double mu = 0, lambda = 0;                            // Lame's constants
  double c10 = 0, c01 = 0, c20 = 0, c30 = 0, bulk = 0;  // of the energies above; bulk: the bulk modulus
  double jm = 0;                                        // [-]: the limit of bar I1 - 3
};

/// Has the law no energy for J <= 0?
[[nodiscard]] constexpr bool forbids_inversion(Law law) {
  return law == Law::mooney_rivlin || law == Law::yeoh || law == Law::gent;
}

/// Has the law a part bulk/2 (J - 1)^2, with lambda in place of bulk where it has Lame's constants? Without it an
/// incompressible material would not keep its volume.
[[nodiscard]] constexpr bool has_bulk_part(Law law) {
  return law == Law::neo_hookean || forbids_inversion(law);
}

/// Shear modulus at small strain [MPa].
[[nodiscard]] constexpr double shear_modulus(const ElasticLaw& law) {
  return forbids_inversion(law.law) && law.law != Law::gent ? 2 * (law.c10 + law.c01) : law.mu;
}

/// The factor of (J - 1)^2 / 2, of a law that has it [MPa].
[[nodiscard]] inline double& bulk_part(ElasticLaw& law) {
  return law.law == Law::neo_hookean ? law.lambda : law.bulk;
}

/// Of a Poisson's ratio of 0.5, over the shear modulus: at a pressure of one shear modulus a volume changes by 1e-9 of
/// itself, and pressures that a robot's shape leaves open, as where it is held all around, are still numbers.
inline constexpr double incompressible_bulk = 1e9;

}  // namespace softkin
