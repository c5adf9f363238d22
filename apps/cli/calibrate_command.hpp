#pragma once

#include "command.hpp"

namespace softkin::cli {

// Subcommands of calibrate.
void add_calibrate_dea(CLI::App& calibrate, Run& run);
void add_calibrate_material(CLI::App& calibrate, Run& run);
void add_calibrate_pressure(CLI::App& calibrate, Run& run);

}  // namespace softkin::cli
