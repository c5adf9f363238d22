#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace softkin::cli {

/// Exit codes of every command.
enum ExitCode : int { done = 0, not_converged = 1, bad_input = 2 };

/// The subcommand that the user chose, set while the command line is parsed; returns the exit code.
using Run = std::function<int()>;

void add_calibrate(CLI::App& app, Run& run);
void add_compare(CLI::App& app, Run& run);
void add_drive(CLI::App& app, Run& run);
void add_fk(CLI::App& app, Run& run);
void add_follow(CLI::App& app, Run& run);
void add_ik(CLI::App& app, Run& run);
void add_mesh(CLI::App& app, Run& run);
void add_measure(CLI::App& app, Run& run);
void add_walk(CLI::App& app, Run& run);
void add_workspace(CLI::App& app, Run& run);

}  // namespace softkin::cli
