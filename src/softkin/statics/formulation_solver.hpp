#pragma once

#include <atomic>
#include <softkin/core/team.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

class PhysicalSolver;

/// The threads of a robot's solves. They are kept from call to call; as many are used as pay unless the options set
/// their number.
class Lender {
 public:
  explicit Lender(const Model& model);
  [[nodiscard]] TeamPool::Lent lend(const StaticsOptions& options);

 private:
  std::atomic<int> worthwhile_;
  TeamPool teams_;
};

/// Source of the equilibria of a robot: the solver of each formulation, or given equilibria (a map). Arguments are
/// checked already, except for options that it does not have.
class FormulationSolver {
 public:
  FormulationSolver() = default;
  FormulationSolver(const FormulationSolver&) = delete;
  FormulationSolver& operator=(const FormulationSolver&) = delete;
  virtual ~FormulationSolver() = default;

  /// See Statics::solve; report.seconds is left to the caller.
  ///
  /// throws  InvalidInput on options of another formulation, and on a history of another robot
  [[nodiscard]] virtual Equilibrium solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                                          const ProgressCallback& progress) = 0;

  /// See Statics::sensitivity.
  [[nodiscard]] virtual Sensitivity sensitivity(const State& at, const StaticsOptions& options,
                                                double accuracy) const = 0;

  /// Returns the physical solver, which alone has forces, or null.
  [[nodiscard]] virtual PhysicalSolver* physical() { return nullptr; }

  /// Drops the factors of earlier solves.
  virtual void forget() const {}
};

/// Returns the tolerance of the options, or 8e-8 of the robot's diagonal where they have none [mm].
[[nodiscard]] double step_tolerance_mm(const Model& model, const StaticsOptions& options);

/// throws  InvalidInput on a time that is negative
void check_elapsed(double elapsed_s);

}  // namespace softkin
