#pragma once

#include <softkin/kinematics/trajectory.hpp>
#include <softkin/model/model.hpp>
#include <string>

namespace softkin::runs {

// What a report says before its steps, a JSON object on one line: version, scene, robot, formulation, materials,
// actuators, solver, units, mesh, notes. scene: its file, as the user named it

[[nodiscard]] std::string report_head(const Model& model, const std::string& scene, const StaticsOptions& options);
/// With what changes the waypoints' results beside robot and solver, "follow".
[[nodiscard]] std::string follow_head(const Model& model, const std::string& scene, const TrajectoryOptions& options);
/// With what is walked, and the feet.
[[nodiscard]] std::string walk_head(const Model& model, const std::string& scene, const StaticsOptions& options,
                                    const std::string& gait, std::size_t cycles, const Vec3& direction);

}  // namespace softkin::runs
