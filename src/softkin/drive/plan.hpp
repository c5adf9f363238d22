#pragma once

#include <softkin/drive/motion.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin::drive {

/// A line that moves motors or waits.
struct GcodeLine {
  std::string text;              // without number, checksum and end
  double patience_s = 0;         // how long a sound board may take to answer: moves before it have to end first
  std::vector<double> position;  // per axis of the program, after the line
  std::size_t row = 0;           // line of the commands; 0: home
};

/// What is sent to a board.
struct GcodeProgram {
  std::string axes;                // letters
  std::vector<std::string> setup;  // moves nothing, may be repeated; ends with the G92 of the start
  std::vector<double> start;       // per axis
  std::vector<GcodeLine> lines;    // moves and rests, in their order
  double drain_s = 0;              // how long the moves that a board plans ahead may last
};

/// G-code for Marlin. G1 names every axis, absolute (G90), in whole steps; a rest is G4. M400 stands between the
/// approach and the first row's moves. A feed rate F [mm/min] makes a move last its time: Marlin takes F along the
/// Euclidean length, in steps, of X, Y, Z together; where none of these moves, of A, B, C (U, V, W). The other axes
/// keep pace.
///
/// throws  InvalidInput where a line is longer than Marlin reads (96 characters with number and checksum)
[[nodiscard]] GcodeProgram make_gcode(const Machine& machine, const Motion& motion);

/// The program as a file, comments included, for a sender of the user's own; ends with M400.
[[nodiscard]] std::string gcode_text(const Machine& machine, const GcodeProgram& program);

/// Gauge pressures over time; between rows they change linearly.
struct PressureSchedule {
  std::vector<std::string> channels;  // names, in the hardware file's order
  /// Pressures at one time.
  struct Row {
    double time_s = 0;        // from the first row
    std::vector<double> kpa;  // per channel
  };
  std::vector<Row> rows;  // times ascend
};

/// The pressures that the chambers are commanded to, one row for each of the commands.
///
/// throws  InvalidInput naming file:line, chamber, pressure and limit; or the file where it has no times
[[nodiscard]] PressureSchedule plan_pressures(const Machine& machine, const Commands& commands);

/// CSV: t_s, then a column CHANNEL_kPa for each.
[[nodiscard]] std::string schedule_csv(const PressureSchedule& schedule);

/// What is to be driven, within all limits.
struct Plan {
  Commands commands;          // requested
  Machine machine;            // that carries them out
  Motion motion;              // of its motors
  GcodeProgram program;       // no lines where there is no motor
  PressureSchedule schedule;  // of its regulators

  /// Is there anything to send to a board?
  [[nodiscard]] bool has_motors() const { return !machine.tendons.empty() || !machine.syringes.empty(); }
};

/// throws  InvalidInput as take_curve_pressures, assemble, plan_pressures, plan_motion and make_gcode do
[[nodiscard]] Plan make_plan(const Model& model, const HardwareSpec& hardware, Commands commands, bool return_home);

/// Least and greatest of a chamber [kPa].
[[nodiscard]] std::pair<double, double> pressure_range(const Plan& plan, std::size_t chamber);

}  // namespace softkin::drive
