#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace softkin::physical {

/// Result of an evaluation of the equations of equilibrium.
struct Balance {
  Eigen::VectorXd force;       // residual in the unknowns [N, N mm]
  Eigen::VectorXd constraint;  // m: measure minus its target, 0 where not active [mm, mm^3]
  double energy = 0;           // elastic and of contact, less the work of dead loads [mJ]
  double load_energy = 0;      // of measures whose multipliers are given, and of fillings of sealed chambers [mJ]
  // m: minus the derivative of the measure's target by the multiplier; empty: all are 0 [mm^3/MPa]
  Eigen::VectorXd compliance{};
  Eigen::VectorXd slips{};       // of tendons with friction, see Tendons
  Eigen::VectorXd growth{};      // m: relative change of tensions with the load state [-]; empty: none
  bool inverted = false;         // an element
  bool forbidden = false;        // inverted where the law has no energy
  std::uint64_t evaluation = 0;  // of the workspace
};

/// Residual of the forces at an iterate, and the elements' forces for comparison [N].
struct Imbalance {
  double residual = 0;  // the largest on a vertex or a rigid region
  double pull = 0;      // the largest sum of magnitudes of the elements' forces on a vertex
  double rounding = 0;  // possible residual on a vertex by rounding of the positions
};

}  // namespace softkin::physical
