#pragma once

#include <vector>

#include "walk_options.hpp"
#include "walk_steps.hpp"

namespace softkin::cli {

/// Walks the steps and keeps what is finished on disk. Returns the exit code.
[[nodiscard]] int walk_steps(const Model& model, Walker& walker, const WalkOptions& options,
                             const std::vector<GaitStep>& steps);

}  // namespace softkin::cli
