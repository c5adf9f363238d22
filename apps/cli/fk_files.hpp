#pragma once

#include <filesystem>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

/// The shape with displacement [mm], volume ratio and principal strains [-], region and actuator.
void write_shape(const std::filesystem::path& path, const Model& model, const Points& positions);

/// NAME_0007.vtu beside NAME.pvd.
[[nodiscard]] std::filesystem::path series_file(const std::filesystem::path& pvd, std::size_t step);

/// The body coloured by displacement over a ghost of its rest shape. view: three numbers, from the scene to
/// the eye; empty: from the front, left and above.
void write_image(const std::filesystem::path& path, const Model& model, const Points& positions,
                 const std::vector<double>& view, const std::string& title);

}  // namespace softkin::cli
