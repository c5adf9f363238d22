#pragma once

#include <optional>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/runs/reports.hpp>
#include <string>
#include <vector>

#include <softkin/io/file.hpp>
#include "map_use.hpp"
#include "solve_options.hpp"

namespace softkin::cli {

/// What the user asks of `softkin ik`. An empty file name: not given.
struct IkOptions : SolveOptions, MethodOptions, MapUse {
  std::vector<std::string> targets;     // MARKER=X,Y,Z
  std::vector<std::string> planes;      // MARKER=PX,PY,PZ/NX,NY,NZ
  std::vector<std::string> directions;  // FROM:TO=X,Y,Z
  std::vector<std::string> presses;     // NAME=FX,FY,FZ
  std::vector<std::string> weights;     // GOAL=W
  std::vector<std::string> start, prefer, fix;
  std::string workspace;
  std::optional<double> lever_mm;           // none: the distance of a direction's markers at rest
  std::optional<double> tolerance_force_N;  // none: a thousandth of each force
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

/// Throws InvalidInput naming the option: unknown markers or obstacles, numbers that are none or not finite, a weight for nothing.
[[nodiscard]] std::vector<runs::NamedGoal> asked_goals(const Model& model, const IkOptions& options);

}  // namespace softkin::cli
