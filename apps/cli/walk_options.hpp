#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "output_files.hpp"
#include "solve_options.hpp"

namespace softkin::cli {

/// What the user asks of `softkin walk`.
struct WalkOptions : SolveOptions {
  std::string gait, folder;
  std::size_t cycles = 3;
  bool json = false, resume = false;

  // In the folder:
  [[nodiscard]] std::filesystem::path steps() const { return file("walk.csv"); }
  [[nodiscard]] std::filesystem::path shapes() const { return file("walk.pvd"); }
  [[nodiscard]] std::filesystem::path plot() const { return file("walk.svg"); }
  [[nodiscard]] std::filesystem::path report() const { return file("report.json"); }
  [[nodiscard]] std::vector<Output> outputs(std::size_t steps) const;

 private:
  [[nodiscard]] std::filesystem::path file(const char* name) const { return std::filesystem::path(folder) / name; }
};

void add_options(CLI::App& command, WalkOptions& options);

/// Throws InvalidInput where the options contradict each other.
void check_usage(const WalkOptions& options);

}  // namespace softkin::cli
