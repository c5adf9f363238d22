#pragma once

#include <filesystem>
#include <string>
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

}  // namespace softkin
