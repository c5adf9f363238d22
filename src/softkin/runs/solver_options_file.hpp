#pragma once

#include <filesystem>
#include <softkin/statics/solver_options.hpp>

namespace softkin::runs {

/// Reads solver options from a YAML file: a map of groups, each a map of names and numbers; docs/path_tracking.md lists
/// them. Options that are absent keep their defaults.
///
/// throws  InvalidInput naming file and line, and the nearest name where a group or an option is unknown
[[nodiscard]] SolverOptions read_solver_options(const std::filesystem::path& file);

}  // namespace softkin::runs
