#pragma once

namespace softkin {

/// Strain energy per rest volume W [MPa = mJ/mm^3] of an isotropic material in the deformation gradient F; J = det F,
/// C = F^T F, I1 = tr C, I2 = (I1^2 - tr C^2) / 2, principal stretches l_i: the roots of the eigenvalues of C. Barred:
/// J^(-2/3) I1, J^(-4/3) I2, J^(-1/3) l_i. A new law answers every question of LawTraits below.
enum class Law {
  st_venant_kirchhoff,  // mu tr(E^2) + lambda/2 tr(E)^2, E = (C - I) / 2
  corotational,         // mu |F - R|^2 + lambda/2 tr(R^T F - I)^2, R the best rotation
  neo_hookean,          // mu/2 (I1 - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2: Smith et al. 2018, Eq. (13)
  mooney_rivlin,        // c10 (bar I1 - 3) + c01 (bar I2 - 3) + bulk/2 (J - 1)^2
  yeoh,                 // c10 (bar I1 - 3) + c20 (bar I1 - 3)^2 + c30 (bar I1 - 3)^3 + bulk/2 (J - 1)^2
  gent,                 // -mu/2 jm ln(1 - (bar I1 - 3) / jm) + bulk/2 (J - 1)^2: Gent 1996
  ogden                 // sum_p mu_p/alpha_p (sum_i bar l_i^alpha_p - 3) + bulk/2 (J - 1)^2: Ogden 1972
};

/// All laws, in the order of the enumeration.
inline constexpr Law all_laws[] = {Law::st_venant_kirchhoff,
                                   Law::corotational,
                                   Law::neo_hookean,
                                   Law::mooney_rivlin,
                                   Law::yeoh,
                                   Law::gent,
                                   Law::ogden};

/// What W is a function of.
enum class LawForm { invariants, rotation, stretches };

/// From which constants a law has its shear modulus at small strain.
enum class LawConstants { lame, coefficients, limited, ogden };

/// A truth value without a default: a law whose traits leave one out does not compile.
struct Answer {
  bool yes;  // the value
  /// Implicit, so that a table of answers is a table of true and false.
  constexpr Answer(bool value) : yes(value) {}
  constexpr operator bool() const { return yes; }
};

/// What the rest of the program needs to know of a law.
struct LawTraits {
  const char* name;          // as scenes have it
  LawForm form;              // what W is a function of
  LawConstants constants;    // which constants it takes
  Answer forbids_inversion;  // it has no energy for J <= 0
  Answer has_bulk_part;      // W has a part bulk/2 (J - 1)^2, or lambda/2 (J - 1)^2 where it takes Lame's constants
  Answer uses_second;        // of laws of the invariants: W depends on I2,
  Answer uses_jacobian;      // on J,
  Answer couples_jacobian;   // on a product of J and another invariant,
  Answer curved_in_first;    // not only linearly on I1
};

/// The traits of a law. There is no default: the compiler names a law that is missing.
[[nodiscard]] constexpr LawTraits law_traits(Law law) {
  switch (law) {
    case Law::st_venant_kirchhoff:
      return {.name = "st-venant-kirchhoff",
              .form = LawForm::invariants,
              .constants = LawConstants::lame,
              .forbids_inversion = false,
              .has_bulk_part = false,
              .uses_second = true,
              .uses_jacobian = false,
              .couples_jacobian = false,
              .curved_in_first = true};
    case Law::corotational:
      return {.name = "corotational",
              .form = LawForm::rotation,
              .constants = LawConstants::lame,
              .forbids_inversion = false,
              .has_bulk_part = false,
              .uses_second = false,
              .uses_jacobian = false,
              .couples_jacobian = false,
              .curved_in_first = false};
    case Law::neo_hookean:
      return {.name = "neo-hookean",
              .form = LawForm::invariants,
              .constants = LawConstants::lame,
              .forbids_inversion = false,
              .has_bulk_part = true,
              .uses_second = false,
              .uses_jacobian = true,
              .couples_jacobian = false,
              .curved_in_first = false};
    case Law::mooney_rivlin:
      return {.name = "mooney-rivlin",
              .form = LawForm::invariants,
              .constants = LawConstants::coefficients,
              .forbids_inversion = true,
              .has_bulk_part = true,
              .uses_second = true,
              .uses_jacobian = true,
              .couples_jacobian = true,
              .curved_in_first = false};
    case Law::yeoh:
      return {.name = "yeoh",
              .form = LawForm::invariants,
              .constants = LawConstants::coefficients,
              .forbids_inversion = true,
              .has_bulk_part = true,
              .uses_second = false,
              .uses_jacobian = true,
              .couples_jacobian = true,
              .curved_in_first = true};
    case Law::gent:
      return {.name = "gent",
              .form = LawForm::invariants,
              .constants = LawConstants::limited,
              .forbids_inversion = true,
              .has_bulk_part = true,
              .uses_second = false,
              .uses_jacobian = true,
              .couples_jacobian = true,
              .curved_in_first = true};
    case Law::ogden:
      return {.name = "ogden",
              .form = LawForm::stretches,
              .constants = LawConstants::ogden,
              .forbids_inversion = true,
              .has_bulk_part = true,
              .uses_second = false,
              .uses_jacobian = false,
              .couples_jacobian = false,
              .curved_in_first = false};
  }
  return law_traits(Law::neo_hookean);  // of no law: a defect of the caller's
}

/// Has the law no energy for J <= 0?
[[nodiscard]] constexpr bool forbids_inversion(Law law) {
  return law_traits(law).forbids_inversion;
}

/// Has the law a part bulk/2 (J - 1)^2, with lambda in place of bulk where it has Lame's constants? Without it an
/// incompressible material would not keep its volume.
[[nodiscard]] constexpr bool has_bulk_part(Law law) {
  return law_traits(law).has_bulk_part;
}

/// One term of Ogden's law, mu/alpha (l_1^alpha + l_2^alpha + l_3^alpha - 3). Abaqus and CalculiX write it with
/// 2 mu_A / alpha^2, so mu = 2 mu_A / alpha; FEBio with c / alpha^2, so mu = c / alpha.
struct OgdenTerm {
  double mu = 0;     // [MPa]; of the sign of alpha where the term is stable by itself
  double alpha = 0;  // [-]; 0: the term is not there
};

/// Terms that Ogden's law has at most.
inline constexpr int max_ogden_terms = 3;

/// A law and its constants [MPa]; those that the law does not use are 0.
struct ElasticLaw {
  Law law = Law::neo_hookean;                           // which energy
  double mu = 0, lambda = 0;                            // Lame's constants
  double c10 = 0, c01 = 0, c20 = 0, c30 = 0, bulk = 0;  // of the energies above; bulk: the bulk modulus
  double jm = 0;                                        // [-]: the limit of bar I1 - 3
  OgdenTerm ogden[max_ogden_terms] = {};                // of Ogden's law
};

/// Shear modulus at small strain of Ogden's law [MPa]: half the sum of mu_p alpha_p.
[[nodiscard]] constexpr double shear_modulus(const OgdenTerm (&terms)[max_ogden_terms]) {
  double twice = 0;
  for (const OgdenTerm& term : terms) twice += term.mu * term.alpha;
  return twice / 2;
}

/// Shear modulus at small strain [MPa].
[[nodiscard]] constexpr double shear_modulus(const ElasticLaw& law) {
  switch (law_traits(law.law).constants) {
    case LawConstants::coefficients:
      return 2 * (law.c10 + law.c01);
    case LawConstants::ogden:
      return shear_modulus(law.ogden);
    case LawConstants::lame:
    case LawConstants::limited:
      break;
  }
  return law.mu;
}

/// The factor of (J - 1)^2 / 2, of a law that has it [MPa].
[[nodiscard]] inline double& bulk_part(ElasticLaw& law) {
  return law_traits(law.law).constants == LawConstants::lame ? law.lambda : law.bulk;
}

/// Of a Poisson's ratio of 0.5, over the shear modulus: at a pressure of one shear modulus a volume changes by 1e-9 of
/// itself, and pressures that a robot's shape leaves open, as where it is held all around, are still numbers.
inline constexpr double incompressible_bulk = 1e9;

}  // namespace softkin
