#pragma once

#include <softkin/model/equilibrium.hpp>

namespace softkin::physical {

/// The loads on a robot in the physical formulation: commands and load factors.
struct LoadState {
  Eigen::VectorXd actuation;  // m commands, in the user's units
  double load_factor = 1;     // of dead loads, dipoles, prestretch and displacements of supports [-]
  double fading = 0;          // fraction of the residual at the begin of the path that remains [-]
};

/// Returns the load state at a fraction `load_factor` of the path from one to another.
[[nodiscard]] LoadState between(const LoadState& from, const LoadState& to, double load_factor);

/// Shape and multipliers: a point of the path that Newton's method follows.
struct Iterate {
  Points positions;               // #V by 3 [mm]
  Eigen::VectorXd multipliers;    // m: tension [N], gauge pressure [MPa], voltage of a dea [kV]
  std::vector<Anchor> anchors{};  // of contact friction
  std::vector<double> eyelets{};  // of tendons with friction, see Tendons; empty: not yet set
};

/// The derivatives of an equilibrium by the commands.
struct Slopes {
  Points at;                           // the shape; no rows: unknown
  std::vector<Index> held;             // the constraints that were active
  Eigen::MatrixXd moves, multipliers;  // of the unknowns, of the constraints, per unit of each command
  Eigen::VectorXd extrapolated_for{};  // actuation whose equilibrium was extrapolated from here; empty: none
  Iterate extrapolated{};
};

}  // namespace softkin::physical
