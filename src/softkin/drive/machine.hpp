#pragma once

#include <array>
#include <optional>
#include <softkin/model/gas_law.hpp>
#include <softkin/model/hardware_spec.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/paths.hpp>
#include <string>
#include <vector>

namespace softkin::drive {

/// A stepper that moves a cable or a plunger: what it moves is measured in mm from home, where its axis reads 0. Here
/// and below the numbers hold where the hardware file does not set them.
struct Motor {
  Origin origin;              // of its entry in the hardware file
  std::string name;           // of the actuator
  Index actuator = 0;         // of the model
  char axis = 'X';            // letter in G-code
  int direction = 1;          // 1, -1: the axis' sense that shortens the cable or pushes the plunger
  double axis_mm_per_mm = 1;  // mm of axis in a mm of what it moves; > 0
  double steps_per_mm = 80;   // of the axis
  double backlash_mm = 0;     // taken up where it turns back; of cable or plunger
  double max_speed_mm_per_s = 50, max_acceleration_mm_per_s2 = 500;  // of cable or plunger, at the motor

  /// Steps from home at which the motor has moved so much (backlash included).
  [[nodiscard]] double steps(double mm) const { return direction * mm * axis_mm_per_mm * steps_per_mm; }
  /// Returns the motion of a number of steps [mm].
  [[nodiscard]] double mm(double steps) const { return direction * steps / (axis_mm_per_mm * steps_per_mm); }
};

/// A cable on its motor. Home is where the motor stands before the first command: the cable paid out to its length at
/// rest plus slack, the backlash taken up in the sense that winds.
struct Tendon : Motor {
  double rest_length_mm = 0;               // of the cable
  std::optional<double> drum_radius_mm;    // to the cable's centre line; none: not given
  double slack_offset_mm = 0;              // of cable, wound up before it is taut at rest
  double shortest_mm = 0, longest_mm = 0;  // that the free cable may be

  /// Cable wound up from home when the free cable is so long.
  [[nodiscard]] double wound_mm(double length_mm) const { return rest_length_mm + slack_offset_mm - length_mm; }
};

/// The plunger of a chamber's syringe on its motor. Home is where the chamber is at rest and the air under the pressure
/// around it, the backlash taken up in the sense that pushes.
struct Syringe : Motor {
  SyringeSetup air;                                 // volumes at home
  double mm3_per_mm = 0;                            // of plunger
  std::optional<double> lead_mm;                    // plunger in a revolution
  double lowest_mm = 0, highest_mm = 0;             // where it may stand, from home
  std::optional<std::array<double, 2>> limits_kpa;  // gauge
  bool by_pushed_mL = false;  // is what it has pushed commanded, so that its place depends on no pressure

  /// Where the plunger stands, from home, when the chamber is at a ratio under a gauge pressure: Eq. (18).
  [[nodiscard]] double plunger_mm(double ratio, double gauge_kpa) const {
    return syringe_volume(air, air.atmosphere_kPa + gauge_kpa, ratio) / mm3_per_mm;
  }
  /// The ratio to which it leads under a gauge pressure: Eq. (19).
  [[nodiscard]] double ratio(double plunger_mm, double gauge_kpa) const {
    return chamber_ratio(air, air.atmosphere_kPa + gauge_kpa, plunger_mm * mm3_per_mm);
  }
};

/// A chamber on a regulator.
struct Chamber {
  Origin origin;                       // of its entry in the hardware file
  std::string name, channel;           // of the actuator; in the schedule
  Index actuator = 0;                  // of the model
  double low_kpa = 0, high_kpa = 100;  // that it may be commanded to, gauge
};

/// Model and hardware together.
struct Machine {
  std::string file;                    // of the hardware
  bool configure = true;               // is the board sent its steps, limits and switches
  double approach_speed_mm_per_s = 5;  // of cable or plunger, where the commands have no times
  double atmosphere_kpa = 100;         // absolute; of the syringes
  std::vector<Tendon> tendons;         // motors of cables, by the hardware file
  std::vector<Syringe> syringes;       // motors of plungers
  std::vector<Chamber> chambers;       // on regulators
  std::vector<std::string> defaults;   // what was used as default, a line each

  /// Of the tendons, then of the syringes; they live as long as this machine stands where it is.
  [[nodiscard]] std::vector<const Motor*> motors() const;
};

/// throws  InvalidInput, naming the hardware's line or the commands' file, on: entries for actuators that the model has
///         not or of another kind; commanded actuators without an entry; cables commanded by tension and dielectric
///         elastomers; chambers commanded by volume whose pressures are not known, or on a syringe and commanded by
///         pressure; sealed chambers on no syringe of the scene, or on another one than the scene's; a plunger that is
///         allowed farther than its syringe is deep
[[nodiscard]] Machine assemble(const Model& model, const HardwareSpec& hardware, const Commands& commands);

}  // namespace softkin::drive
