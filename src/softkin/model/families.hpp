#pragma once

#include <softkin/model/direction.hpp>
#include <softkin/model/model.hpp>

namespace softkin {

/// A family of fibres in a material: W = k1 / (2 k2) (exp(k2 E^2) - 1) where E > 0, else 0, with
/// E = kappa (bar I1 - 3) + (1 - 3 kappa) (bar I4 - 1); k2 = 0: k1 / 2 E^2.
///
/// source  Gasser, Ogden, Holzapfel, J. R. Soc. Interface 3(6), 2006; bar: of J^(-2/3) F^T F
struct FamilySpec {
  double k1_MPa = 0;          // > 0
  double k2 = 0;              // >= 0
  double dispersion = 0;      // kappa, 0 (all along the direction) to 1/3 (in all directions)
  DirectionSpec direction{};  // along which the fibres lie at rest
};
struct FamiliesSpec {                // all of a material
  std::vector<FamilySpec> families;  // at least one
};

/// Compiled, of the elements of a material.
struct Families {
  /// One of them, with its directions.
  struct Family {
    double k1_MPa = 0, k2 = 0, dispersion = 0;  // as FamilySpec has them
    std::vector<Vec3> directions;               // of the elements: tetrahedra, then prisms; of unit length
  };
  std::vector<Index> tetrahedra, prisms;  // of the model
  std::vector<Family> families;           // of the material, in their order
};

}  // namespace softkin
