#pragma once

#include <cmath>
#include <softkin/statics/physical/newton.hpp>

namespace softkin::physical {

/// Is the stiffness along the softest mode, in which an instability begins, still that of the current factorisation?
/// balance: of the iterate, just evaluated; the workspace is left with another one.
[[nodiscard]] bool as_stiff_as_factorised(const System& system, const Iterate& at, const LoadState& load_state,
                                          const std::vector<bool>& active, const Balance& balance, Workspace& work,
                                          Team& team);

/// The direction of least curvature of the energy, among those that keep the active measures.
struct LowestMode {
  int unstable = 0;           // negative eigenvalues of the stiffness on those directions
  double curvature = 0;       // the least of them [N/mm]; 0 where none is negative
  double mean = 0;            // of the magnitudes of the stiffness' diagonal [N/mm]
  Eigen::VectorXd direction;  // of length 1 over the unknowns; empty where none is negative or none was found

  /// The shift for step_down() at a nearby shape: each step is twice as long as the one before.
  [[nodiscard]] double steep_shift() const { return 2 * std::abs(curvature) / mean; }
};

/// Computes the lowest mode at an equilibrium. The workspace is left with another factorisation.
///
/// source  a shift that makes the stiffness positive, by bisection on Sylvester's inertia, then inverse iteration
[[nodiscard]] LowestMode lowest_mode(const System& system, const Iterate& at, const LoadState& load_state,
                                     const std::vector<bool>& active, Workspace& work, Team& team, SolveRecord& record);

/// The result of step_down(): was a shape of less energy found, and how many factorisations did it take.
struct Descent {
  bool lower = false;
  int factorisations = 0, factorisations_in_double = 0;
};
/// Makes a step with K + shift mean(diag K) 1 to a shape of less energy, evaluated with the multipliers at its start.
/// The dimensionless `shift` grows until the stiffness is positive and the energy decreases, and shrinks for the next
/// step. The workspace is left with another factorisation.
///
/// source  Levenberg and Marquardt; active measures are closed to first order, as by Newton's method
[[nodiscard]] Descent step_down(const System& system, const LoadState& load_state, const std::vector<bool>& active,
                                double& shift, Iterate& at, Workspace& work, Team& team);

/// Elastic energy less the work of dead loads and of the given pressures and tensions [mJ]: a stable equilibrium is a
/// local minimum of it.
[[nodiscard]] double potential(const System& system, const Iterate& at, const LoadState& load_state,
                               const std::vector<bool>& active, Workspace& work, Team& team);

}  // namespace softkin::physical
