#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace softkin {

/// A table of finite numbers under a header; lines that begin with # and blank lines are skipped.
struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
  std::size_t header_line = 0;
  std::vector<std::size_t> lines;  // line of each row in the file, for messages
};

/// throws  InvalidInput naming file and line: no header, no row, a duplicate or empty column name, a row of another
///         length, a cell that is not a finite number
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& path);

/// A table of measurements: columns named with their unit, in any case; optional column run (whole numbers) and t_s
/// [s], which ascends within a run.
class RunTable {
 public:
  /// known   columns beside run and t_s, in lower case
  /// units   what begins the name of a column and what its unit must be: "p_", "pressures are in kPa"
  /// throws  InvalidInput naming file and line, as read_csv, and on unknown columns
  RunTable(const std::filesystem::path& path, const std::vector<std::string>& known,
           const std::vector<std::pair<std::string, std::string>>& units);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] bool has(const std::string& column) const;
  /// The one of these columns that the table has.
  ///
  /// throws  InvalidInput: none or several
  [[nodiscard]] std::string one_of(const std::vector<std::string>& columns, const std::string& what) const;

  struct Run {
    std::string name;               // "run 2"
    std::vector<std::size_t> rows;  // in their order
  };
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }
  [[nodiscard]] double cell(std::size_t row, const std::string& column) const;
  [[nodiscard]] std::size_t line(std::size_t row) const { return table_.lines[row]; }
  [[noreturn]] void fail(std::size_t row, const std::string& message) const;
  [[noreturn]] void fail_header(const std::string& message) const;

 private:
  [[nodiscard]] std::optional<std::size_t> place(const std::string& column) const;
  void group();
  void check_times() const;

  std::string file_;
  CsvTable table_;
  std::vector<std::string> columns_;  // lower case
  std::vector<Run> runs_;
};

}  // namespace softkin
