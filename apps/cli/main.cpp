#include <CLI/CLI.hpp>
#include <softkin/core/target.hpp>
#include <softkin/runs/page.hpp>
#include <string>

#include "command.hpp"
#include "terminal.hpp"
#include "usage.hpp"

namespace {

using namespace softkin;

/// "softkin follow": as far as the user got.
std::string chosen_command(const CLI::App& app) {
  std::string command = "softkin";
  for (const CLI::App* each = &app; !each->get_subcommands().empty();) {
    each = each->get_subcommands().front();
    command += " " + each->get_name();
  }
  return command;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"softkin: kinematics of soft robots. Lengths in mm, ratios without unit.", "softkin"};
  app.formatter(std::make_shared<cli::PageFormatter>());
  app.set_version_flag("--version",
                       [] { return std::string("softkin " SOFTKIN_VERSION ", instruction set ") + name_of(target()); });
  app.require_subcommand(0, 1);  // "1" would hide the name of a command that does not exist
  app.callback([&app] {
    if (app.get_subcommands().empty())
      throw CLI::RequiredError(
          "a command (fk, ik, follow, workspace, map, walk, grasp, compare, calibrate, estimate, measure, drive, mesh, "
          "view, "
          "examples)");
  });
  runs::keep_command({argv, argv + argc});
  cli::Run run;
  cli::add_fk(app, run);
  cli::add_ik(app, run);
  cli::add_follow(app, run);
  cli::add_compare(app, run);
  cli::add_drive(app, run);
  cli::add_mesh(app, run);
  cli::add_calibrate(app, run);
  cli::add_estimate(app, run);
  cli::add_measure(app, run);
  cli::add_walk(app, run);
  cli::add_grasp(app, run);
  cli::add_workspace(app, run);
  cli::add_map(app, run);
  cli::add_view_command(app, run);
  cli::add_examples(app, run);
  cli::add_options_command(app, run);
  return cli::outcome_of([&] {
    (void)target();  // refused, where it is, before anything is done
    std::string command = "softkin";
    if (const std::string wrong = cli::misspelt(app, argc, argv, command); !wrong.empty())
      return cli::refuse_usage(wrong, command);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return cli::answer_usage(app, error, chosen_command(app));
    }
    return run();
  });
}
