#pragma once

#include <optional>
#include <softkin/io/plot/svg_plot.hpp>

#include "compare_reports.hpp"
#include "mesh_text.hpp"

namespace softkin::cli {

/// Reports of the same steps side by side.
class Comparison {
 public:
  /// marker: empty for the first. turn: empty, or two markers. poses: turns whose time is looked for [degrees].
  /// Throws InvalidInput where a report lacks a marker.
  Comparison(std::vector<ReportedPath> paths, std::string marker, const std::vector<std::string>& turn,
             std::vector<double> poses);

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Json json() const;
  /// Turns, distances and loads over the steps, and the marker's ways through space.
  [[nodiscard]] Plot plot() const;

 private:
  /// Until the first step that turns at least so far [s]; nothing where none does.
  [[nodiscard]] std::optional<double> time_to(std::size_t path, double pose) const;
  [[nodiscard]] std::vector<std::string> header() const;
  [[nodiscard]] std::vector<std::string> row(std::size_t step) const;
  [[nodiscard]] std::vector<std::vector<std::string>> times() const;

  std::vector<ReportedPath> paths_;
  std::string marker_;
  std::vector<double> poses_;
  std::vector<std::vector<double>> turns_;      // path, step [degrees]; empty without --turn
  std::vector<std::vector<double>> distances_;  // path, step [mm], from the first path
};

}  // namespace softkin::cli
