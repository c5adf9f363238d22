#pragma once

#include <map>
#include <optional>
#include <softkin/core/types.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin::runs {

// A report of `softkin fk` as it is read without the robot that it is of.

struct ReportedStep {
  std::vector<std::pair<std::string, double>> actuation;  // requested, by actuator
  std::vector<std::pair<std::string, Vec3>> markers;      // in the order of the scene [mm]
  std::vector<std::pair<std::string, double>> loads;  // "air [kPa]", "tendon [N]"; none in the target-shape formulation
  std::vector<std::pair<std::string, double>> ratios;  // "air volume [-]", of actuators that are commanded by a load
  std::string status;
  std::optional<double> time;  // in the path [s]
  double elapsed = 0;          // from the begin of the first step to the end of this one [s]
};

struct ReportedPath {
  std::string file;
  std::string method;  // "physical, newton"
  std::vector<ReportedStep> steps;
  std::map<std::string, std::string> units;  // of the commands, where the report contains them; a ratio is "-"
};

/// throws  InvalidInput where the file is not a report of `softkin fk` with at least one step
[[nodiscard]] ReportedPath read_reported_path(const std::string& file);

/// Returns the requested marker, or the first where that is empty. Throws InvalidInput where there is none; hint: what
/// that means
[[nodiscard]] std::string marker_of(const ReportedPath& path, const std::string& requested,
                                    const std::string& hint = "");

// In each step. throws  InvalidInput where a step has no such marker or actuator

/// Place of a marker [mm].
[[nodiscard]] std::vector<Vec3> places_of(const ReportedPath& path, const std::string& marker);
[[nodiscard]] std::vector<double> commands_of(const ReportedPath& path, const std::string& actuator);

/// Reports of the same steps side by side.
struct ReportComparison {
  std::vector<ReportedPath> paths;             // the first is the one to compare with
  std::vector<std::string> labels;             // of tables and legends: the names of their files
  std::string marker;                          // whose distance is reported
  std::vector<std::vector<double>> distances;  // path, step [mm], from the first path
  std::vector<std::vector<double>> turns;      // path, step [degrees]; empty: not requested
  std::vector<double> poses;                   // turns whose time is looked for [degrees]

  /// Until the first step that turns at least so far [s]; nothing where none does.
  [[nodiscard]] std::optional<double> time_to(std::size_t path, double pose) const;

  [[nodiscard]] Table steps() const;
  /// How long each took, until the poses and in all.
  [[nodiscard]] Table times() const;
  [[nodiscard]] std::string json() const;
  /// Turns, distances and loads over the steps, and the marker's trajectories in space.
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
