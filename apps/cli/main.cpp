#include <CLI/CLI.hpp>
#include <cstdio>
#include <softkin/core/error.hpp>

#include "command.hpp"

int main(int argc, char** argv) {
  using namespace softkin;
  CLI::App app{"softkin: kinematics of soft robots. Lengths in mm, ratios without unit."};
  app.set_version_flag("--version", "softkin " SOFTKIN_VERSION);
  app.require_subcommand(0, 1);  // "1" would hide the name of a command that does not exist
  app.callback([&app] {
    if (app.get_subcommands().empty()) throw CLI::RequiredError("a command (fk, mesh)");
  });
  cli::Run run;
  cli::add_fk(app, run);
  cli::add_mesh(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? cli::done : cli::bad_input;
  }
  try {
    return run();
  } catch (const InvalidInput& error) {
    std::fprintf(stderr, "softkin: %s\n", error.what());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "softkin: out of memory\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "softkin: internal error, please report it: %s\n", error.what());
  }
  return cli::bad_input;
}
