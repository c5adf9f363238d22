#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Loads from outside on bodies and on the robot: springs that hold bodies at their positions at rest, and forces on
/// bodies and at places of the robot.
///
/// A body is held by a spring at each of its vertices. Between a command of 1 and 0 their stiffness falls by the same
/// factor over equal parts of the path, to zero at 0, so that the body comes to equilibrium while it is released.
class Surroundings : public Term {
 public:
  /// model must outlive the object.
  explicit Surroundings(const Model& model);

  /// Are there bodies?
  [[nodiscard]] bool any_body() const { return !model_.bodies.empty(); }

  /// Energy of the springs, less the work of the forces.
  void evaluate(const Iterate& at, const LoadState& load_state, Scratch& scratch, Sum& sum, Team& team) const override;

  /// Adds every vertex of a body.
  void add_cliques(linear::Cliques& cliques) override;
  void stiffness(const Iterate& at, const LoadState& load_state, bool projected, Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;

  /// Is a command a force on a body or the robot, or the hold of a body?
  [[nodiscard]] bool loads(Index command) const override;
  [[nodiscard]] bool holds(Index command) const { return model_.actuators[command].is<HoldCommand>(); }
  /// Adds the contribution of a force command to the gradient, linear in it [N].
  void add_force(Index command, double newtons, Points& gradient) const {
    add_force(std::get<ForceCommand>(model_.actuators[command].drive), newtons, gradient);
  }
  /// Adds the change to first order, at the load state `from`.
  void add_change(const LoadState& from, const LoadState& to, const Points& positions, Scratch& scratch, Points& force,
                  Team& team) const override;
  /// Adds the derivative by a force or hold command.
  void add_derivative(Index command, const LoadState& load_state, const Points& positions, Scratch& scratch,
                      Points& force, Team& team) const override;

 private:
  void add_spring(const FreeBody& body, double stiffness, const Points& positions, Points& gradient) const;
  void add_force(const ForceCommand& force, double newtons, Points& gradient) const;
  /// Where a force acts: at a body's center, or at a place of the robot.
  [[nodiscard]] const EmbeddedPoint& place_of(const ForceCommand& force) const {
    return force.place ? *force.place : model_.bodies[force.body].center;
  }

  const Model& model_;
  double stiffest_ = 0;  // stiffness of the springs at a command of 1 [N/mm]
  bool any_ = false;     // whether there is a command to evaluate
  std::int64_t first_slot_ = 0;
};

}  // namespace softkin::physical
