#pragma once

#include <softkin/io/table/workspace_table.hpp>
#include <softkin/kinematics/sampling.hpp>
#include <softkin/model/model.hpp>

namespace softkin::cli {

/// The columns of a workspace of the robot: tendon1 or air_kPa; tip_x_mm, tip_y_mm, tip_z_mm; tendon1_tension_N or
/// air_pressure_kPa (physical formulation).
[[nodiscard]] WorkspaceColumns workspace_columns(const Model& model);

/// What the samples are a function of, each a line of the file: softkin's version, the robot's fingerprint, the solver,
/// the sampling with its ranges, the number of samples.
[[nodiscard]] WorkspaceHead workspace_head(const Model& model, const SamplingOptions& sampling,
                                           const std::string& solver);

/// "grid of 15 x 15 x 15", "sobol" or "random, seed 7".
[[nodiscard]] std::string sampling_text(const Model& model, const SamplingOptions& sampling);

}  // namespace softkin::cli
