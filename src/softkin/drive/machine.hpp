#pragma once

#include <cstdint>
#include <softkin/model/hardware_spec.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/paths.hpp>

namespace softkin::drive {

/// A cable on its motor. Home is where the motor stands before the first command: the cable paid out to its length at
/// rest plus slack, the backlash taken up in the sense that winds; there the axis reads 0. Here and below the numbers
/// hold where the hardware file says nothing.
struct Tendon {
  Origin origin;
  std::string name;
  Index actuator = 0;
  char axis = 'X';
  int direction = 1;
  double rest_length_mm = 0;
  std::optional<double> drum_radius_mm;
  double axis_mm_per_cable_mm = 1;  // > 0
  double steps_per_mm = 80;         // of the axis
  double slack_offset_mm = 0, backlash_mm = 0;
  double shortest_mm = 0, longest_mm = 0;
  double max_speed_mm_per_s = 50, max_acceleration_mm_per_s2 = 500;  // of cable, at the motor

  /// Cable wound up from home when the free cable is so long.
  [[nodiscard]] double wound_mm(double length_mm) const { return rest_length_mm + slack_offset_mm - length_mm; }
  /// Steps from home at which the motor has wound up so much cable (backlash included).
  [[nodiscard]] double steps(double wound) const { return direction * wound * axis_mm_per_cable_mm * steps_per_mm; }
};

struct Chamber {
  Origin origin;
  std::string name, channel;
  Index actuator = 0;
  double low_kpa = 0, high_kpa = 100;
};

/// Model and hardware together.
struct Machine {
  std::string file;  // of the hardware
  bool configure = true;
  double approach_speed_mm_per_s = 5;
  std::vector<Tendon> tendons;
  std::vector<Chamber> chambers;
  std::vector<std::string> defaults;  // what was used as default, a line each
};

/// throws  InvalidInput, naming the hardware's line or the commands' file, on: entries for actuators that the model has
///         not or of another kind; commanded actuators without an entry; cables commanded by tension and dielectric
///         elastomers; chambers commanded by volume whose pressures are not known
[[nodiscard]] Machine assemble(const Model& model, const HardwareSpec& hardware, const Commands& commands);

/// Motors of all tendons, in steps from home.
using Steps = std::vector<std::int64_t>;

/// A straight move of all motors together, or a rest where it leads nowhere.
struct Move {
  Steps target;
  double seconds = 0;
  std::size_t line = 0;  // of the commands; 0: home
};

/// What a file of commands asks of the motors, within all limits.
struct Motion {
  std::vector<Move> approach;  // from home to the first row; may be empty
  std::vector<Move> moves;     // from the first row on: the file's clock runs
  std::vector<Move> back;      // home again, if asked; may be empty
  bool timed = false;          // do the commands have times; else moves take as long as they need
  double seconds = 0;          // of moves
};

/// The moves for a file of commands. A cable's length is its ratio times its length at rest. Where a motor turns back,
/// its move is longer by the backlash, so that the cable is where it should be when the move ends. Moves of fewer steps
/// than a board plans (6: MIN_STEPS_PER_SEGMENT) wait for the next rows; no time is lost by that.
///
/// throws  InvalidInput naming file:line, tendon, value and limit where a length, a speed, or an acceleration is
///         outside its limits. Speed: that of the motor [mm of cable per s] from row to row, backlash included.
///         Acceleration: change of speed between two rows' moves over the mean of their times; the first begins and
///         the last ends at rest
[[nodiscard]] Motion plan_motion(const Machine& machine, const Commands& commands, bool return_home);

}  // namespace softkin::drive
