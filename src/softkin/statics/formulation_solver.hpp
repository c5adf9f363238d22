#pragma once

#include <atomic>
#include <softkin/core/team.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

class PhysicalSolver;

/// The threads of a robot's solves: kept from call to call, as many as pay where nobody asks for a number.
class Lender {
 public:
  explicit Lender(const Model& model);
  [[nodiscard]] TeamPool::Lent lend(const StaticsOptions& options);

 private:
  std::atomic<int> worthwhile_;
  TeamPool teams_;
};

/// What finds the equilibria of a robot, or knows them: the solver of each formulation, and what is given (a map).
/// Arguments are checked already, but for options that it does not have.
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

  /// What alone has forces, or null.
  [[nodiscard]] virtual PhysicalSolver* physical() { return nullptr; }

  /// Drops what earlier solves left.
  virtual void forget() const {}
};

/// 8e-8 of the robot's diagonal, where none is asked for [mm].
[[nodiscard]] double step_tolerance_mm(const Model& model, const StaticsOptions& options);

/// throws  InvalidInput on a time that is negative
void check_elapsed(double elapsed_s);

}  // namespace softkin
