#pragma once

#include <string>
#include <vector>

namespace softkin::cli {

/// A table of numbers for a file: a header, and comments above it.
struct NumberTable {
  std::vector<std::string> comments, columns;
  std::vector<std::vector<double>> rows;
  int decimals = 4;  // of what is not whole

  [[nodiscard]] std::string csv() const;
};

}  // namespace softkin::cli
