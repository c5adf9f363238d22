#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>
#include <softkin/core/error.hpp>
#include <string>

#include "command.hpp"

namespace {

using namespace softkin;

/// Help and version are printed; anything else is bad usage, told in one line.
int answer(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
  std::string command = "softkin", message = error.what();
  for (const CLI::App* each = &app; !each->get_subcommands().empty();) {
    each = each->get_subcommands().front();
    command += " " + each->get_name();
  }
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fprintf(stderr, "softkin: %s (%s --help tells more)\n", message.c_str(), command.c_str());
  return cli::bad_input;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"softkin: kinematics of soft robots. Lengths in mm, ratios without unit.", "softkin"};
  app.set_version_flag("--version", "softkin " SOFTKIN_VERSION);
  app.require_subcommand(0, 1);  // "1" would hide the name of a command that does not exist
  app.callback([&app] {
    if (app.get_subcommands().empty())
      throw CLI::RequiredError("a command (fk, ik, follow, workspace, compare, calibrate, measure, drive, mesh)");
  });
  cli::Run run;
  cli::add_fk(app, run);
  cli::add_ik(app, run);
  cli::add_follow(app, run);
  cli::add_compare(app, run);
  cli::add_drive(app, run);
  cli::add_mesh(app, run);
  cli::add_calibrate(app, run);
  cli::add_measure(app, run);
  cli::add_workspace(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return answer(app, error);
  }
  try {
    return run();
  } catch (const InvalidInput& error) {
    std::fprintf(stderr, "softkin: %s\n", error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    std::fprintf(stderr, "softkin: %s: %s\n", error.path1().c_str(), error.code().message().c_str());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "softkin: out of memory\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "softkin: internal error, please report it: %s\n", error.what());
  }
  return cli::bad_input;
}
