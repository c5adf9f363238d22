#pragma once

#include <softkin/io/json_text.hpp>
#include <softkin/runs/records.hpp>

namespace softkin::runs {

// A record as a step of a report, and back. What the model knows (names, units, which axes count) is not in the record.
// from_json reads what to_json of the same model wrote. throws  Json::exception on anything else

[[nodiscard]] Json to_json(const Model& model, const StepRecord& record);
/// path: whose waypoint it is.
[[nodiscard]] Json to_json(const Model& model, const MarkerPath& path, const WaypointRecord& record);
[[nodiscard]] Json to_json(const Model& model, const WalkRecord& record);

void from_json(const Model& model, const Json& json, StepRecord& record);
void from_json(const Model& model, const MarkerPath& path, const Json& json, WaypointRecord& record);
void from_json(const Model& model, const Json& json, WalkRecord& record);

/// JSON on one line; text that is no UTF-8 is replaced.
[[nodiscard]] std::string line_of(const Json& json);
/// JSON has no NaN: numbers that a diverged solve leaves undefined are null.
[[nodiscard]] Json known(double value);
[[nodiscard]] double number_or_nan(const Json& json);
/// A measure, which may not be known, or a count.
void write_number(double value, Json& json);
void write_number(int value, Json& json);
void write_number(std::size_t value, Json& json);
void read_number(const Json& json, double& value);
void read_number(const Json& json, int& value);
void read_number(const Json& json, std::size_t& value);
/// Of a list of three numbers.
[[nodiscard]] Vec3 point_of(const Json& json);
/// throws  std::out_of_range where it is none
[[nodiscard]] Status status_of(const std::string& name);

}  // namespace softkin::runs
