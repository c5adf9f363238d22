#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "output_files.hpp"
#include "solve_options.hpp"

namespace softkin::cli {

/// What the user asks of `softkin fk`. An empty file name: not given.
struct FkOptions : SolveOptions {
  std::string path;
  std::string output, report, image, plot;
  std::vector<std::string> settings;  // ACTUATOR=VALUE
  std::vector<double> view;           // from the robot to the eye; empty: the picture's default
  bool json = false, resume = false;

  /// The files to write; a path has so many steps.
  [[nodiscard]] std::vector<Output> outputs(std::size_t steps) const;
  [[nodiscard]] bool series() const;  // every step's shape, .pvd
};

void add_options(CLI::App& command, FkOptions& options);

/// Throws InvalidInput where the options contradict each other or name files of another form.
void check_usage(const FkOptions& options);

}  // namespace softkin::cli
