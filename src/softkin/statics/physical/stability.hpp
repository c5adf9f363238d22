#pragma once

#include <softkin/statics/physical/newton.hpp>

namespace softkin::physical {

/// The direction in which the energy curves least, among those that keep the active measures.
struct LowestMode {
  int unstable = 0;           // negative eigenvalues of the stiffness on those directions
  double curvature = 0;       // the least of them [N/mm]; 0 where none is negative
  Eigen::VectorXd direction;  // of length 1 over the unknowns; empty where none is negative
};

/// At an equilibrium. The workspace is left with another factorisation.
///
/// source  a shift that makes the stiffness positive, by bisection on Sylvester's inertia, then inverse iteration
[[nodiscard]] LowestMode lowest_mode(const System& system, const Iterate& at, const Demand& demand,
                                     const std::vector<bool>& active, System::Workspace& work, Team& team,
                                     SolveReport& report);

/// Elastic energy less the work of dead loads and of the pressures and tensions that are given [mJ]: what a stable
/// equilibrium has least of among the shapes around it.
[[nodiscard]] double potential(const System& system, const Iterate& at, const Demand& demand,
                               const std::vector<bool>& active, System::Workspace& work, Team& team);

}  // namespace softkin::physical
