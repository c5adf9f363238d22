#pragma once

#include <memory>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/supports/freedoms.hpp>
#include <softkin/statics/supports/global_step.hpp>
#include <softkin/statics/supports/turning.hpp>

namespace softkin::physical {

/// Positions of the vertices that are no unknowns under a load state (fixed vertices, turning supports, moved
/// obstacles), and moves of the others, with rigid regions.
class Placement {
 public:
  /// model, body and freedoms must outlive the object.
  /// like  placement of a model with the same supports at other places; null: none
  Placement(const Model& model, const Body& body, const supports::Freedoms& freedoms, const Placement* like);

  /// Moves fixed and commanded vertices to their places under a load state, and rigid regions into their best-fit
  /// poses.
  void hold(const LoadState& load_state, Points& positions) const;
  /// Does a change of the load state move supports or obstacles?
  [[nodiscard]] bool changes(const LoadState& from, const LoadState& to) const;
  /// Computes the derivative of the places that hold() sets by a command, #V by 3 [mm per unit of command].
  void velocity(Index actuator, const LoadState& load_state, Points& moves) const;
  /// Returns the command at which an obstacle [mm] or a turning support [degrees] stands as in a shape.
  [[nodiscard]] double command_of(Index actuator, const Points& positions) const;
  /// Returns the largest rotation of a support between two load states [degrees].
  [[nodiscard]] double largest_turn(const LoadState& from, const LoadState& to) const {
    return supports_.largest_turn(from.actuation, from.load_factor, to.actuation, to.load_factor);
  }

  struct Scratch {
    Points moves, lacking;
  };
  /// Moves positions by scale times a step; elements turn with it instead of growing: equal to Freedoms::move to first
  /// order, and far better where a step bends the robot.
  /// held  load state to whose places fixed and commanded vertices move; null: these stay
  void advance(const Eigen::VectorXd& step, double scale, Scratch& scratch, Body::Scratch& elastic, Points& positions,
               Team& team, const LoadState* held = nullptr) const;

 private:
  const Model& model_;
  const Body& body_;
  const supports::Freedoms& freedoms_;
  bool contact_;  // contact is possible
  supports::Turning supports_;
  std::shared_ptr<const supports::GlobalStep> turning_;
  /// The vertices of the obstacle that an actuator moves; none for other actuators.
  struct Moved {
    std::array<Index, 2> vertices{0, 0};
    int axis = 0;
  };

  std::vector<Moved> moved_;  // per actuator
};

}  // namespace softkin::physical
