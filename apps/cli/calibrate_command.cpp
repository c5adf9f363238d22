#include "calibrate_command.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

namespace softkin::cli {

void add_calibrate(CLI::App& app, Run& run) {
  CLI::App& calibrate = *app.add_subcommand("calibrate", "Parameters of the model from measurements");
  calibrate.require_subcommand(0, 1);  // "1" would hide the name of one that does not exist
  calibrate.callback([&calibrate] {
    if (calibrate.get_subcommands().empty())
      throw CLI::RequiredError("a subcommand of calibrate (material, pressure, dea)");
  });
  calibrate.footer("Example:\n  softkin calibrate material specimens.csv");
  add_calibrate_material(calibrate, run);
  add_calibrate_pressure(calibrate, run);
  add_calibrate_dea(calibrate, run);
}

}  // namespace softkin::cli
