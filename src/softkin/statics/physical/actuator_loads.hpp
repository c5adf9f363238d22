#pragma once

#include <softkin/statics/physical/balance.hpp>
#include <softkin/statics/physical/iterate.hpp>
#include <softkin/statics/physical/tendons.hpp>
#include <softkin/statics/supports/actuator_measures.hpp>

namespace softkin::physical {

/// The contribution of cables and chambers to the equations of equilibrium: the gradient of sum_a sign_a multiplier_a
/// measure_a. It is not a term of the energy: an active measure is constrained to its target and its multiplier is an
/// unknown; otherwise the multiplier is given. Along a cable with friction the tension decreases from the multiplier,
/// which is the tension at the motor: see Tendons. The filling of a sealed chamber is compliant: the volume to which
/// the chamber is constrained follows from the multiplier.
///
/// active  per actuator
/// slopes  gradient of each measure, #V by 3, overwritten
class ActuatorLoads {
 public:
  explicit ActuatorLoads(const Model& model) : measures_(model), tendons_(model) {}

  [[nodiscard]] const supports::ActuatorMeasures& measures() const { return measures_; }
  [[nodiscard]] const Tendons& tendons() const { return tendons_; }
  void add_cliques(linear::Cliques& cliques) { measures_.add_cliques(cliques); }

  /// Adds the gradient. Constraints and energy of the balance become those of the measures.
  void evaluate(const Iterate& at, const LoadState& load_state, const std::vector<bool>& active,
                std::vector<Points>& slopes, Points& gradient, Balance& balance) const;

  /// Writes second derivatives into their slots.
  void stiffness(const Iterate& at, LargeVector<double>& slots, Team& team) const;

  /// Adds how constraints change with moves of the vertices, to first order.
  void add_moves(const std::vector<bool>& active, const Points& positions, const Points& moves,
                 std::vector<Points>& slopes, Eigen::VectorXd& constraint) const;
  /// Adds the changes of constraints and gradient from one load state to another in one shape.
  void add_change(const Iterate& at, const LoadState& from, const LoadState& to, const std::vector<bool>& active,
                  std::vector<Points>& slopes, Eigen::VectorXd& constraint, Points& force) const;
  /// Adds the change of the gradient under moves of the vertices that is not part of the stiffness, from tendons with
  /// friction.
  void add_response(const Iterate& at, const Points& moves, Points& force) const;
  /// Computes the nodal forces per unit of a measure's multiplier, without its sign, #V by 3.
  void pull(Index actuator, const Iterate& at, Points& force) const;
  /// Computes the derivative of the gradient by a commanded tension or pressure [N per unit of command]; zero for
  /// others.
  void derivative(Index actuator, const Iterate& at, double command, Points& force) const;

 private:
  /// Sets the constraint of a sealed chamber and adds the energy of its filling.
  void fill(Index actuator, double volume, double pressure, const LoadState& load_state, Balance& balance) const;

  supports::ActuatorMeasures measures_;
  Tendons tendons_;
};

}  // namespace softkin::physical
