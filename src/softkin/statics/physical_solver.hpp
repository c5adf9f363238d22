#pragma once

#include <mutex>
#include <softkin/statics/formulation_solver.hpp>
#include <softkin/statics/physical/equilibria.hpp>

namespace softkin {

/// The solver of the physical formulation, and where viscous robots rest before times begin.
class PhysicalSolver : public FormulationSolver {
 public:
  /// Both must outlive the object. throws InvalidInput where some part of the robot is not held
  PhysicalSolver(const Model& model, Lender& lender) : model_(model), lender_(lender), equilibria_(model) {}
  /// See Statics.
  PhysicalSolver(const Model& model, const PhysicalSolver& like, Lender& lender)
      : model_(model), lender_(lender), equilibria_(model, like.equilibria_) {}

  [[nodiscard]] Equilibrium solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                                  const ProgressCallback& progress) override;
  [[nodiscard]] Sensitivity sensitivity(const State& at, const StaticsOptions& options, double accuracy) const override;
  [[nodiscard]] PhysicalSolver* physical() override { return this; }
  void forget() const override { equilibria_.forget(); }

  /// See Statics::flow. throws InvalidInput where the robot has no equilibrium at rest
  [[nodiscard]] ViscousFlow flow(const State& at);

  [[nodiscard]] const physical::Equilibria& equilibria() const { return equilibria_; }
  /// Returns the options as the equilibria take them.
  [[nodiscard]] physical::Equilibria::Options options_of(const StaticsOptions& options) const;

 private:
  void check_history(const ViscousHistory* history, double elapsed_s) const;
  [[nodiscard]] Equilibrium long_rest(StaticsOptions options, const ProgressCallback& progress, Team& team);

  const Model& model_;
  Lender& lender_;
  physical::Equilibria equilibria_;
  std::mutex rested_mutex_;
  std::optional<Equilibrium> rested_;
  std::shared_ptr<const ViscousHistory> remembered_;  // of rested_
};

}  // namespace softkin
