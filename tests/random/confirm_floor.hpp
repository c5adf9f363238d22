#pragma once

#include <softkin/model/model.hpp>

#include "random/confirm.hpp"
#include "random/reference_elements.hpp"

namespace softkin::random_robots {

/// What is to be true of a smooth floor, whatever its law: nothing is below it, and it only pushes, upwards alone, and
/// only what is nearer than the contact distance.
class ConfirmedFloor {
 public:
  ConfirmedFloor(const Model& model, const Points& positions);

  /// Takes from forces that lack the floor's what a push of it can balance, at what may move along z.
  void push(const std::vector<bool>& of_rigid, RealPoints& sum) const;

  /// Is a vertex so near, or does a node beside it that is hand it a part of its push?
  [[nodiscard]] bool near(Index vertex) const { return near_[vertex] || beside_[vertex]; }

  /// How far the deepest point is below it [mm]; <= 0: none is.
  [[nodiscard]] double depth() const { return depth_; }

 private:
  const Model& model_;
  std::vector<bool> of_surface_, near_, beside_;
  double depth_ = 0;
};

}  // namespace softkin::random_robots
