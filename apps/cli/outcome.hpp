#pragma once

#include <CLI/App.hpp>
#include <string>

#include "command.hpp"

namespace softkin::cli {

/// Help and version are printed; anything else is bad usage, told in one line. command: whose --help tells more.
[[nodiscard]] int answer_usage(const CLI::App& app, const CLI::ParseError& error, const std::string& command);

/// The exit code of what was chosen; what it throws is told in one line.
[[nodiscard]] int outcome_of(const Run& run);

}  // namespace softkin::cli
