#pragma once

#include <nanobind/nanobind.h>

#include <softkin/kinematics/goal.hpp>
#include <string>
#include <vector>

#include "robot.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace nb = nanobind;

/// A solve, watched as the size of the robot asks for. work owns all that it touches.
template <class Work>
auto watched_solve(const Robot& robot, const ProgressFunction& on_progress, Work work) {
  return robot.is_large() ? watched_apart(on_progress, std::move(work)) : watched(on_progress, work);
}

/// Session's statics, else the robot's, of which every solve stands for itself.
[[nodiscard]] inline const Statics& statics_of(const Robot& robot, const Session* session) {
  return session != nullptr ? session->statics : robot.statics();
}

/// May it use what an earlier solve left behind?
[[nodiscard]] inline bool keeps(const Session* session) {
  return session != nullptr && !session->map;
}

/// The options, of a material that remembers a shape where time passes since then. start: no equilibrium: nothing is
/// remembered. Throws InvalidInput where time passes that the robot does not know
[[nodiscard]] StaticsOptions remembering(const Statics& statics, const State& start, StaticsOptions options);

/// The content of a PNG file, as runs::image_png draws it.
[[nodiscard]] nb::bytes picture_of(const Shape& shape, const std::vector<double>& view, const std::string& title,
                                   const std::vector<Goal>& goals = {});

}  // namespace softkin::python
