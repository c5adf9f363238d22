#pragma once

#include <string>
#include <utility>
#include <vector>

#include "command.hpp"

namespace softkin::cli {

// Subcommands of calibrate.
void add_calibrate_dea(CLI::App& calibrate, Run& run);
void add_calibrate_material(CLI::App& calibrate, Run& run);
void add_calibrate_pressure(CLI::App& calibrate, Run& run);

[[nodiscard]] CLI::Validator positive_number();

/// "plot: F.svg", a line for each file that is given.
[[nodiscard]] std::string written_text(const std::vector<std::pair<std::string, std::string>>& files);

}  // namespace softkin::cli
