#pragma once

#include <nlohmann/json.hpp>
#include <softkin/drive/marlin_link.hpp>
#include <string>

#include "drive_options.hpp"

namespace softkin::cli {

/// Sends a program to the board at the port. Ctrl-C stops after the moves that the board has, a second one at once,
/// a third one ends the program; Ctrl-Z pauses and goes on.
///
/// throws  InvalidInput where the log cannot be opened
[[nodiscard]] drive::StreamReport send_to_board(drive::SerialPort& port, const DriveOptions& options,
                                                const drive::GcodeProgram& program);

/// How a stream ended, in full sentences: which lines were executed, and is the position known.
[[nodiscard]] std::string stream_text(const DriveOptions& options, const drive::GcodeProgram& program,
                                      const drive::StreamReport& report);
[[nodiscard]] nlohmann::ordered_json stream_json(const drive::GcodeProgram& program, const drive::StreamReport& report);

}  // namespace softkin::cli
