#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

#include "output_files.hpp"

namespace softkin::cli {

/// What the user asks of `softkin fk`. An empty file name: not given.
struct FkOptions {
  std::string scene, path;
  std::string output, report, image, plot;
  std::string solver_name = "newton";
  std::string formulation;            // empty: the scene's
  std::vector<std::string> settings;  // ACTUATOR=VALUE
  std::vector<std::string> forces;    // NAME=FX,FY,FZ
  std::vector<double> view;           // from the robot to the eye; empty: the picture's default
  double tolerance_mm = StaticsOptions().step_tolerance_mm;
  int max_iterations = StaticsOptions().max_iterations;
  std::optional<int> anderson;  // local-global
  int threads = StaticsOptions().threads;
  bool json = false, resume = false;

  /// The files to write; a path has so many steps.
  [[nodiscard]] std::vector<Output> outputs(std::size_t steps) const;
  [[nodiscard]] bool series() const;  // every step's shape, .pvd
  [[nodiscard]] Solver solver() const;
  [[nodiscard]] StaticsOptions statics() const;
};

void add_options(CLI::App& command, FkOptions& options);

/// Throws InvalidInput where the options contradict each other or name files of another form.
void check_usage(const FkOptions& options);

}  // namespace softkin::cli
