#pragma once

#include <mutex>
#include <softkin/statics/sensitivity.hpp>
#include <softkin/statics/target_shape/local_global.hpp>
#include <softkin/statics/target_shape/newton_tangent.hpp>

namespace softkin::target_shape {

/// Memory of a search; nothing in it outlives a search except, for sensitivities, the last factor.
struct Workspace {
  explicit Workspace(const Unknowns& unknowns);

  Tangent tangent;
  System::Scratch local;  // of the last shape evaluated
  System::Scratch start;  // of the shape that a step starts from
  System::Scratch work;
  Points solved_shape;  // equilibrium near which the tangent was factorised; empty: none
};

/// Runs of Newton's method, one after another.
class NewtonSearch {
 public:
  /// astray: a number is not finite.
  enum class End { converged, stuck, interrupted, astray };

  /// All must outlive the object. The result does not depend on what the workspace was used for before.
  NewtonSearch(const Unknowns& unknowns, const supports::GlobalStep& global, Workspace& workspace,
               const StaticsOptions& options, const ProgressCallback& progress, Team& team, SolveReport& report);

  /// From positions to the equilibrium at an actuation; positions are the last shape.
  ///
  /// max_steps   of Newton's method
  /// patience    local-global iterations that may be inserted where Newton's method makes no progress
  End run(const Actuation& actuation, int max_steps, int patience, Points& positions);

 private:
  enum class Step { full, shortened, none };

  void evaluate(const Actuation& actuation, Points& positions);
  void move(double scale, Points& positions);
  [[nodiscard]] Step newton_step(const Actuation& actuation, Points& positions);
  [[nodiscard]] bool exact_direction(const Points& positions);
  [[nodiscard]] bool projected_direction(const Points& positions);
  void take_back(const Actuation& actuation, Points& positions);
  [[nodiscard]] Step search_energy(const Actuation& actuation, Points& positions);
  [[nodiscard]] Step search_residual(const Actuation& actuation, Points& positions);
  [[nodiscard]] bool at_fixed_point(const Points& positions);
  [[nodiscard]] bool close(const Actuation& actuation, Points& positions, double& step_mm);
  [[nodiscard]] bool negligible(int halvings, const Points& positions) const;
  [[nodiscard]] double natural_norm(const Points& positions);
  End local_global(const Actuation& actuation, int count, Points& positions);
  [[nodiscard]] End enter(const IterationRecord& record);
  [[nodiscard]] IterationRecord here() const;
  [[nodiscard]] const TargetShapeOptions& tuning() const { return options_.tuning.target_shape; }

  const Unknowns& unknowns_;
  const supports::GlobalStep& global_;
  const StaticsOptions& options_;
  const ProgressCallback& progress_;
  Team& team_;
  SolveReport& report_;
  Workspace& workspace_;
  std::vector<supports::Pose> poses_, poses_before_;
  Points before_, moves_;
  Eigen::VectorXd residual_, step_, scaled_, natural_;
  double energy_ = 0, min_energy_ = 0, natural_start_ = 0, tolerance_ = 0;
  /// How the next step is to be found.
  struct Direction {
    bool exact = false;           // is step_ that of the exact derivative
    bool projected_next = false;  // far from equilibria the exact derivative is of little use
    bool keep_factor = false;     // the last one is still good
  };
  Direction direction_;
};

/// Newton's method for the fixed point of Algorithm 1: residual(x) = 0 with the same local step. Pattern, ordering and
/// symbolic factorisation are made once.
///
/// Where the residual is a gradient (R_omega = 1, uniform ratios): the exact Hessian, element matrices made positive
/// semidefinite where it is not positive definite, line search on the energy. Otherwise Newton-Krylov with the exact
/// derivative and a line search on the preconditioned residual, with the last preconditioner (Deuflhard's natural
/// test). Where neither makes progress, some accelerated local-global iterations; where these do not help, intermediate
/// equilibria from the start's actuation on; finally Algorithm 1 to its end.
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
  [[nodiscard]] Sensitivity sensitivity(const State& at, bool reuse_factor, double accuracy, Team& team) const;

  /// Drops the factors of earlier solves.
  void forget() const;

 private:
  /// Returns the workspace that was left at a shape, if one is given and there is such a workspace; else another one.
  [[nodiscard]] std::unique_ptr<Workspace> take_workspace(const Points* shape = nullptr) const;
  void put_back(std::unique_ptr<Workspace> workspace) const;

  const supports::GlobalStep& global_;
  const Unknowns& unknowns_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Workspace>> workspaces_;  // not in use: as many as solves ran at once
};

}  // namespace softkin::target_shape
