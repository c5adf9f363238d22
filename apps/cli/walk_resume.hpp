#pragma once

#include "walk_options.hpp"
#include "walk_steps.hpp"

namespace softkin::cli {

/// What a walk that was stopped has left.
struct WalkedBefore {
  std::vector<WalkedStep> done;
  State state;         // of the last of them
  std::string remark;  // for the user
};

/// The feet, as the report tells of them: a walk goes on with the same ones.
[[nodiscard]] Report::Json feet_json(const Model& model);

/// Adds to report, which has no steps yet, those of the report on disk whose shapes are there as they were written.
///
/// throws  InvalidInput where the report on disk is of another robot, solver or gait
[[nodiscard]] WalkedBefore take_walk(const Model& model, const WalkOptions& options, const std::vector<GaitStep>& steps,
                                     Report& report);

}  // namespace softkin::cli
