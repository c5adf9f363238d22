#pragma once

#include <filesystem>
#include <softkin/model/measured_poses.hpp>
#include <softkin/model/model.hpp>

namespace softkin {

/// The column of tables of pictures that numbers them, from 1 on.
inline constexpr const char* picture_column = "picture";
constexpr int max_pictures = 1000000;

/// Reads a table of measured poses: a row each, columns of commands as paths have them (read_actuation_path), of
/// coordinates of markers as those of targets (tip_x_mm; x_mm of the only marker), and of what actuators answer with,
/// air_pressure_kPa, tendon_tension_N. A reading that is missing is an empty cell. Without a command the robot rests.
///
/// seen    may it have places of dots that are not named, dot1_x_mm, dot2_x_mm, ..., where no marker is called so, and
///         the number of a picture, of which there may be an outline?
/// throws  InvalidInput naming file, line and column: what these refuse; a command that is missing; no reading; dots
///         of which some coordinates are missing, or of a scene without markers; what is no number of a picture
[[nodiscard]] MeasuredPoses read_measured_poses(const std::filesystem::path& file, const Model& model,
                                                bool seen = false);

/// What readings of these names are.
///
/// throws  InvalidInput on a name that is no reading, with what could be one
[[nodiscard]] std::vector<PoseColumn> reading_columns(const Model& model, const std::vector<std::string>& names);

/// All that can be read of a robot: coordinates of markers, what actuators and sensors answer with, and what supports
/// exert, in the order of the model; reading_columns() knows their names.
[[nodiscard]] std::vector<PoseColumn> possible_readings(const Model& model);

}  // namespace softkin
