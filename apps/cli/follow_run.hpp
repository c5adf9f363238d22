#pragma once

#include <string>
#include <vector>

#include "follow_options.hpp"

namespace softkin::cli {

/// Follows the path and keeps what is finished on disk. Returns the exit code.
[[nodiscard]] int run_path(const Model& model, const Statics& statics, const FollowOptions& options,
                           const MarkerPath& path, const TrajectoryOptions& trajectory);

}  // namespace softkin::cli
