#pragma once

#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/sensitivity.hpp>

namespace softkin::physical {

/// The systems of a robot with one parameter slightly increased and slightly decreased.
struct Perturbation {
  /// All must outlive the object.
  Perturbation(const Perturbed& perturbed, const System& like);

  std::unique_ptr<const System> more, less;
  double difference = 0;
};

/// Derivatives of an equilibrium by the commands: K X + G L = F, G^T X = T, a column per actuator, with the stiffness K
/// and the gradients G of the active measures, both at the shape. F: change of loads and layers with the command; T:
/// change of the measures' targets.
class Derivative {
 public:
  /// All must outlive the object. work.solved_shape: the shape near which the workspace factorised, or empty
  Derivative(const System& system, Workspace& work, double accuracy, Team& team);

  /// at  multipliers in internal units
  [[nodiscard]] Sensitivity of(const Iterate& at, const LoadState& load_state);
  /// Derivatives along given changes of the commands.
  [[nodiscard]] ParameterSensitivity of(const Iterate& at, const LoadState& load_state,
                                        const std::vector<Actuation>& changes, bool reactions);
  /// Moves under dead forces on the vertices; none where there is no solution.
  [[nodiscard]] std::vector<Points> under(const Iterate& at, const LoadState& load_state,
                                          const std::vector<Points>& forces);
  /// Derivatives by parameters of the robot: F and T are the differences of the residuals of the perturbed systems at
  /// the shape, over the difference of the parameter. history, elapsed_s: of the equilibrium. reactions: are those of
  /// supports requested
  [[nodiscard]] ParameterSensitivity of(const Iterate& at, const LoadState& load_state,
                                        const std::vector<Perturbation>& perturbations,
                                        const std::shared_ptr<const ViscousHistory>& history, double elapsed_s,
                                        bool reactions);
  /// Derivatives of `reported` quantities of the equilibrium, a row each, by parameters of the robot, with the adjoint
  /// method: one solution per row. The stiffness must be symmetric. No columns where there is no solution.
  [[nodiscard]] Eigen::MatrixXd of(const Iterate& at, const LoadState& load_state,
                                   const std::vector<Perturbation>& perturbations,
                                   const std::shared_ptr<const ViscousHistory>& history, double elapsed_s,
                                   const std::vector<ShapeGradient>& reported);

 private:
  /// The direct effect of a parameter at constant shape.
  struct Direct {
    Points force;           // gradient of the Lagrangian
    Eigen::VectorXd loads;  // those that are given, in internal units
  };

  /// The residuals of a robot's equations at a shape, and the positions of its supports.
  struct Found {
    Points gradient, held;
    Eigen::VectorXd constraint, multipliers;
  };

  void hold(const Iterate& at, const LoadState& load_state);
  void by_command(const Iterate& at, const LoadState& load_state, Index actuator, Points& force, Points& moves);
  [[nodiscard]] Found found_by(const System& system, const Iterate& at, const LoadState& load_state,
                               const std::shared_ptr<const ViscousHistory>& history, double elapsed_s) const;
  void make_room(Index columns);
  void ask(const Iterate& at, const LoadState& load_state);
  void ask(const Iterate& at, Index column, const Points& force, Points moves);
  Direct ask_number(const Iterate& at, const LoadState& load_state, Index column, const Perturbation& number,
                    const std::shared_ptr<const ViscousHistory>& history, double elapsed_s);
  void ask_adjoint(const Iterate& at, Index column, const ShapeGradient& reported);
  Points ask_along(const Iterate& at, const LoadState& load_state, Index column, const Actuation& change);
  bool find(const Iterate& at, const LoadState& load_state);
  bool solve(const Iterate& at, bool exact_factor);
  [[nodiscard]] Points positions(const Iterate& at, Index column) const;
  [[nodiscard]] Eigen::VectorXd multipliers(Index column) const;
  [[nodiscard]] Points reactions(const Iterate& at, const LoadState& load_state, Index column, Points force,
                                 const Eigen::VectorXd& loads);

  const System& system_;
  Workspace& work_;
  double accuracy_;
  const DerivativeOptions& tuning_;
  Team& team_;
  Balance balance_;  // at the shape
  std::vector<bool> active_;
  std::vector<Index> held_;
  Columns right_, found_;
  bool by_commands_ = false;   // are the columns those of the commands?
  std::vector<Points> moves_;  // per column: of moved supports; no rows: none
};

}  // namespace softkin::physical
