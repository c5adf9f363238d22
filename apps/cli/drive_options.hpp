#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include <softkin/io/output_files.hpp>
#include "solve_options.hpp"

namespace softkin::cli {

/// What the user asks of `softkin drive`. An empty file name: not given.
struct DriveOptions {
  SolveOptions robot;  // scene alone
  std::string commands, hardware, pressures;
  std::string gcode, schedule, log;  // to write
  std::string port;
  int baud = 115200;
  double boot_wait_s = 3;
  bool dry_run = false, return_home = false, json = false;

  /// As given, or that of the scene's name: finger.yaml has finger.hardware.yaml.
  [[nodiscard]] std::filesystem::path hardware_file() const;
  [[nodiscard]] std::vector<Output> outputs() const;
};

void add_options(CLI::App& command, DriveOptions& options);

/// Throws InvalidInput where the options contradict each other or ask for nothing.
void check_usage(const DriveOptions& options);

}  // namespace softkin::cli
