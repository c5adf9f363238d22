#pragma once

#include <softkin/drive/marlin_link.hpp>
#include <softkin/drive/plan.hpp>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/map.hpp>
#include <softkin/kinematics/trajectory.hpp>
#include <softkin/model/model.hpp>
#include <softkin/runs/record_log.hpp>
#include <softkin/runs/records.hpp>
#include <softkin/runs/shortfall_text.hpp>
#include <string>

namespace softkin::runs {

/// A map that answers in place of the solver, or at whose answers the solver begins.
struct UsedMap {
  std::string file;       // as the user named it
  const MapData& data;    // must outlive its use
  bool polished = false;  // does the solver begin at its answers
};

/// A shape of a file, at which a run begins.
struct UsedStart {
  std::string file;         // as the user named it
  std::string fingerprint;  // of its positions
};

// The entries of a report before its steps, a JSON object on one line: version, scene, robot, formulation, materials,
// actuators, solver, units, mesh, notes. scene: its file, as the user named it; map: null: none

/// Of steps; map: null: none; start: null: the robot at rest
[[nodiscard]] std::string report_head(const Model& model, const std::string& scene, const StaticsOptions& options,
                                      const UsedMap* map = nullptr, const UsedStart* start = nullptr);
/// With the options that change the waypoints' results besides robot and solver, "follow".
[[nodiscard]] std::string follow_head(const Model& model, const std::string& scene, const TrajectoryOptions& options,
                                      const UsedMap* map = nullptr);
/// With what is walked, and the feet.
[[nodiscard]] std::string walk_head(const Model& model, const std::string& scene, const StaticsOptions& options,
                                    const std::string& gait, std::size_t cycles, const Vec3& direction);

/// The report of one equilibrium, as of a path of one step; to be written to file at its finish().
[[nodiscard]] RecordLog step_report(const Model& model, const std::string& scene, const std::filesystem::path& file,
                                    const StaticsOptions& options, const StepRecord& record);

/// A goal and what the user calls it: "tip", "base:tip".
struct NamedGoal {
  std::string name;  // as the user has it
  Goal goal;         // what is to be reached
};

/// The equilibrium that inverse kinematics came to.
struct InverseRecord : StepRecord {
  Misses misses;  // of its goals
};

/// What is kept of a search: the record of its equilibrium, and how far that is from its goals.
[[nodiscard]] InverseRecord inverse_record(const Model& model, const std::vector<Goal>& goals,
                                           const InverseResult& found, const ElementDeformation& deformation);

/// Where the marker of a goal is, the unit vector between its markers, or the force that is exerted [mm, -, N].
[[nodiscard]] Vec3 found_of(const Model& model, const Goal& goal, const Points& positions, const StepRecord& record);

/// A search: its request, and its result.
struct InverseAnswer {
  const InverseOptions& options;        // of the search
  const std::vector<NamedGoal>& goals;  // that were requested
  const InverseResult& found;           // of the search
  const InverseRecord& record;          // of its equilibrium
};

/// The report of it, to be written to file at its finish().
[[nodiscard]] RecordLog inverse_report(const Model& model, const std::string& scene, const std::filesystem::path& file,
                                       const InverseAnswer& answer, const UsedMap* map = nullptr);

/// The report of softkin drive, JSON.
///
/// scene   its file, as the user named it
/// whole   with the program and the schedule
/// stream  how the program was sent; null: it was not
/// map     that gave pressures; null: none
[[nodiscard]] std::string drive_report(const std::string& scene, const drive::Plan& plan, bool whole,
                                       const drive::StreamReport* stream, const UsedMap* map = nullptr);

}  // namespace softkin::runs
