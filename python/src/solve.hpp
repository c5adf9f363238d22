#pragma once

#include <nanobind/nanobind.h>

#include "robot.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace nb = nanobind;

/// A solve, watched as the size of the robot asks for. work owns all that it touches.
template <class Work>
auto watched_solve(const Robot& robot, const Tell& tell, Work work) {
  return robot.is_large() ? watched_apart(tell, std::move(work)) : watched(tell, work);
}

/// Session's statics, else the robot's, of which every solve stands for itself.
[[nodiscard]] inline const Statics& statics_of(const Robot& robot, const Session* session) {
  return session != nullptr ? session->statics : robot.statics();
}

}  // namespace softkin::python
