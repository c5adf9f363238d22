#pragma once

#include <softkin/io/table/table.hpp>
#include <softkin/kinematics/grasp.hpp>
#include <softkin/runs/records.hpp>
#include <softkin/runs/turns.hpp>

namespace softkin::runs {

/// Commands along a path of markers: what fk --path and drive take.
[[nodiscard]] Table commands_table(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done);
/// Where the markers were to go, where they came to, and how far off that is.
[[nodiscard]] Table errors_table(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done);
/// Commands, feet and friction of a walk.
[[nodiscard]] Table walk_table(const Model& model, const std::vector<WalkRecord>& steps);

/// "foot1", "foot1 and foot2" or "-".
[[nodiscard]] std::string sliding_text(const Model& model, Sliding sliding);
/// The travel in each finished cycle of a walk of so many [mm].
[[nodiscard]] std::vector<double> strides(const std::vector<WalkRecord>& steps, std::size_t cycles);

// What people see of a run record by record, as they come: the columns of its table, and a record as a row of it.

/// steps: how many there will be; line: whose turn has a column
[[nodiscard]] Table table_of_steps(const Model& model, std::size_t steps, const std::optional<MarkerLine>& line = {});
/// turn: of the line [degrees]; there where the table has it
[[nodiscard]] Row row_of(const Model& model, std::size_t step, const StepRecord& record,
                         std::optional<double> turn = {});

[[nodiscard]] Table table_of_waypoints(const Model& model, std::size_t waypoints,
                                       const std::optional<MarkerLine>& line = {});
[[nodiscard]] Row row_of(const Model& model, std::size_t waypoint, const WaypointRecord& record,
                         std::optional<double> turn = {});

[[nodiscard]] Table table_of_walk(const Model& model);
[[nodiscard]] Row row_of(const Model& model, const WalkRecord& record);

/// The path to each of several shapes, from 0.
[[nodiscard]] Table table_of_traces(const std::vector<std::vector<TracedStep>>& paths);

[[nodiscard]] Table table_of_pulls();
[[nodiscard]] Row row_of(const Pull& pull);

}  // namespace softkin::runs
