#pragma once

#include <nlohmann/json.hpp>
#include <softkin/drive/gcode.hpp>
#include <softkin/drive/pressure_schedule.hpp>
#include <string>

namespace softkin::cli {

/// What drive has planned.
struct DrivePlan {
  Commands commands;
  Machine machine;
  Motion motion;
  GcodeProgram program;  // no lines where there is no tendon
  PressureSchedule schedule;
};

/// Tables of tendons and chambers with what is asked of them and their limits, the defaults, how long it takes.
[[nodiscard]] std::string plan_text(const DrivePlan& plan);
[[nodiscard]] nlohmann::ordered_json plan_json(const DrivePlan& plan);

}  // namespace softkin::cli
