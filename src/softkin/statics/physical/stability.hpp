#pragma once

#include <cmath>
#include <softkin/statics/physical/newton.hpp>

namespace softkin::physical {

/// Is the stiffness along the softest change of shape, which an instability comes by, still that of the factor at hand?
/// balance: of the iterate, just evaluated; the workspace is left with another one.
[[nodiscard]] bool as_stiff_as_factorised(const System& system, const Iterate& at, const Demand& demand,
                                          const std::vector<bool>& active, const Balance& balance, Workspace& work,
                                          Team& team);

/// The direction in which the energy curves least, among those that keep the active measures.
struct LowestMode {
  int unstable = 0;           // negative eigenvalues of the stiffness on those directions
  double curvature = 0;       // the least of them [N/mm]; 0 where none is negative
  double mean = 0;            // of the magnitudes of the stiffness' diagonal [N/mm]
  Eigen::VectorXd direction;  // of length 1 over the unknowns; empty where none is negative or none was found

  /// For step_down, of a shape close by: each step is twice as long as the one before.
  [[nodiscard]] double steep_shift() const { return 2 * std::abs(curvature) / mean; }
};

/// At an equilibrium. The workspace is left with another factorisation.
///
/// source  a shift that makes the stiffness positive, by bisection on Sylvester's inertia, then inverse iteration
[[nodiscard]] LowestMode lowest_mode(const System& system, const Iterate& at, const Demand& demand,
                                     const std::vector<bool>& active, Workspace& work, Team& team, SolveReport& report);

/// Is there a shape of less energy, and how often the stiffness was factorised to tell.
struct Descent {
  bool lower = false;
  int factorisations = 0, factorisations_in_double = 0;
};
/// A step with K + shift mean(diag K) 1 to a shape of less energy, measured with the multipliers at its begin. shift, a
/// share, grows until the stiffness is positive and the energy falls, and shrinks for the next step.
/// The workspace is left with another factorisation.
///
/// source  Levenberg and Marquardt; active measures are closed to first order, as by Newton's method
[[nodiscard]] Descent step_down(const System& system, const Demand& demand, const std::vector<bool>& active,
                                double& shift, Iterate& at, Workspace& work, Team& team);

/// Elastic energy less the work of dead loads and of the pressures and tensions that are given [mJ]: what a stable
/// equilibrium has least of among the shapes around it.
[[nodiscard]] double potential(const System& system, const Iterate& at, const Demand& demand,
                               const std::vector<bool>& active, Workspace& work, Team& team);

}  // namespace softkin::physical
