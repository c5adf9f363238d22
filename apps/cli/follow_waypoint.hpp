#pragma once

#include <softkin/kinematics/trajectory.hpp>
#include <string>
#include <vector>

#include "fk_report.hpp"

namespace softkin::cli {

/// What the files and the plot tell of a waypoint that is done.
struct DoneWaypoint {
  bool reached = false;
  std::string status;  // "reached", "not reached" or "not converged"
  double error_mm = 0;
  int equilibria = 0;
  double seconds = 0;
  Actuation actuation;
  std::vector<Vec3> markers;  // of the path [mm]
};

/// A step of the report: that of its equilibrium, and what was asked of it below "waypoint".
[[nodiscard]] Report::Json waypoint_json(const Model& model, const MarkerPath& path, std::size_t waypoint,
                                         const InverseResult& found, const ElementDeformation& deformation);

/// Throws Report::Json::exception where the step is not one of waypoint_json.
[[nodiscard]] DoneWaypoint done_waypoint(const Model& model, const MarkerPath& path, const Report::Json& step);

/// What the path asks of the waypoint, to be compared with the same of another run.
[[nodiscard]] Report::Json asked_json(const Model& model, const MarkerPath& path, std::size_t waypoint);

}  // namespace softkin::cli
