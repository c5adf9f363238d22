#pragma once

#include <optional>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <softkin/runs/reported_path.hpp>

namespace softkin::runs {

/// Reports of the same steps side by side.
struct ReportComparison {
  std::vector<ReportedPath> paths;             // the first is the one to compare with
  std::string marker;                          // whose distance is told
  std::vector<std::vector<double>> distances;  // path, step [mm], from the first path
  std::vector<std::vector<double>> turns;      // path, step [degrees]; empty: not asked for
  std::vector<double> poses;                   // turns whose time is looked for [degrees]

  /// Until the first step that turns at least so far [s]; nothing where none does.
  [[nodiscard]] std::optional<double> time_to(std::size_t path, double pose) const;

  [[nodiscard]] Table steps() const;
  /// How long each took, until the poses and in all.
  [[nodiscard]] Table times() const;
  [[nodiscard]] std::string json() const;
  /// Turns, distances and loads over the steps, and the marker's ways through space.
  [[nodiscard]] Plot plot() const;
};

/// marker  empty for the first
/// turn    empty, or two markers: by how much the line from one to the other has turned since the first step. It may
///         exceed 180 degrees: the axis is that of the first turn, and from step to step the line turns by less
///         than 180
/// throws  InvalidInput where reports have other steps than the first or lack a marker, or where the two markers of a
///         turn fall together in the first step
[[nodiscard]] ReportComparison compare_reports(const std::vector<std::string>& files, const std::string& marker,
                                               const std::vector<std::string>& turn, const std::vector<double>& poses);

}  // namespace softkin::runs
