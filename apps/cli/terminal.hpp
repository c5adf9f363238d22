#pragma once

#include <softkin/core/text.hpp>
#include <string>

namespace softkin::cli {

/// From here on Ctrl-C only raises a flag; a second one ends the program at once.
void catch_interrupt();
[[nodiscard]] bool interrupted();

/// One line on stderr that is rewritten in place; nothing where stderr is not a terminal.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();  // clears the line
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// At most ten times a second, cut to the width of the terminal. text: ASCII. share: of the work, 0 to 1, or below 0
  /// where it is not known.
  void show(double share, const std::string& text);
  void clear();

 private:
  bool terminal_;
  bool shown_ = false;
  double last_ = 0;  // [s]
};

/// Of a clock that never jumps.
[[nodiscard]] double seconds_now();

}  // namespace softkin::cli
