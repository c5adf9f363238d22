#pragma once

#include <cstddef>
#include <softkin/core/progress.hpp>
#include <softkin/core/text.hpp>
#include <softkin/core/types.hpp>
#include <softkin/io/table/table.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command.hpp"

namespace softkin::cli {

/// From here on Ctrl-C only raises a flag; a second one ends the program at once.
void catch_interrupt();
[[nodiscard]] bool interrupted();
/// The same from a deadline on.
void stop_at(const Deadline& deadline);
/// Why it is to stop: "interrupted" or "the budget of 5 s was spent".
[[nodiscard]] std::string why_stopped();

/// One line on stderr that is rewritten in place; where stderr is not a terminal a new one every ten seconds.
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

/// The first lines, at most so many, and what was left out: "... and N more".
[[nodiscard]] std::vector<std::string> cut(std::vector<std::string> lines, std::size_t most);

[[nodiscard]] std::string joined(const std::vector<std::string>& lines, const std::string& indent);

/// Does a line fit the terminal? On standard output that is none everything does.
[[nodiscard]] bool fits_output(const std::string& line);

/// The table, its rows turned where it is wider than the terminal.
[[nodiscard]] std::string table_text(const Table& table);

/// "plot: F.svg", a line for each file that is given.
[[nodiscard]] std::string written_text(const std::vector<std::pair<std::string, std::string>>& files);

// Throw InvalidInput where standard output cannot be written.
void print(const std::string& text);
void print_piece(std::string_view text);  // without a flush

/// Help and version are printed; anything else is bad usage, told in one line. command: whose --help tells more.
[[nodiscard]] int answer_usage(const CLI::App& app, const CLI::ParseError& error, const std::string& command);

/// Bad usage, told in one line.
[[nodiscard]] int refuse_usage(const std::string& message, const std::string& command);

/// The exit code of what was chosen; what it throws is told in one line.
[[nodiscard]] int outcome_of(const Run& run);

}  // namespace softkin::cli
