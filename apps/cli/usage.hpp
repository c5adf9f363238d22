#pragma once

#include <string>

#include "command.hpp"

namespace softkin::cli {

/// Returns what is wrong with the names of the options and commands on a command line: "there is no option --reprot;
/// did you mean --report?"; "" where all exist. It is reported before missing arguments.
/// command: receives the command that is meant, as far as it is recognised
[[nodiscard]] std::string misspelt(const CLI::App& app, int argc, const char* const* argv, std::string& command);

/// Help whose lines fit a page, whatever the texts' own line ends; lines that begin with a blank stay as they are.
class PageFormatter : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
  std::string make_subcommand(const CLI::App* sub) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace softkin::cli
