#pragma once

#include <cstdint>
#include <string>

namespace softkin::random_robots {

/// How a robot's answer in one step compares with the end of a path to the same load state.
enum class PathComparison {
  same,        // both ends agree
  differs,     // they do not, and neither run reports a limit or a snap-through
  reported,    // a run reports a limit or a snap-through
  unfinished,  // a run ends without an equilibrium and without a limit
  none         // nothing to compare: a target shape, a robot without loads, one that is refused or remembers its path
};
inline constexpr int path_comparisons = 5;

/// The comparison of one seed.
struct PathRun {
  std::uint64_t seed = 0;
  PathComparison comparison = PathComparison::none;
  bool step_converged = false, path_converged = false;
  double apart = 0;  // largest distance of a vertex between both ends, over the diagonal [-]
  int step_iterations = 0, path_iterations = 0;
  std::string text;  // of both runs
};

/// Solves the robot of a seed for its first command in one step and along a path of `rows` rows: of its commands, or,
/// where no command changes, of its weights, forces and displacements of supports.
///
/// verbose  prints both runs on the standard output
[[nodiscard]] PathRun compare_path(std::uint64_t seed, int rows, bool verbose);

/// Compares many seeds and prints a summary. Returns how many differ.
[[nodiscard]] int compare_paths(std::uint64_t first, std::uint64_t count, int rows, int threads);

}  // namespace softkin::random_robots
