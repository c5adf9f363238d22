#pragma once

#include <memory>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/supports/freedoms.hpp>
#include <softkin/statics/supports/global_step.hpp>
#include <softkin/statics/supports/turning.hpp>

namespace softkin::physical {

/// Where a demand holds the vertices that are no unknowns, and how the others move: what is fixed, supports that turn,
/// obstacles that are moved, rigid regions.
class Placement {
 public:
  /// model, body and freedoms must outlive the object.
  /// like  of a model that is held elsewhere by the same; null: none
  Placement(const Model& model, const Body& body, const supports::Freedoms& freedoms, const Placement* like);

  /// Puts what is fixed or commanded to move where a demand has it, and rigid regions into the pose that fits best.
  void hold(const Demand& demand, Points& positions) const;
  /// Does a change of demand move what holds the robot or stands around it?
  [[nodiscard]] bool changes(const Demand& from, const Demand& to) const;
  /// Derivative of what hold() places by a command, #V by 3 [mm per unit of command].
  void velocity(Index actuator, const Demand& demand, Points& moves) const;
  /// The command at which a shape has an obstacle [mm] or a turning support [degrees] where they are.
  [[nodiscard]] double command_of(Index actuator, const Points& positions) const;
  /// By how much a support turns at most from one demand to another [degrees].
  [[nodiscard]] double largest_turn(const Demand& from, const Demand& to) const {
    return supports_.largest_turn(from.actuation, from.share, to.actuation, to.share);
  }

  struct Scratch {
    Points moves, lacking;
  };
  /// Moves positions by scale times a step; elements turn with it instead of growing: equal to Freedoms::move to first
  /// order, and far better where a step bends the robot.
  /// held  what is fixed or commanded to move comes to where this has it
  void advance(const Eigen::VectorXd& step, double scale, Scratch& scratch, Body::Scratch& elastic, Points& positions,
               Team& team, const Demand* held = nullptr) const;

 private:
  const Model& model_;
  const Body& body_;
  const supports::Freedoms& freedoms_;
  bool contact_;  // things may touch
  supports::Turning supports_;
  std::shared_ptr<const supports::GlobalStep> turning_;
  /// Of the obstacle that an actuator moves; of another none.
  struct Moved {
    std::array<Index, 2> vertices{0, 0};
    int axis = 0;
  };

  std::vector<Moved> moved_;  // per actuator
};

}  // namespace softkin::physical
