#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <softkin/kinematics/inverse.hpp>
#include <string>

namespace softkin::cli {

/// By which method inverse kinematics is solved, and how far off it may end.
struct MethodOptions {
  std::string method = "newton";
  std::optional<double> tolerance_asked_mm;  // none: the method's
  std::optional<int> descents;               // i_max of Algorithm 2

  /// All else as it is by default.
  [[nodiscard]] InverseOptions by_method() const;
};

/// tolerance: what it is the tolerance of, for the help.
void add_method(CLI::App& command, MethodOptions& options, const std::string& tolerance);
/// Throws InvalidInput where the options contradict each other.
void check_method(const MethodOptions& options);

}  // namespace softkin::cli
