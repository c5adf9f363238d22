#pragma once

#include <softkin/linear/block_matrix.hpp>
#include <softkin/model/model.hpp>

namespace softkin::physical {

/// What is done to bodies and obstacles: springs that hold bodies where they are at rest, forces on bodies, motions of
/// obstacles.
///
/// A body is held by a spring at each of its vertices. Of a command between 0 and 1 their stiffness falls by the same
/// factor for every part of the way, to nothing at 0: the body settles where it is free while it is being released.
class Surroundings {
 public:
  /// model must outlive the object.
  explicit Surroundings(const Model& model);

  /// Are there bodies?
  [[nodiscard]] bool any_body() const { return !model_.bodies.empty(); }

  /// Adds the motions of obstacles to positions at which these are where they stand at rest.
  void place(const Eigen::VectorXd& actuation, Points& positions) const;

  /// How far an obstacle is from where it stands at rest, along its command's axis [mm].
  [[nodiscard]] double moved(Index actuator, const Points& positions) const;

  /// Energy of the springs, less the work of the forces [mJ]; adds the gradient [N].
  double add_gradient(const Eigen::VectorXd& actuation, const Points& positions, Points& gradient) const;

  /// Adds every vertex of a body as a clique.
  void add_cliques(linear::Cliques& cliques);
  /// Second derivatives into the slots of those cliques, 9 values each [N/mm].
  void stiffness(const Eigen::VectorXd& actuation, LargeVector<double>& slots) const;

  /// Derivative of the gradient by the command of a force or a hold at fixed positions, #V by 3; zero of a motion or
  /// a turn.
  void command_force(Index actuator, const Eigen::VectorXd& actuation, const Points& positions, Points& force) const;
  /// Derivative of the positions by the command of a motion, #V by 3.
  void motion(Index actuator, Points& moves) const;

 private:
  void add_spring(const FreeBody& body, double stiffness, const Points& positions, Points& gradient) const;

  const Model& model_;
  double stiffest_ = 0;                            // of a body that is held [N/mm]
  std::vector<std::array<Index, 2>> vertices_of_;  // per actuator: of the obstacle that it moves
  std::int64_t first_slot_ = 0;
};

}  // namespace softkin::physical
