#pragma once

#include <softkin/drive/marlin_link.hpp>
#include <softkin/drive/plan.hpp>
#include <softkin/io/table/table.hpp>
#include <string>

namespace softkin::runs {

// The texts of softkin drive.

/// A line each of the tendons, syringes and chambers that are driven: their requested motions, and their limits.
[[nodiscard]] Table tendon_table(const drive::Plan& plan);
[[nodiscard]] Table syringe_table(const drive::Plan& plan);
[[nodiscard]] Table chamber_table(const drive::Plan& plan);

/// A line for each row of the commands: where the plungers stand, and the ratios that follow from that.
[[nodiscard]] Table plunger_table(const drive::Plan& plan);

/// "9 rows, 12 s, after an approach of 0.5 s from home; 10 lines of G-code".
[[nodiscard]] std::string times_text(const drive::Plan& plan);

/// How a stream ended, in full sentences: which lines were executed, and is the position known. commands: their file
[[nodiscard]] std::string stream_text(const std::string& commands, const drive::GcodeProgram& program,
                                      const drive::StreamReport& report);

}  // namespace softkin::runs
