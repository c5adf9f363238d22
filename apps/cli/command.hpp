#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace softkin::cli {

/// Exit codes of every command.
enum ExitCode : int { done = 0, not_converged = 1, bad_input = 2 };

/// The subcommand that the user chose, set while the command line is parsed; returns the exit code.
using Run = std::function<int()>;

/// An option with a value; type: what stands for the value in the help.
template <class Value>
CLI::Option* add_value(CLI::App& command, const std::string& name, Value& value, const char* type,
                       const std::string& what, const CLI::Validator& check = {}) {
  return command.add_option(name, value, what)->type_name(type)->check(check);
}

/// The same for one that may be given several times.
inline CLI::Option* add_repeated(CLI::App& command, const std::string& name, std::vector<std::string>& values,
                                 const char* type, const std::string& what) {
  return add_value(command, name, values, type, what)->expected(1)->take_all();
}

/// --force-overwrite, of a command that writes files: else it replaces what softkin wrote, and nothing else.
inline void add_overwriting(CLI::App& command, bool& may_replace) {
  command.add_flag(
      "--force-overwrite", may_replace,
      "Replace files too that softkin did not write (default: what is to be\nwritten is refused where such a "
      "file is); never one that is read");
}

/// A subcommand whose options are kept for the run, which is that of a command of its own where one was chosen.
/// declare: adds them; act: returns the exit code
template <class Options>
CLI::App* add_command(CLI::App& app, Run& run, const std::string& name, const std::string& what,
                      const std::string& footer, void (*declare)(CLI::App&, Options&), int (*act)(const Options&)) {
  CLI::App* command = app.add_subcommand(name, what);
  const auto options = std::make_shared<Options>();
  declare(*command, *options);
  command->footer(footer);
  command->callback([command, options, act, &run] {
    if (command->get_subcommands().empty()) run = [options, act] { return act(*options); };
  });
  return command;
}

/// Refuses a text that is not right: "must be WHAT, not TEXT".
inline CLI::Validator must_be(const std::string& what, const std::function<bool(const std::string&)>& right) {
  const auto check = [=](const std::string& text) {
    return right(text) ? std::string() : "must be " + what + ", not " + text;
  };
  return CLI::Validator(check, "");
}

void add_calibrate(CLI::App& app, Run& run);
void add_calibrate_material(CLI::App& calibrate, Run& run);
void add_calibrate_robot(CLI::App& calibrate, Run& run);
void add_compare(CLI::App& app, Run& run);
void add_drive(CLI::App& app, Run& run);
void add_estimate(CLI::App& app, Run& run);
void add_examples(CLI::App& app, Run& run);
void add_fk(CLI::App& app, Run& run);
void add_follow(CLI::App& app, Run& run);
void add_grasp(CLI::App& app, Run& run);
void add_ik(CLI::App& app, Run& run);
void add_map(CLI::App& app, Run& run);
void add_map_export(CLI::App& map, Run& run);
void add_mesh(CLI::App& app, Run& run);
void add_measure(CLI::App& app, Run& run);
void add_options_command(CLI::App& app, Run& run);
void add_view_command(CLI::App& app, Run& run);
void add_walk(CLI::App& app, Run& run);
void add_workspace(CLI::App& app, Run& run);

}  // namespace softkin::cli
