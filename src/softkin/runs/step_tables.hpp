#pragma once

#include <softkin/io/table/table.hpp>
#include <softkin/runs/records.hpp>

namespace softkin::runs {

// What people see of a run record by record, as they come: the columns of its table, and a record as a row of it.

/// steps: how many there will be
[[nodiscard]] Table table_of_steps(const Model& model, std::size_t steps);
[[nodiscard]] Row row_of(const Model& model, std::size_t step, const StepRecord& record);

[[nodiscard]] Table table_of_waypoints(const Model& model, std::size_t waypoints);
[[nodiscard]] Row row_of(std::size_t waypoint, const WaypointRecord& record);

[[nodiscard]] Table table_of_walk(const Model& model);
[[nodiscard]] Row row_of(const Model& model, const WalkRecord& record);

}  // namespace softkin::runs
