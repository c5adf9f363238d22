#pragma once

#include <cstdint>
#include <softkin/drive/machine.hpp>
#include <vector>

namespace softkin::drive {

/// All motors of a machine, in steps from home.
using Steps = std::vector<std::int64_t>;

/// A straight move of all motors together, or a rest where it leads nowhere.
struct Move {
  Steps target;          // of all motors
  double seconds = 0;    // that it lasts
  std::size_t line = 0;  // of the commands; 0: home
};

/// What a file of commands asks of the motors, within all limits.
struct Motion {
  std::vector<Move> approach;  // from home to the first row; may be empty
  std::vector<Move> moves;     // from the first row on: the file's clock runs
  std::vector<Move> back;      // home again, if requested; may be empty
  bool timed = false;          // do the commands have times; else moves take as long as they need
  double seconds = 0;          // of moves
};

/// The moves for a file of commands. A cable's length is its ratio times its length at rest; a plunger stands where
/// the gas law has it for the chamber's ratio and pressure. Where a motor turns back, its move is longer by the
/// backlash, so that cable or plunger is where it should be when the move ends. Moves of fewer steps than a board
/// plans (6: MIN_STEPS_PER_SEGMENT) wait for the next rows; no time is lost by that.
///
/// throws  InvalidInput naming file:line, tendon or syringe, value and limit where a length, a place, a
///         pressure, a speed, or an acceleration is outside its limits. Speed: that of the motor [mm of cable or
///         plunger per s] from row to row, backlash included. Acceleration: change of speed between two rows' moves
///         over the mean of their times; the first begins and the last ends at rest
[[nodiscard]] Motion plan_motion(const Machine& machine, const Commands& commands, bool return_home);

}  // namespace softkin::drive
