#pragma once

#include <CLI/App.hpp>
#include <softkin/kinematics/sampling.hpp>

#include "solve_options.hpp"

namespace softkin::cli {

/// What the user asks of `softkin workspace`. An empty file name: not given.
struct WorkspaceOptions : SolveOptions, RunOptions {
  std::string output, cloud, hull, plot;
  std::string marker;  // that cloud, hull and plot show; empty: the first
  Index samples = 0;
  std::string sampling = "grid";
  std::optional<std::uint64_t> seed;

  [[nodiscard]] std::vector<Output> outputs() const;
  [[nodiscard]] Sampling kind() const;
};

void add_options(CLI::App& command, WorkspaceOptions& options);

/// Throws InvalidInput where the options contradict each other or name files of another form.
void check_usage(const WorkspaceOptions& options);

}  // namespace softkin::cli
