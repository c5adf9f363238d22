#pragma once

#include <softkin/drive/gcode.hpp>
#include <softkin/drive/pressure_schedule.hpp>
#include <utility>
#include <vector>

namespace softkin::drive {

/// What is to be driven, within all limits.
struct Plan {
  Commands commands;
  Machine machine;
  Motion motion;
  GcodeProgram program;  // no lines where there is no tendon
  PressureSchedule schedule;
};

/// throws  InvalidInput as assemble, plan_pressures, plan_motion and make_gcode do
[[nodiscard]] Plan make_plan(const Model& model, const HardwareSpec& hardware, Commands commands, bool return_home);

/// What a plan asks of a tendon and its motor.
struct TendonUse {
  double shortest_mm = 0, longest_mm = 0;  // cable
  double fastest_mm_per_s = 0;             // motor [mm of cable]
  std::int64_t lowest = 0, highest = 0;    // steps from home
  std::optional<double> turns;             // of the drum from home, at the end farther from it; none: no drum
};
[[nodiscard]] TendonUse use_of(const Plan& plan, std::size_t tendon);

/// Least and greatest of a chamber [kPa].
[[nodiscard]] std::pair<double, double> pressure_range(const Plan& plan, std::size_t chamber);

[[nodiscard]] double seconds_of(const std::vector<Move>& moves);

}  // namespace softkin::drive
