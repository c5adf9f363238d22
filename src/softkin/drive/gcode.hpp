#pragma once

#include <softkin/drive/motion.hpp>
#include <string>

namespace softkin::drive {

/// A line that moves motors or waits.
struct GcodeLine {
  std::string text;
  double patience_s = 0;         // how long a sound board may take to answer: moves before it have to end first
  std::vector<double> position;  // per axis of the program, after the line
  std::size_t row = 0;           // line of the commands; 0: home
};

/// What is sent to a board.
struct GcodeProgram {
  std::string axes;                // letters
  std::vector<std::string> setup;  // moves nothing, may be repeated; ends with the G92 of the start
  std::vector<double> start;       // per axis
  std::vector<GcodeLine> lines;
  double drain_s = 0;  // how long the moves that a board plans ahead may last
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

}  // namespace softkin::drive
