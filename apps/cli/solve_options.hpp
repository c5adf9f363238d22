#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/scene/scene.hpp>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>
#include <string>
#include <utility>
#include <vector>

#include "command.hpp"

namespace softkin::cli {

/// The robot and the solver settings: options of every command that solves for equilibria.
struct SolveOptions : RequestedScene {
  std::string solver_name = "newton";
  double tolerance_mm = StaticsOptions().step_tolerance_mm;
  int max_iterations = StaticsOptions().max_iterations;
  std::optional<int> anderson;  // local-global
  int threads = StaticsOptions().threads;
  bool stable = false;
  bool instant = false;
  std::string tuning_file{};  // of --options; empty: none
  SolverOptions tuning{};
  Deadline deadline{};

  [[nodiscard]] Solver solver() const;
  [[nodiscard]] StaticsOptions statics() const;
};

/// Options that resume an interrupted run and that print its report.
struct RunOptions {
  bool json = false, resume = false, may_replace = false;
  std::string page{};
};

/// Pictures of what was found. An empty file name: not given.
struct ShowOptions {
  std::string image, plot;
  std::vector<double> view{};  // from the robot to the eye; empty: the picture's default
};

void add_scene(CLI::App& command, SolveOptions& options);
void add_force(CLI::App& command, SolveOptions& options);
void add_solver(CLI::App& command, SolveOptions& options,
                const std::string& threads = "0: as many as the machine has (default)");

void add_page(CLI::App& command, std::string& page, const std::string& what);
/// --turn FROM TO; turn: none, or two markers
void add_turn(CLI::App& command, std::vector<std::string>& turn);
void add_run(CLI::App& command, RunOptions& options, const std::string& resume, const std::string& json);
void add_view(CLI::App& command, ShowOptions& options);

/// A file ends in one of these, each with what it then holds ("" where that is clear), or is not given. Throws
/// InvalidInput naming the option.
void check_extension(const std::string& option, const std::string& file,
                     const std::vector<std::pair<std::string, std::string>>& endings);
/// Those of them that are given.
[[nodiscard]] std::vector<Output> requested_outputs(const std::vector<std::pair<std::string, std::string>>& files);
/// The file that --resume reads first: it refuses the file itself, with the reason, where that is none of the run's.
void leave_to_resume(std::vector<Output>& outputs, const std::filesystem::path& file);
/// Throws InvalidInput where there is a view without a picture, or it is no direction.
void check_view(const ShowOptions& options);

/// Throws InvalidInput where the options contradict each other.
void check_solver(const SolveOptions& options);

/// The robot of the scene with the requested changes: as a description, and compiled.
///
/// inputs  the files that the scene names are added
/// throws  InvalidInput naming option, or file and line
[[nodiscard]] RobotSpec requested_spec(const SolveOptions& options, std::vector<std::filesystem::path>& inputs);
[[nodiscard]] Model requested_robot(const SolveOptions& options, std::vector<std::filesystem::path>& inputs);

/// Of those that work side by side, each on a piece of its own; 0: as many as the machine has.
[[nodiscard]] int thread_count(int requested);

// CLI11's own texts for numbers.
[[nodiscard]] CLI::Validator integer_from(std::int64_t low, std::int64_t high);
[[nodiscard]] CLI::Validator finite_number(bool negative_too);
/// what: it must be
[[nodiscard]] CLI::Validator positive(const std::string& what);
[[nodiscard]] CLI::Validator positive_length();
[[nodiscard]] CLI::Validator positive_force();
[[nodiscard]] CLI::Validator positive_ratio();
[[nodiscard]] CLI::Validator positive_time();
[[nodiscard]] CLI::Validator one_of(const std::vector<std::string>& names);

/// By which method inverse kinematics is solved, and how far off it may end.
struct MethodOptions {
  std::string method = "newton";
  std::optional<double> tolerance_requested_mm;  // none: the method's
  std::optional<int> descents;                   // i_max of Algorithm 2

  /// All else as it is by default.
  [[nodiscard]] InverseOptions by_method() const;
};

/// tolerance: what it is the tolerance of, for the help.
/// more: methods besides those of inverse kinematics, with their descriptions.
void add_method(CLI::App& command, MethodOptions& options, const std::string& tolerance,
                const std::vector<std::pair<std::string, std::string>>& more = {});
/// Throws InvalidInput where the options contradict each other.
void check_method(const MethodOptions& options);

}  // namespace softkin::cli
