#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <functional>
#include <string>

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

/// Refuses a text that is not right: "must be WHAT, not TEXT".
inline CLI::Validator must_be(const std::string& what, const std::function<bool(const std::string&)>& right) {
  const auto check = [=](const std::string& text) {
    return right(text) ? std::string() : "must be " + what + ", not " + text;
  };
  return CLI::Validator(check, "");
}

void add_calibrate(CLI::App& app, Run& run);
void add_calibrate_material(CLI::App& calibrate, Run& run);
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
