#pragma once

#include <filesystem>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/kinematics/goal.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/deformation.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// The shape with displacement [mm], volume ratio and principal strains [-], region, actuator, and whether the solve
/// converged (1) or not (0); and what read_state() wants. deformation: of the state.
[[nodiscard]] VtuContent shape_content(const Model& model, const State& state, const ElementDeformation& deformation,
                                       bool converged);
/// Writes shape_content() as a .vtu.
void write_shape(const std::filesystem::path& path, const Model& model, const State& state,
                 const ElementDeformation& deformation, bool converged);

/// The state that write_shape() wrote, from which a solve continues.
///
/// throws  InvalidInput naming the file: it is none of softkin's, of another mesh, or of other actuators
[[nodiscard]] State read_state(const std::filesystem::path& path, const Model& model);

/// The body coloured by displacement before a ghost of its rest shape, with obstacles near by (obstacle_picture.hpp),
/// cables, markers, and crosses where goals want markers to be. view: three numbers, not all zero, from the robot to
/// the eye, y upwards where it looks along z; empty: from the front, left and above.
void write_image(const std::filesystem::path& path, const Model& model, const Points& positions,
                 const std::vector<double>& view, const std::string& title, const std::vector<Goal>& goals = {});

/// The content of such a file.
[[nodiscard]] std::string image_png(const Model& model, const Points& positions, const std::vector<double>& view,
                                    const std::string& title, const std::vector<Goal>& goals = {});

}  // namespace softkin::runs
