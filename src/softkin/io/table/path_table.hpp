#pragma once

#include <filesystem>
#include <softkin/core/types.hpp>

namespace softkin {

/// Reads the corners of a path from a CSV file with the columns x_mm, y_mm and z_mm, a row a corner.
///
/// returns  #corners by 3 [mm]
/// throws   InvalidInput naming file and line: columns that are missing or unknown, or as read_csv()
[[nodiscard]] Points read_path(const std::filesystem::path& path);

}  // namespace softkin
