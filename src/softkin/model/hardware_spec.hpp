#pragma once

#include <array>
#include <optional>
#include <softkin/core/error.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A stepper motor as the user describes it; empty members take the defaults of drive/machine.hpp.
struct MotorSpec {
  Origin origin;                               // of its entry, for messages
  std::string actuator;                        // name of the robot's actuator that it moves
  char axis = 'X';                             // letter in G-code
  std::optional<double> steps_per_revolution;  // motor, microsteps and gear; > 0
  std::optional<double> steps_per_mm;          // of the axis, as the board has it (M92); > 0
  std::optional<int> direction;                // 1, -1: the axis' sense that shortens the cable, pushes the plunger
  std::optional<double> backlash_mm;           // of cable or plunger, as the two below; >= 0
  std::optional<double> max_speed_mm_per_s;    // > 0
  std::optional<double> max_acceleration_mm_per_s2;  // > 0
};

/// The motor of a cable.
struct TendonSpec : MotorSpec {
  std::optional<double> rest_length_mm;   // measured; > 0
  std::optional<double> drum_radius_mm;   // to the cable's centre line; > 0
  std::optional<double> slack_offset_mm;  // cable to wind up before it is taut at rest; >= 0
  std::optional<std::array<double, 2>>
      length_limits_mm;  // of the free cable, shortest and longest [mm]; none: the range of the commands
};

/// The syringe that a chamber stands on, with the motor of its plunger.
struct SyringeSpec : MotorSpec {
  std::optional<double> chamber_mL;                       // at rest; > 0
  double syringe_mL = 0;                                  // air in it at home; > 0
  std::optional<double> dead_volume_mL;                   // tubes, fittings and sensor; >= 0
  double mL_per_mm = 0;                                   // of plunger; > 0
  std::optional<double> lead_mm;                          // plunger in a revolution of the motor; > 0
  std::optional<std::array<double, 2>> travel_limits_mm;  // from home, pushed in
  std::optional<std::array<double, 2>> limits_kpa;        // gauge
};

/// The regulator of a chamber as the user describes it.
struct ChamberSpec {
  Origin origin;                                    // of its entry, for messages
  std::string actuator;                             // name of the robot's chamber
  std::optional<std::string> channel;               // its name in the schedule
  std::optional<std::array<double, 2>> limits_kpa;  // gauge
};

/// The hardware that drives a robot, as the user describes it.
struct HardwareSpec {
  std::string file;                               // for messages
  std::optional<bool> configure;                  // send the board its steps, limits and switches
  std::optional<double> approach_speed_mm_per_s;  // of cable or plunger, where the commands have no times; > 0
  std::optional<double> atmosphere_kPa;           // absolute; > 0
  std::vector<TendonSpec> tendons;                // of cables, in the file's order
  std::vector<SyringeSpec> syringes;              // of chambers on syringes
  std::vector<ChamberSpec> chambers;              // of chambers on regulators
};

}  // namespace softkin
