#pragma once

#include <softkin/io/table/table.hpp>
#include <softkin/runs/records.hpp>

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

}  // namespace softkin::runs
