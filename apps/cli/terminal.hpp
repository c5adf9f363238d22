#pragma once

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

/// "45 s", "3 min 20 s", "2 h 5 min".
[[nodiscard]] std::string duration(double seconds);

/// The shortest decimal text of a number at so many significant digits.
[[nodiscard]] std::string number(double value, int digits = 6);

/// The shortest decimal text that reads back as the number.
[[nodiscard]] std::string exact(double value);

/// A number with so many digits behind the point.
[[nodiscard]] std::string decimal(double value, int decimals);

}  // namespace softkin::cli
