#pragma once

#include <filesystem>
#include <softkin/core/types.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <string>
#include <vector>

namespace softkin {

/// Flux densities, or directions, at places.
struct FieldSamples {
  std::string file;
  Points places;                   // #samples by 3 [mm], or in the scene's unit of length
  Points values;                   // the same [mT]; of directions [-]
  bool in_mm = true;               // are places
  std::vector<std::size_t> lines;  // of each in the file; none: it has no lines
};

/// Reads a CSV file with the columns x_mm, y_mm, z_mm, bx_mT, by_mT and bz_mT, a row a sample; or a .vtu file, of which
/// every cell is a sample at the mean of its vertices, in the cell array "flux_density_mT" of three components.
///
/// throws  InvalidInput naming file and line: another extension, columns that are missing or unknown, no such array
[[nodiscard]] FieldSamples read_field_samples(const std::filesystem::path& path);

/// The same of directions: columns x_mm, y_mm, z_mm, dx, dy and dz, or the cell array "direction".
[[nodiscard]] FieldSamples read_directions(const std::filesystem::path& path);

/// Samples at all points of a regular grid, in any order, as that.
///
/// throws  InvalidInput naming file and line where they are no grid: spacings that differ, a point that is missing or
///         there twice, fewer than 4 points along an axis
[[nodiscard]] GridField grid_of(const FieldSamples& samples);

}  // namespace softkin
