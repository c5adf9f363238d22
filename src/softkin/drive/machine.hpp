#pragma once

#include <softkin/model/hardware_spec.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/paths.hpp>

namespace softkin::drive {

/// What holds where the hardware file says nothing.
struct HardwareDefaults {
  static constexpr double steps_per_mm = 80;
  static constexpr double steps_per_revolution = 3200;  // 200 full steps of 16 microsteps
  static constexpr double max_speed_mm_per_s = 50;
  static constexpr double max_acceleration_mm_per_s2 = 500;
  static constexpr double approach_speed_mm_per_s = 5;
  static constexpr double low_kpa = 0, high_kpa = 100;
};

/// A cable on its motor. Home is where the motor stands before the first command: the cable paid out to its length at
/// rest plus slack, the backlash taken up in the sense that winds; there the axis reads 0.
struct Tendon {
  Origin origin;
  std::string name;
  Index actuator = 0;
  char axis = 'X';
  int direction = 1;
  double rest_length_mm = 0;
  std::optional<double> drum_radius_mm;
  double axis_mm_per_cable_mm = 1;  // > 0
  double steps_per_mm = 0;          // of the axis
  double slack_offset_mm = 0, backlash_mm = 0;
  double shortest_mm = 0, longest_mm = 0;
  double max_speed_mm_per_s = 0, max_acceleration_mm_per_s2 = 0;  // of cable, at the motor

  /// Cable wound up from home when the free cable is so long.
  [[nodiscard]] double wound_mm(double length_mm) const { return rest_length_mm + slack_offset_mm - length_mm; }
  /// Steps from home at which the motor has wound up so much cable (backlash included).
  [[nodiscard]] double steps(double wound) const { return direction * wound * axis_mm_per_cable_mm * steps_per_mm; }
};

struct Chamber {
  Origin origin;
  std::string name, channel;
  Index actuator = 0;
  double low_kpa = 0, high_kpa = 0;
};

/// Model and hardware together.
struct Machine {
  std::string file;  // of the hardware
  bool configure = true;
  double approach_speed_mm_per_s = 0;
  std::vector<Tendon> tendons;
  std::vector<Chamber> chambers;
  std::vector<std::string> defaults;  // what was used as default, a line each
};

/// throws  InvalidInput, naming the hardware's line or the commands' file, on: entries for actuators that the model has
///         not or of another kind; commanded actuators without an entry; cables commanded by tension and dielectric
///         elastomers; chambers commanded by volume whose pressures are not known
[[nodiscard]] Machine assemble(const Model& model, const HardwareSpec& hardware, const Commands& commands);

}  // namespace softkin::drive
