#pragma once

#include <filesystem>
#include <softkin/model/model.hpp>
#include <vector>

#include "solve_options.hpp"

namespace softkin::cli {

/// The robot of the scene, as it is written and compiled, with what --formulation and --force change in it.
///
/// inputs  the files that the scene names are added
/// throws  InvalidInput naming option, or file and line
[[nodiscard]] RobotSpec asked_spec(const SolveOptions& options, std::vector<std::filesystem::path>& inputs);
[[nodiscard]] Model asked_robot(const SolveOptions& options, std::vector<std::filesystem::path>& inputs);

}  // namespace softkin::cli
