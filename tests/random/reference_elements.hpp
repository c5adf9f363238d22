#pragma once

#include <array>
#include <functional>
#include <softkin/model/model.hpp>
#include <vector>

#include "random/dual.hpp"

/// Elements of the physical formulation once more, in long double and with no code of the solver: energies by their
/// formulas (core/elastic_law.hpp), stresses by derivatives of dual numbers, shape functions and quadrature.
namespace softkin::random_robots {

using RealVec3 = Eigen::Matrix<Real, 3, 1>;
using RealMat3 = Eigen::Matrix<Real, 3, 3>;
/// A point a row.
using RealPoints = Eigen::Matrix<Real, Eigen::Dynamic, 3>;

/// dW/dF [MPa]; not finite where the law has no energy.
[[nodiscard]] RealMat3 stress(const ElasticLaw& law, const RealMat3& gradient);

/// About the norm of d^2W/dF^2 [MPa], from above.
[[nodiscard]] Real stiffness_bound(const ElasticLaw& law, const RealMat3& gradient);

/// What an element does to its nodes.
struct ElementPulls {
  std::vector<RealVec3> force;  // derivative of its energy in each node's position [N]
  std::vector<Real> stiffness;  // largest force at each node when all nodes move by at most 1 mm [N/mm], from above
  std::vector<Real> rounding;   // force that one unit in the last place of all coordinates may stand for [N]
};

/// What is done to the layer of a dielectric elastomer.
struct LayerDrive {
  Real ratio = 1;     // active stretch, area over that at rest
  Real pressure = 0;  // permittivity times the square of the voltage that the layer has [MPa mm^2]
};

/// How an element has grown: stretches along a direction of unit length and across it.
struct ElementGrowth {
  Real along = 1, across = 1;
  RealVec3 direction = RealVec3::UnitX();

  [[nodiscard]] Real volume() const { return along * across * across; }
  [[nodiscard]] RealMat3 inverse() const {
    const RealMat3 d = direction * direction.transpose();
    return d / along + (RealMat3::Identity() - d) / across;
  }
};

/// Maxwell branches so long after a long rest [s]; infinity: relaxed.
struct BranchDrive {
  const std::vector<ViscousBranch>* branches = nullptr;
  double elapsed_s = 0;
  RealPoints begun{};    // nodes of the element in that rest
  Real begun_ratio = 1;  // active stretch there
  ElementGrowth begun_growth{};
};

/// rest, current: nodes of a tetrahedron of order 1 (4) or 2 (10: corners, then edges 01, 12, 02, 03, 13, 23) or of a
/// prism (6).
[[nodiscard]] ElementPulls pulls_of(const ElasticLaw& law, const RealPoints& rest, const RealPoints& current,
                                    const LayerDrive& drive, const BranchDrive& viscous,
                                    const ElementGrowth& growth = {});

/// What a mixed element's pressures at its corners [MPa; tension is positive] do to its nodes, and what their equations
/// miss: the integral of L_i (J - 1 - p / bulk), less what smooths them on linear tetrahedra (docs/formulations.md).
struct PressurePulls {
  ElementPulls pulls;
  std::array<Real, 4> missed{};  // [mm^3]
  std::array<Real, 4> volume{};  // integral of L_i (1 + |J| + |p / bulk|) [mm^3]
  std::array<Real, 4> area{};    // largest change of what is missed when all nodes move by at most 1 mm [mm^2]
};
/// bulk: what the pressures stand for [MPa]; shear: shear modulus at small strain [MPa]
[[nodiscard]] PressurePulls pressure_pulls_of(const RealPoints& rest, const RealPoints& current,
                                              const std::array<Real, 4>& pressures, Real bulk, Real shear,
                                              const ElementGrowth& growth = {});

/// A family of fibres: its constants, and the unit vector that it runs along.
struct FibreDrive {
  Real k1 = 0, k2 = 0, dispersion = 0;  // [MPa], [-], [-]
  RealVec3 direction = RealVec3::UnitX();
};
/// What families of fibres add to the pulls of an element's law.
[[nodiscard]] ElementPulls family_pulls_of(const RealPoints& rest, const RealPoints& current,
                                           const std::vector<FibreDrive>& fibres);

/// Flux density at a place [mT] and its slopes there, (i, j) of b_i along x_j [mT/mm].
struct RealFlux {
  RealVec3 value = RealVec3::Zero();
  RealMat3 slope = RealMat3::Zero();
};

/// Derivative of -(1 / mu_0) (F b_r) . b, or where it turns of -(1 / mu_0) (R b_r) . b, by each node's position;
/// remanence: b_r [mT].
[[nodiscard]] ElementPulls magnetic_pulls_of(const RealPoints& rest, const RealPoints& current,
                                             const RealVec3& remanence, bool turns,
                                             const std::function<RealFlux(const RealVec3&)>& flux);

}  // namespace softkin::random_robots
