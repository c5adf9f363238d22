#pragma once

#include <nlohmann/json.hpp>
#include <softkin/drive/gcode.hpp>
#include <softkin/drive/pressure_schedule.hpp>
#include <string>

namespace softkin::cli {

/// What drive has planned.
struct DrivePlan {
  drive::Commands commands;
  drive::Machine machine;
  drive::Motion motion;
  drive::GcodeProgram program;  // no lines where there is no tendon
  drive::PressureSchedule schedule;
};

/// Tables of tendons and chambers with what is asked of them and their limits, the defaults, how long it takes.
[[nodiscard]] std::string plan_text(const DrivePlan& plan);
[[nodiscard]] nlohmann::ordered_json plan_json(const DrivePlan& plan);

}  // namespace softkin::cli
