#pragma once

#include <mutex>
#include <softkin/statics/sensitivity.hpp>
#include <softkin/statics/target_shape/newton_search.hpp>

namespace softkin::target_shape {

/// Newton's method for the fixed point of Algorithm 1: residual(x) = 0 with the same local step. Pattern, ordering and
/// symbolic factorisation are made once.
///
/// Where the residual is a gradient (R_omega = 1, uniform ratios): the exact Hessian, element matrices made positive
/// semidefinite where it is not positive definite, line search on the energy. Otherwise Newton-Krylov with the exact
/// derivative and a line search on the residual, seen through the last preconditioner (Deuflhard's natural test). Where
/// neither gets on, some accelerated local-global iterations; where these do not help, equilibria on the way from the
/// start's actuation; at last Algorithm 1 to its end.
class Newton {
 public:
  /// All must outlive the object.
  Newton(const Unknowns& unknowns, const supports::GlobalStep& global);

  /// From result.state.positions to the equilibrium at result.actuation; fills state.positions and the report, its
  /// seconds aside. Stops at a full step that moves no vertex farther than report.tolerance_mm.
  ///
  /// start  the actuation that the start is an equilibrium of, or empty: then that of rest
  void solve(const Actuation& start, const StaticsOptions& options, const ProgressCallback& progress, Team& team,
             Equilibrium& result) const;

  /// Of an equilibrium; see Statics::sensitivity.
  [[nodiscard]] Sensitivity sensitivity(const State& at, bool reuse_factor, Team& team) const;

  /// Drops what earlier solves left.
  void forget() const;

 private:
  /// One that was left at the shape, if there is and a shape is given.
  [[nodiscard]] std::unique_ptr<Workspace> take_workspace(const Points* shape = nullptr) const;
  void put_back(std::unique_ptr<Workspace> workspace) const;

  const supports::GlobalStep& global_;
  const Unknowns& unknowns_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Workspace>> workspaces_;  // not in use: as many as solves ran at once
};

}  // namespace softkin::target_shape
