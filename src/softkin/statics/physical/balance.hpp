#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace softkin::physical {

/// What an evaluation of the equations of equilibrium finds.
struct Balance {
  Eigen::VectorXd force;       // of the unknowns, what is not in balance [N, N mm]
  Eigen::VectorXd constraint;  // m: measure minus demand, 0 where not active [mm, mm^3]
  double energy = 0;           // elastic and of contact, less the work of dead loads [mJ]
  double load_energy = 0;      // of measures whose multipliers are given, and of what is sealed in chambers [mJ]
  // m: of the measure that is demanded, by the multiplier, with the other sign; empty: none gives way [mm^3/MPa]
  Eigen::VectorXd compliance{};
  Eigen::VectorXd slips{};       // of tendons that rub, see Tendons
  Eigen::VectorXd growth{};      // m: of tensions where a demand changes, over what they are [-]; empty: none
  bool inverted = false;         // an element
  bool forbidden = false;        // inverted where the law has no energy
  std::uint64_t evaluation = 0;  // of the workspace
};

/// How well forces balance at an iterate [N].
struct Imbalance {
  double residual = 0;  // on a vertex or a rigid region, the largest
  double pull = 0;      // of the elements on a vertex, sum of magnitudes, the largest
  double rounding = 0;  // what rounding of the positions may leave on a vertex
};

}  // namespace softkin::physical
