#include "usage.hpp"

#include <CLI/CLI.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <sstream>
#include <utility>

namespace softkin::cli {

namespace {

constexpr std::size_t page = 100;  // characters of a line

/// As its own line stays what begins with a blank and what announces examples.
bool is_apart(const std::string& line) {
  return line.empty() || line.front() == ' ' || line == "Example:" || line == "Examples:";
}

std::string wrapped(const std::string& text, std::size_t width) {
  std::istringstream lines(text);
  std::string all, current;
  const auto flush = [&] {
    if (!current.empty()) all += current + "\n";
    current.clear();
  };
  for (std::string line; std::getline(lines, line);) {
    if (is_apart(line)) {
      flush();
      all += line + "\n";
      continue;
    }
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      if (!current.empty() && characters(current) + 1 + characters(word) > width) flush();
      current += (current.empty() ? "" : " ") + word;
    }
  }
  flush();
  if (!all.empty()) all.pop_back();
  return all;
}

std::string near_text(const std::string& prefix, const std::string& near) {
  return near.empty() ? "" : "; did you mean " + prefix + near + "?";
}

bool takes_positionals(const CLI::App& app) {
  return !app.get_options([](const CLI::Option* option) { return option->get_positional(); }).empty();
}

/// Whether the word after this option is its value, even if it is the name of a command.
bool takes_value(const CLI::App& app, const std::string& argument) {
  const CLI::Option* option = argument.starts_with('-') ? app.get_option_no_throw(argument) : nullptr;
  return option != nullptr && option->get_items_expected_min() > 0;
}

std::vector<std::string> long_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
  return names;
}

}  // namespace

std::string misspelt(const CLI::App& app, int argc, const char* const* argv, std::string& command) {
  const CLI::App* at = &app;
  bool is_value = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (std::exchange(is_value, takes_value(*at, argument)) && !argument.starts_with("--")) continue;
    if (at->get_prefix_command() || argument == "--") return "";
    if (argument.starts_with("--")) {
      const std::string name = argument.substr(0, argument.find('='));
      if (at->get_option_no_throw(name) != nullptr) continue;
      return "there is no option " + printable(name) + near_text("--", nearest_name(name.substr(2), long_names(*at)));
    }
    const auto subs = at->get_subcommands([](const CLI::App*) { return true; });
    if (argument.starts_with('-') || subs.empty()) continue;
    std::vector<std::string> names;
    for (const CLI::App* sub : subs) names.push_back(sub->get_name());
    const auto found = std::find(names.begin(), names.end(), argument);
    if (found == names.end() && takes_positionals(*at)) continue;
    if (found == names.end()) return "there is no command " + excerpt(argument) + suggest_name(argument, names);
    at = subs[found - names.begin()];
    command += " " + argument;
  }
  return "";
}

std::string PageFormatter::make_description(const CLI::App* app) const {
  return wrapped(Formatter::make_description(app), page) + "\n";
}

std::string PageFormatter::make_footer(const CLI::App* app) const {
  const std::string footer = Formatter::make_footer(app);
  return footer.empty() ? "" : wrapped(footer, page) + "\n";
}

std::string PageFormatter::make_subcommand(const CLI::App* sub) const {
  std::ostringstream out;
  CLI::detail::format_help(out, sub->get_display_name(true), wrapped(sub->get_description(), page - get_column_width()),
                           get_column_width());
  return out.str();
}

std::string PageFormatter::make_option_desc(const CLI::Option* option) const {
  return wrapped(option->get_description(), page - get_column_width());
}

}  // namespace softkin::cli
