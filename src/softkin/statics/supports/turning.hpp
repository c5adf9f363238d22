#pragma once

#include <softkin/model/model.hpp>

namespace softkin::supports {

/// Positions of the vertices of supports that turn. At a load factor s a vertex that is at x at rest is at
/// about + R(s angle) (x - about) + s displacement, so that the path from rest consists of arcs.
class Turning {
 public:
  /// model must outlive the object.
  explicit Turning(const Model& model) : model_(model) {}

  [[nodiscard]] bool any() const { return !model_.held.turns.empty(); }

  /// Moves their vertices to where the actuation's angles [degrees] and the load factor place them.
  void place(const Eigen::VectorXd& actuation, double load_factor, Points& positions) const;

  /// Adds the derivative of place() by the command of a turn, #V by 3 [mm per degree]; nothing by another command.
  void add_velocity(Index actuator, const Eigen::VectorXd& actuation, double load_factor, Points& moves) const;

  /// Returns the angle of a shape, -180 to 180, that fits its vertices best [degrees], after their whole displacement.
  [[nodiscard]] double angle(Index actuator, const Points& positions) const;

  /// Returns the largest rotation on the path from one actuation and load factor to others [degrees].
  [[nodiscard]] double largest_turn(const Eigen::VectorXd& from, double from_fraction, const Eigen::VectorXd& to,
                                    double to_fraction) const;

 private:
  [[nodiscard]] const SupportTurn* turn_of(Index actuator) const;

  const Model& model_;
};

}  // namespace softkin::supports
