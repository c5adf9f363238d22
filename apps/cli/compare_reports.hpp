#pragma once

#include <map>
#include <optional>
#include <softkin/core/types.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin::cli {

/// One step of a report of `softkin fk`.
struct ReportedStep {
  std::vector<std::pair<std::string, double>> actuation;  // what was asked for, by actuator
  std::vector<std::pair<std::string, Vec3>> markers;      // in the order of the scene [mm]
  std::vector<std::pair<std::string, double>> loads;  // "air [kPa]", "tendon [N]"; none in the target-shape formulation
  std::string status;
  std::optional<double> time;  // in the path [s]
  double elapsed = 0;          // from the begin of the first step to the end of this one [s]
};

struct ReportedPath {
  std::string file;
  std::string method;  // "physical, newton"
  std::vector<ReportedStep> steps;
  std::map<std::string, std::string> units;  // of the commands, where the report tells them; a ratio is "-"
};

/// Throws InvalidInput where the file is not a report of `softkin fk` with at least one step.
[[nodiscard]] ReportedPath read_reported_path(const std::string& file);

/// Throws InvalidInput where the second path does not ask for the same steps as the first.
void check_same_steps(const ReportedPath& first, const ReportedPath& second);

/// Place of a marker in each step [mm]. Throws InvalidInput where the report has no such marker.
[[nodiscard]] std::vector<Vec3> places_of(const ReportedPath& path, const std::string& marker);

/// By how much the line from one marker to another has turned since the first step, in each step [degrees]. It may
/// exceed 180: the axis is that of the first turn, and from step to step the line turns by less than 180. Throws
/// InvalidInput where the two markers fall together in the first step or the report has no such markers.
[[nodiscard]] std::vector<double> turns_of(const ReportedPath& path, const std::string& from, const std::string& to);

}  // namespace softkin::cli
