#pragma once

#include "command.hpp"

namespace softkin::cli {

// The subcommands of `softkin calibrate`, a file each.
void add_calibrate_dea(CLI::App& calibrate, Run& run);
void add_calibrate_pressure(CLI::App& calibrate, Run& run);

}  // namespace softkin::cli
