#pragma once

#include <softkin/statics/physical_solver.hpp>

namespace softkin {

/// throws  InvalidInput on what is not of the model, and on options out of range
void check_start(const Model& model, const State& start, const StaticsOptions& options);

/// The objects with which a robot's equilibria are found.
struct Statics::Parts {
  explicit Parts(const Model& robot) : model(robot), lender(robot) {}

  /// of: for messages
  void check_actuation(const State& at, const StaticsOptions& options, const std::string& of) const;
  void check_known(const State& at, const StaticsOptions& options, const std::string& of) const;

  /// Of the physical formulation, else null.
  [[nodiscard]] const physical::Equilibria* equilibria() const;
  /// Returns options in the form that the equilibria take; the formulation must be the physical one.
  [[nodiscard]] physical::Equilibria::Options options_of(const StaticsOptions& options) const {
    return solver->physical()->options_of(options);
  }
  /// throws  InvalidInput of the target-shape formulation; what: for the message
  [[nodiscard]] const physical::Equilibria& need_equilibria(const std::string& what) const;

  const Model& model;
  Lender lender;
  std::unique_ptr<FormulationSolver> solver;
  std::unique_ptr<const GivenEquilibria> starts;  // null: solves begin at the start that they are given
};

}  // namespace softkin
