#pragma once

#include <map>
#include <optional>
#include <softkin/core/types.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin::runs {

// A report of `softkin fk` as it is read without the robot that it is of.

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

/// throws  InvalidInput where the file is not a report of `softkin fk` with at least one step
[[nodiscard]] ReportedPath read_reported_path(const std::string& file);

/// asked, or the first marker where that is empty. Throws InvalidInput where there is none; hint: what that means
[[nodiscard]] std::string marker_of(const ReportedPath& path, const std::string& asked, const std::string& hint = "");

// In each step. throws  InvalidInput where a step has no such marker or actuator

/// Place of a marker [mm].
[[nodiscard]] std::vector<Vec3> places_of(const ReportedPath& path, const std::string& marker);
[[nodiscard]] std::vector<double> commands_of(const ReportedPath& path, const std::string& actuator);

}  // namespace softkin::runs
