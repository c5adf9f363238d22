#pragma once

#include <softkin/model/model.hpp>

namespace softkin::supports {

/// Where supports that turn hold their vertices. At a share s of all that holds the robot a vertex that stands at x at
/// rest is at about + R(s angle) (x - about) + s displacement, so that a way from rest goes along arcs.
class Turning {
 public:
  /// model must outlive the object.
  explicit Turning(const Model& model) : model_(model) {}

  [[nodiscard]] bool any() const { return !model_.held.turns.empty(); }

  /// Puts their vertices where the actuation's angles [degrees] and the share have them.
  void place(const Eigen::VectorXd& actuation, double share, Points& positions) const;

  /// Adds the derivative of place() by the command of a turn, #V by 3 [mm per degree]; nothing by another command.
  void add_velocity(Index actuator, const Eigen::VectorXd& actuation, double share, Points& moves) const;

  /// The angle of a shape, -180 to 180, that fits its vertices best [degrees]; they are displaced by all of it.
  [[nodiscard]] double angle(Index actuator, const Points& positions) const;

  /// By how much something turns at most on the way from one angle and share to others [degrees].
  [[nodiscard]] double largest_turn(const Eigen::VectorXd& from, double from_share, const Eigen::VectorXd& to,
                                    double to_share) const;

 private:
  [[nodiscard]] const SupportTurn* turn_of(Index actuator) const;

  const Model& model_;
};

}  // namespace softkin::supports
