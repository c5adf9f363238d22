#include "calibrate_command.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

namespace softkin::cli {

void add_calibrate(CLI::App& app, Run& run) {
  CLI::App& calibrate = *app.add_subcommand("calibrate", "Fit the model to measurements of the real robot");
  calibrate.require_subcommand(0, 1);  // "1" would hide the name of one that does not exist
  calibrate.callback([&calibrate] {
    if (calibrate.get_subcommands().empty()) throw CLI::RequiredError("a subcommand of calibrate (pressure, dea)");
  });
  add_calibrate_pressure(calibrate, run);
  add_calibrate_dea(calibrate, run);
}

}  // namespace softkin::cli
