#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <softkin/kinematics/trajectory.hpp>
#include <string>
#include <vector>

#include "method_options.hpp"
#include "output_files.hpp"
#include "solve_options.hpp"

namespace softkin::cli {

/// What the user asks of `softkin follow`. An empty file name: not given.
struct FollowOptions : SolveOptions, MethodOptions {
  std::string path, folder, marker, workspace, plot_file;
  double max_step_mm = 0;  // 0: as given
  bool json = false, resume = false;

  // In the folder:
  [[nodiscard]] std::filesystem::path commands() const { return file("commands.csv"); }
  [[nodiscard]] std::filesystem::path errors() const { return file("errors.csv"); }
  [[nodiscard]] std::filesystem::path shapes() const { return file("path.pvd"); }
  [[nodiscard]] std::filesystem::path report() const { return file("report.json"); }
  [[nodiscard]] std::filesystem::path plot() const {
    return plot_file.empty() ? file("path.svg") : std::filesystem::path(plot_file);
  }
  [[nodiscard]] std::vector<Output> outputs(std::size_t waypoints) const;
  [[nodiscard]] TrajectoryOptions trajectory() const;
  /// At which a waypoint is reached.
  [[nodiscard]] double reach_mm() const { return trajectory().inverse.tolerance_mm; }

 private:
  [[nodiscard]] std::filesystem::path file(const char* name) const { return std::filesystem::path(folder) / name; }
};

void add_options(CLI::App& command, FollowOptions& options);

/// Throws InvalidInput where the options contradict each other or name files of another form.
void check_usage(const FollowOptions& options);

}  // namespace softkin::cli
