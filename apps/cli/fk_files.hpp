#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>

namespace softkin::cli {

/// The shape with displacement [mm], volume ratio and principal strains [-], region and actuator.
void write_shape(const std::filesystem::path& path, const Model& model, const Points& positions);

/// NAME_0007.vtu beside NAME.pvd.
[[nodiscard]] std::filesystem::path series_file(const std::filesystem::path& pvd, std::size_t step);

/// The body coloured by displacement over a ghost of its rest shape. view: from the scene to the eye.
void write_image(const std::filesystem::path& path, const Model& model, const Points& positions,
                 const std::optional<std::array<double, 3>>& view, const std::string& title);

}  // namespace softkin::cli
