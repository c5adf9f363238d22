#pragma once

#include <CLI/App.hpp>
#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

/// What the user asks of `softkin fk`. An empty file name: not given.
struct FkOptions {
  std::string scene, path;
  std::string output, report, image;
  std::string solver = "local-global";
  std::vector<std::string> settings;  // ACTUATOR=RATIO
  std::vector<double> view;           // from the robot to the eye; empty: the picture's default
  StaticsOptions statics;
  bool json = false, resume = false;

  [[nodiscard]] bool series() const;  // every step's shape, .pvd
};

void add_options(CLI::App& command, FkOptions& options);

/// Throws InvalidInput where the options contradict each other or name files of another form.
void check_usage(const FkOptions& options);

}  // namespace softkin::cli
