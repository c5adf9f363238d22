#pragma once

#include <filesystem>
#include <softkin/model/measurements.hpp>
#include <softkin/model/paths.hpp>
#include <string>

namespace softkin {

/// Reads a path: a .csv with columns x_mm, y_mm, z_mm of one marker, or tip_x_mm, tip_y_mm, ... of several, and t_s, an
/// ascending time in s, where there are times. A coordinate without a column does not count.
///
/// marker  whose x_mm, y_mm and z_mm are; empty: the model's only one
/// throws  InvalidInput naming file, line and column: another unit than mm or s, unknown markers, a column that is
///         neither, no coordinate, numbers that are not finite, no row, times that do not ascend
[[nodiscard]] MarkerPath read_marker_path(const std::filesystem::path& path, const Model& model,
                                          const std::string& marker = "");

/// What looks wrong about a path beside this robot, a sentence each: coordinates 100 times its size, or such as would
/// fit in metres.
[[nodiscard]] std::vector<std::string> doubts_about(const Model& model, const MarkerPath& path);

/// Reads the track of a marker, CSV: x_mm, y_mm, z_mm (at least two of them), or tip_x_mm, ... of a marker `tip`; t_s.
/// Columns without the form of a coordinate or a time are not read.
///
/// marker     whose; empty: of x_mm, y_mm, z_mm, else of the only marker that the columns name
/// parameter  column that ascends along the track; empty: t_s where there is one
/// throws     InvalidInput naming file, line and column: coordinates in another unit than mm or without one, times not
///            in s, unknown or ambiguous markers, fewer than two coordinates, a parameter that does not ascend
[[nodiscard]] Track read_track(const std::filesystem::path& path, const std::string& marker = "",
                               const std::string& parameter = "");

}  // namespace softkin
