#pragma once

#include <nanobind/nanobind.h>

#include "robot.hpp"

namespace softkin::python {

namespace nb = nanobind;

/// Session's statics, else the robot's, of which every solve stands for itself.
[[nodiscard]] inline const Statics& statics_of(const Robot& robot, const Session* session) {
  return session != nullptr ? session->statics : robot.statics();
}

}  // namespace softkin::python
