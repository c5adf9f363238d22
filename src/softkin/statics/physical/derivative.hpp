#pragma once

#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/sensitivity.hpp>

namespace softkin::physical {

/// The equations of a robot with one of its numbers a little larger and a little smaller.
struct Perturbation {
  /// All must outlive the object.
  Perturbation(const Perturbed& perturbed, const System& like);

  std::unique_ptr<const System> more, less;
  double difference = 0;
};

/// Derivatives of an equilibrium by the commands: K X + G L = F, G^T X = T, a column per actuator, with the stiffness K
/// and the slopes G of the measures that are held, both at the shape. F: how loads and layers change with the command;
/// T: the measures'.
class Derivative {
 public:
  /// All must outlive the object. work.home: the shape near which the workspace factorised, or empty
  Derivative(const System& system, Workspace& work, double accuracy, Team& team);

  /// at  multipliers in internal units
  [[nodiscard]] Sensitivity of(const Iterate& at, const Demand& demand);
  /// Along some changes of the commands.
  [[nodiscard]] ParameterSensitivity of(const Iterate& at, const Demand& demand, const std::vector<Actuation>& changes,
                                        bool reactions);
  /// Moves under dead forces on the vertices; none where there is no solution.
  [[nodiscard]] std::vector<Points> under(const Iterate& at, const Demand& demand, const std::vector<Points>& forces);
  /// By numbers of the robot: F and T are what the equations miss in the shape with more and less of them, over the
  /// difference. history, elapsed_s: of the equilibrium. reactions: are those of supports asked for
  [[nodiscard]] ParameterSensitivity of(const Iterate& at, const Demand& demand,
                                        const std::vector<Perturbation>& perturbations,
                                        const std::shared_ptr<const ViscousHistory>& history, double elapsed_s,
                                        bool reactions);
  /// Of what is told of the equilibrium, a row each, by numbers of the robot, by the adjoint: a solution for each row.
  /// The stiffness must be symmetric. No columns where there is no solution.
  [[nodiscard]] Eigen::MatrixXd of(const Iterate& at, const Demand& demand,
                                   const std::vector<Perturbation>& perturbations,
                                   const std::shared_ptr<const ViscousHistory>& history, double elapsed_s,
                                   const std::vector<ShapeGradient>& told);

 private:
  /// What a number changes in the shape as it is.
  struct Direct {
    Points force;           // gradient of the Lagrangian
    Eigen::VectorXd loads;  // those that are given, in internal units
  };

  /// What a robot's equations find in a shape, and where it has what is held.
  struct Found {
    Points gradient, held;
    Eigen::VectorXd constraint, multipliers;
  };

  void hold(const Iterate& at, const Demand& demand);
  void by_command(const Iterate& at, const Demand& demand, Index actuator, Points& force, Points& moves);
  [[nodiscard]] Found found_by(const System& system, const Iterate& at, const Demand& demand,
                               const std::shared_ptr<const ViscousHistory>& history, double elapsed_s) const;
  void make_room(Index columns);
  void ask(const Iterate& at, const Demand& demand);
  void ask(const Iterate& at, Index column, const Points& force, Points moves);
  Direct ask_number(const Iterate& at, const Demand& demand, Index column, const Perturbation& number,
                    const std::shared_ptr<const ViscousHistory>& history, double elapsed_s);
  void ask_adjoint(const Iterate& at, Index column, const ShapeGradient& told);
  Points ask_along(const Iterate& at, const Demand& demand, Index column, const Actuation& change);
  bool find(const Iterate& at, const Demand& demand);
  bool solve(const Iterate& at, bool exact_factor);
  [[nodiscard]] Points positions(const Iterate& at, Index column) const;
  [[nodiscard]] Eigen::VectorXd multipliers(Index column) const;
  [[nodiscard]] Points reactions(const Iterate& at, const Demand& demand, Index column, Points force,
                                 const Eigen::VectorXd& loads);

  const System& system_;
  Workspace& work_;
  double accuracy_;
  Team& team_;
  Balance balance_;  // at the shape
  std::vector<bool> active_;
  std::vector<Index> held_;
  Columns right_, found_;
  bool by_commands_ = false;   // are the columns those of the commands?
  std::vector<Points> moves_;  // per column: of what is moved itself; no rows: nothing
};

}  // namespace softkin::physical
