#pragma once

#include <softkin/statics/physical/balance.hpp>
#include <softkin/statics/physical/iterate.hpp>
#include <softkin/statics/physical/tendons.hpp>
#include <softkin/statics/supports/actuator_measures.hpp>

namespace softkin::physical {

/// What cables and chambers pull and push with in the equations of equilibrium: the gradient of
/// sum_a sign_a multiplier_a measure_a. No term of the energy: a measure that is active is held to what is demanded,
/// and its multiplier is an unknown; else the multiplier is given. A cable that rubs pulls with less and less of its
/// multiplier, that is its tension at the motor: see Tendons. What fills a sealed chamber gives way: the volume that it
/// is held to follows from its multiplier.
///
/// active    per actuator
/// gradient  of each measure in turn, #V by 3, left there
class ActuatorLoads {
 public:
  explicit ActuatorLoads(const Model& model) : measures_(model), tendons_(model) {}

  [[nodiscard]] const supports::ActuatorMeasures& measures() const { return measures_; }
  [[nodiscard]] const Tendons& tendons() const { return tendons_; }
  void add_cliques(linear::Cliques& cliques) { measures_.add_cliques(cliques); }

  /// Adds the gradient; constraints and energy of the balance become those of the measures.
  void evaluate(const Iterate& at, const Demand& demand, const std::vector<bool>& active, std::vector<Points>& slopes,
                Points& gradient, Balance& balance) const;

  /// Second derivatives into their slots.
  void stiffness(const Iterate& at, LargeVector<double>& slots, Team& team) const;

  /// Adds how constraints change with moves of the vertices, to first order.
  void add_moves(const std::vector<bool>& active, const Points& positions, const Points& moves,
                 std::vector<Points>& slopes, Eigen::VectorXd& constraint) const;
  /// Adds how constraints and gradient change from one demand to another in one shape.
  void add_change(const Iterate& at, const Demand& from, const Demand& to, const std::vector<bool>& active,
                  std::vector<Points>& slopes, Eigen::VectorXd& constraint, Points& force) const;
  /// Adds what moves of the vertices change of the gradient beside the stiffness: by tendons that rub.
  void add_response(const Iterate& at, const Points& moves, Points& force) const;
  /// What a measure's multiplier pulls or pushes with, but for its sign, #V by 3.
  void pull(Index actuator, const Iterate& at, Points& force) const;
  /// Derivative of the gradient by a tension or pressure that is commanded [N per unit of command]; zero by others.
  void derivative(Index actuator, const Iterate& at, double command, Points& force) const;

 private:
  /// What a sealed chamber misses, and what its filling stores.
  void fill(Index actuator, double volume, double pressure, const Demand& demand, Balance& balance) const;

  supports::ActuatorMeasures measures_;
  Tendons tendons_;
};

}  // namespace softkin::physical
