#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softkin {

/// The column of times [s] in every table that has them.
inline constexpr const char* time_column = "t_s";

/// A table of finite numbers under a header; lines that begin with # and blank lines are skipped.
struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
  std::size_t header_line = 0;
  std::vector<std::size_t> lines;  // line of each row in the file, for messages
  std::string file;

  [[nodiscard]] std::optional<std::size_t> find(const std::string& column) const;
  /// Throws InvalidInput of that row, or of the header.
  [[noreturn]] void fail(std::size_t row, const std::string& message) const;
  [[noreturn]] void fail_header(const std::string& message) const;
};

/// throws  InvalidInput naming file and line: no header, no row, a duplicate or empty column name, a row of another
///         length, a cell that is not a finite number
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& path);
/// The same where a cell may be empty: it is NaN.
[[nodiscard]] CsvTable read_csv_with_gaps(const std::filesystem::path& path);

/// The same of the text of a file.
[[nodiscard]] CsvTable parse_csv(const std::string& file, std::string_view text);

/// A table of measurements: columns named with their unit, in lower case here; optional column run (whole numbers) and
/// t_s [s], which ascends within a run.
struct RunTable : CsvTable {
  struct Run {
    std::string name;               // "run 2"
    std::vector<std::size_t> rows;  // in their order
  };
  std::vector<Run> runs;

  /// known   columns besides run and t_s, in lower case
  /// units   what begins the name of a column and what its unit must be: "p_", "pressures are in kPa"
  /// throws  InvalidInput naming file and line, as read_csv, and on unknown columns
  RunTable(const std::filesystem::path& path, const std::vector<std::string>& known,
           const std::vector<std::pair<std::string, std::string>>& units);

  /// The one of these columns that the table has.
  ///
  /// throws  InvalidInput: none or several
  [[nodiscard]] std::string one_of(const std::vector<std::string>& choices, const std::string& what) const;
  [[nodiscard]] double cell(std::size_t row, const std::string& column) const {
    return rows[row][find(column).value()];
  }

 private:
  void group();
  void check_times() const;
};

}  // namespace softkin
