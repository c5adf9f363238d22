#pragma once

#include <filesystem>
#include <softkin/model/track.hpp>

namespace softkin {

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
