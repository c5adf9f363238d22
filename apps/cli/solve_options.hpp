#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <cstdint>
#include <optional>
#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

/// Which robot, and how its equilibria are solved: what every command that solves is asked.
struct SolveOptions {
  std::string scene;
  std::string formulation;          // empty: the scene's
  std::vector<std::string> forces;  // NAME=FX,FY,FZ
  std::string solver_name = "newton";
  double tolerance_mm = StaticsOptions().step_tolerance_mm;
  int max_iterations = StaticsOptions().max_iterations;
  std::optional<int> anderson;  // local-global
  int threads = StaticsOptions().threads;

  [[nodiscard]] Solver solver() const;
  [[nodiscard]] StaticsOptions statics() const;
};

void add_scene(CLI::App& command, SolveOptions& options);
void add_force(CLI::App& command, SolveOptions& options);
/// tolerance: the name of the option for the solver's tolerance.
void add_solver(CLI::App& command, SolveOptions& options, const std::string& tolerance);

/// Throws InvalidInput where the options contradict each other.
void check_solver(const SolveOptions& options);

// What CLI11 says of a number in words of its own.
[[nodiscard]] CLI::Validator integer_from(std::int64_t low, std::int64_t high);
[[nodiscard]] CLI::Validator finite_number(bool negative_too);
[[nodiscard]] CLI::Validator positive_length();
[[nodiscard]] CLI::Validator one_of(const std::vector<std::string>& names);

}  // namespace softkin::cli
