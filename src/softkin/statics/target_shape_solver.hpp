#pragma once

#include <softkin/statics/formulation_solver.hpp>
#include <softkin/statics/target_shape/local_global.hpp>
#include <softkin/statics/target_shape/newton.hpp>

namespace softkin {

/// The solvers of the target-shape formulation: Newton's method, and Algorithm 1.
class TargetShapeSolver : public FormulationSolver {
 public:
  /// Both must outlive the object. throws InvalidInput where some part of the robot is not held
  TargetShapeSolver(const Model& model, Lender& lender);

  [[nodiscard]] Equilibrium solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                                  const ProgressCallback& progress) override;
  [[nodiscard]] Sensitivity sensitivity(const State& at, const StaticsOptions& options, double accuracy) const override;
  void forget() const override { newton_.forget(); }

 private:
  void follow_turns(const Actuation& start, const StaticsOptions& options, const ProgressCallback& progress, Team& team,
                    Equilibrium& result) const;

  const Model& model_;
  Lender& lender_;
  target_shape::System system_;
  supports::Turning turning_;
  target_shape::Unknowns unknowns_;
  supports::GlobalStep global_;
  target_shape::Newton newton_;
};

}  // namespace softkin
