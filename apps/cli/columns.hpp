#pragma once

#include <cstddef>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

/// A table that is printed row by row: its columns are as wide as the first row needs, and aligned to the right.
class Columns {
 public:
  /// width: at least so many characters.
  void add(const std::string& header, std::size_t width);
  /// "skin [-]", wide enough for the actuator's range.
  void add_command(const Actuator& actuator);

  [[nodiscard]] std::string header() const { return row(headers_); }
  [[nodiscard]] std::string row(const std::vector<std::string>& cells) const;
  /// As add_command's column has it.
  [[nodiscard]] static std::string command(double value);

 private:
  std::vector<std::string> headers_;
  std::vector<std::size_t> widths_;
};

}  // namespace softkin::cli
