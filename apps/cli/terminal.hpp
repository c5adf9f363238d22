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
/// Raises the same flag at a deadline.
void stop_at(const Deadline& deadline);
/// Returns why the program is to stop: "interrupted" or "the budget of 5 s was spent".
[[nodiscard]] std::string why_stopped();

/// One line on stderr that is rewritten in place; where stderr is not a terminal a new one every ten seconds.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();  // clears the line
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Shows a line at most ten times a second, cut to the width of the terminal. text: ASCII. fraction: of the work, 0
  /// to 1; below 0 where it is unknown.
  void show(double fraction, const std::string& text);
  void clear();

 private:
  bool terminal_;
  bool shown_ = false;
  double last_ = 0;  // [s]
};

/// Returns the time of a monotonic clock [s].
[[nodiscard]] double seconds_now();

/// Returns the first lines, and how many were left out: "... and N more". most: lines to keep
[[nodiscard]] std::vector<std::string> cut(std::vector<std::string> lines, std::size_t most);

[[nodiscard]] std::string joined(const std::vector<std::string>& lines, const std::string& indent);

/// Does a line fit the terminal? Every line does where standard output is no terminal.
[[nodiscard]] bool fits_output(const std::string& line);

/// The table, its rows turned where it is wider than the terminal.
[[nodiscard]] std::string table_text(const Table& table);

/// "plot: F.svg", a line for each file that is given.
[[nodiscard]] std::string written_text(const std::vector<std::pair<std::string, std::string>>& files);

// Throw InvalidInput where standard output cannot be written.
void print(const std::string& text);
void print_piece(std::string_view text);  // without a flush

/// Prints help and version; reports anything else as bad usage in one line. command: whose --help explains the usage
[[nodiscard]] int answer_usage(const CLI::App& app, const CLI::ParseError& error, const std::string& command);

/// Reports bad usage in one line.
[[nodiscard]] int refuse_usage(const std::string& message, const std::string& command);

/// Returns the exit code of the chosen command; reports its exceptions in one line.
[[nodiscard]] int outcome_of(const Run& run);

}  // namespace softkin::cli
