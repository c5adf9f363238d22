#pragma once

#include <filesystem>
#include <softkin/model/marker_path.hpp>
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

}  // namespace softkin
