#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace softkin::drive {

/// One line that Marlin sent.
struct MarlinAnswer {
  enum class Kind {
    ok,          // "ok"; "ok N12 P15 B3" (ADVANCED_OK), where number is 12; "ok X:1.00 Y:2.00 ...", with position
    resend,      // "Resend: 12", number 12
    line_error,  // "Error:checksum mismatch, Last Line: 11": a line came damaged or out of order; number 11
    busy,        // "echo:busy: processing"
    started,     // "start": the board has booted
    halted,      // "!!", "Error:Printer halted. kill() called!"
    error,       // any other: a fault of the board, or in another maker's words of a line, which a resend follows
    position,    // "X:1.00 Y:2.00 Z:0.00 E:0.00 Count X:80 Y:160 Z:0"
    other        // anything else, garbage too
  };
  Kind kind = Kind::other;
  std::optional<long> number;
  std::vector<std::pair<char, double>> position;  // letter and coordinate, up to "Count"
};

[[nodiscard]] MarlinAnswer parse_answer(std::string_view line);

}  // namespace softkin::drive
