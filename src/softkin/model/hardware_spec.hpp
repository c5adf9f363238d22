#pragma once

#include <array>
#include <optional>
#include <softkin/core/error.hpp>
#include <string>
#include <vector>

namespace softkin {

/// The motor of a cable as the user describes it; what is empty takes the default of drive/machine.hpp.
struct TendonSpec {
  Origin origin;
  std::string actuator;
  char axis = 'X';                             // letter in G-code
  std::optional<double> rest_length_mm;        // measured; > 0
  std::optional<double> drum_radius_mm;        // to the cable's centre line; > 0
  std::optional<double> steps_per_revolution;  // of the drum: motor, microsteps and gear; > 0
  std::optional<double> steps_per_mm;          // of the axis, as the board has it (M92); > 0
  std::optional<int> direction;                // 1, -1: the axis' sense that shortens the cable
  std::optional<double> slack_offset_mm;       // cable to wind up before it is taut at rest; >= 0
  std::optional<double> backlash_mm;           // of cable; >= 0
  std::optional<std::array<double, 2>> length_limits_mm;
  std::optional<double> max_speed_mm_per_s;          // > 0
  std::optional<double> max_acceleration_mm_per_s2;  // > 0
};

/// The regulator of a chamber as the user describes it.
struct ChamberSpec {
  Origin origin;
  std::string actuator;
  std::optional<std::string> channel;               // its name in the schedule
  std::optional<std::array<double, 2>> limits_kpa;  // gauge
};

/// What drives a robot, as the user wrote it.
struct HardwareSpec {
  std::string file;
  std::optional<bool> configure;                  // send the board its steps, limits and switches
  std::optional<double> approach_speed_mm_per_s;  // of cable, where the commands have no times; > 0
  std::vector<TendonSpec> tendons;
  std::vector<ChamberSpec> chambers;
};

}  // namespace softkin
