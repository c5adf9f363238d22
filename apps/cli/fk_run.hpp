#pragma once

#include <softkin/model/model.hpp>
#include <vector>

#include "fk_options.hpp"
#include "fk_steps.hpp"

namespace softkin::cli {

/// Solves the steps in order, each from the last shape, and keeps what is finished on disk. Returns the exit code.
[[nodiscard]] int run_steps(const Model& model, const Statics& statics, const FkOptions& options,
                            const std::vector<Step>& steps);

}  // namespace softkin::cli
