#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/continuation.hpp>

namespace softkin::physical {

/// Loads rise to a maximum as a parabola does, and so do lengths and volumes that come to theirs: what is left of the
/// way falls with the square of the shape's slowness, so that two paces tell where it is.
void Continuation::note_pace(double length) {
  if (system_.contact() || !(move_mm_ > 0) || way_.done <= way_.paced_at) return;
  const double pace = move_mm_ / length, now = std::pow(pace, -2), last = std::pow(way_.pace, -2);
  way_.fold_before = way_.fold;
  if (way_.paced_at >= 0)
    way_.fold = now < last ? way_.done + now * (way_.done - way_.paced_at) / (last - now)
                           : std::numeric_limits<double>::infinity();
  way_.paced_at = way_.done;
  way_.pace = pace;
}

/// Where a step failed beyond the maximum that is foretold, the next ones stay before it. True where nothing is left and
/// it was foretold there before.
bool Continuation::near_fold() {
  constexpr double share = 0.8, least = 1e-4, same = 1e-3;  // of what is left; of the way
  if (!(way_.fold < way_.failed)) return false;
  const double left = way_.fold - way_.done;
  if (left < least && std::abs(way_.fold - way_.fold_before) < same) return left > 0;
  if (left > 0) way_.advance = std::min(way_.advance, share * left);
  return false;
}

}  // namespace softkin::physical
