#pragma once

#include <optional>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/runs/requested_goals.hpp>
#include <string>
#include <vector>

#include <softkin/io/file.hpp>
#include "map_use.hpp"
#include "solve_options.hpp"

namespace softkin::cli {

/// What the user asks of `softkin ik`. An empty file name: not given.
struct IkOptions : SolveOptions, MethodOptions, MapUse {
  runs::GoalTexts goals;
  std::vector<std::string> start, prefer, fix;
  std::string workspace;
  int max_equilibria = InverseOptions().max_equilibria;
  int other_starts = InverseOptions().other_starts;
  std::string output, report;
  ShowOptions show;
  bool json = false, may_replace = false;

  [[nodiscard]] std::vector<Output> outputs() const;
  /// The file that the search begins at; empty: none.
  [[nodiscard]] std::string start_file() const;
  /// But for what needs the robot: preferred and free.
  [[nodiscard]] InverseOptions inverse() const;
};

void add_options(CLI::App& command, IkOptions& options);

/// Throws InvalidInput where the options contradict each other or name files of another form.
void check_usage(const IkOptions& options);

/// See runs::requested_goals.
[[nodiscard]] std::vector<runs::NamedGoal> requested_goals(const Model& model, const IkOptions& options);

}  // namespace softkin::cli
