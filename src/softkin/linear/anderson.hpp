#pragma once

#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::linear {

/// Anderson acceleration of a fixed-point iteration x <- G(x): the combination of the last iterates whose step G(x) - x
/// is least in the least-squares sense.
///
/// source  Walker and Ni 2011, type II; restarts when a step is twice as long as the shortest since the last restart
class Anderson {
 public:
  explicit Anderson(int window) : window_(window) {}

  /// x: where the iteration was; image: G(x). Returns where to go on from.
  [[nodiscard]] Points next(const Points& x, const Points& image);

  /// Forgets the iterates so far.
  void restart();

 private:
  int window_;
  std::vector<Points> step_changes_, image_changes_;  // the last `window_` of them
  Points last_step_, last_image_;
  double shortest_ = 0;
};

}  // namespace softkin::linear
