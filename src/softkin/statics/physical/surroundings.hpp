#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// What is done to bodies and to the robot: springs that hold bodies where they are at rest, forces on these and at
/// places of the robot.
///
/// A body is held by a spring at each of its vertices. Of a command between 0 and 1 their stiffness falls by the same
/// factor for every part of the way, to nothing at 0: the body settles where it is free while it is being released.
class Surroundings : public Term {
 public:
  /// model must outlive the object.
  explicit Surroundings(const Model& model);

  /// Are there bodies?
  [[nodiscard]] bool any_body() const { return !model_.bodies.empty(); }

  /// Energy of the springs, less the work of the forces.
  void evaluate(const Iterate& at, const Demand& demand, Scratch& scratch, Sum& sum, Team& team) const override;

  /// Adds every vertex of a body.
  void add_cliques(linear::Cliques& cliques) override;
  void stiffness(const Iterate& at, const Demand& demand, bool projected, Scratch& scratch, LargeVector<double>& slots,
                 Team& team) const override;

  /// A force, or what holds a body.
  [[nodiscard]] bool loads(Index command) const override;
  [[nodiscard]] bool holds(Index command) const { return model_.actuators[command].is<HoldCommand>(); }
  /// What a command of a force adds to the gradient, linear in it [N].
  void add_force(Index command, double newtons, Points& gradient) const {
    add_force(std::get<ForceCommand>(model_.actuators[command].drive), newtons, gradient);
  }
  /// To first order, from the first demand on.
  void add_change(const Demand& from, const Demand& to, const Points& positions, Scratch& scratch, Points& force,
                  Team& team) const override;
  /// Of a force or a hold.
  void add_derivative(Index command, const Demand& demand, const Points& positions, Scratch& scratch, Points& force,
                      Team& team) const override;

 private:
  void add_spring(const FreeBody& body, double stiffness, const Points& positions, Points& gradient) const;
  void add_force(const ForceCommand& force, double newtons, Points& gradient) const;
  /// Where a force acts: at a body's center, or at a place of the robot.
  [[nodiscard]] const EmbeddedPoint& place_of(const ForceCommand& force) const {
    return force.place ? *force.place : model_.bodies[force.body].center;
  }

  const Model& model_;
  double stiffest_ = 0;  // of a body that is held [N/mm]
  bool any_ = false;     // is there a command to evaluate
  std::int64_t first_slot_ = 0;
};

}  // namespace softkin::physical
