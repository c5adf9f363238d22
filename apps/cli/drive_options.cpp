#include "drive_options.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/scanner.hpp>

namespace softkin::cli {

namespace {

constexpr int lowest_baud = 1200, highest_baud = 4'000'000;

CLI::Validator baud_rate() {
  const auto check = [](const std::string& text) -> std::string {
    std::int64_t value = 0;
    if (parse_integer(text, value) && value >= lowest_baud && value <= highest_baud) return "";
    return "must be an integer from " + std::to_string(lowest_baud) + " to " + std::to_string(highest_baud) +
           " baud, not " + text;
  };
  return CLI::Validator(check, "");
}

CLI::Validator seconds() {
  const auto check = [](const std::string& text) -> std::string {
    double value = 0;
    if (parse_real(text, value) && value >= 0 && value <= 600) return "";
    return "must be 0 to 600 s, not " + text;
  };
  return CLI::Validator(check, "");
}

void add_outputs(CLI::App& command, DriveOptions& options) {
  command.add_flag("--dry-run", options.dry_run, "Print what would be sent, and send nothing");
  command.add_option("--gcode", options.gcode, "Write the tendons' moves for Marlin")->type_name("F.gcode");
  command.add_option("--schedule", options.schedule, "Write the chambers' pressures over time (t_s, air_kPa)")
      ->type_name("F.csv");
  command.add_option("--port", options.port, "Send the moves to the board at this serial port")
      ->type_name("/dev/ttyUSB0");
  command.add_option("--baud", options.baud, "Rate of the port (default: 115200; many boards have 250000)")
      ->type_name("N")
      ->check(baud_rate());
  command
      .add_option("--boot-wait", options.boot_wait_s,
                  "Wait so long before the first line [s]: many boards boot when\ntheir port is opened (default: 3)")
      ->type_name("S")
      ->check(seconds());
  command.add_option("--log", options.log, "With --port: every line sent and received, with its time")->type_name("F");
}

}  // namespace

std::filesystem::path DriveOptions::hardware_file() const {
  if (!hardware.empty()) return hardware;
  std::filesystem::path file = robot.scene;
  return file.replace_extension(".hardware.yaml");
}

std::vector<Output> DriveOptions::outputs() const {
  std::vector<Output> outputs;
  const auto add = [&](const char* option, const std::string& file) {
    if (!file.empty()) outputs.push_back({option, file});
  };
  add("--gcode", gcode);
  add("--schedule", schedule);
  add("--log", log);
  return outputs;
}

void add_options(CLI::App& command, DriveOptions& options) {
  command.add_option("SCENE", options.robot.scene, "Scene, YAML (docs/scene.md)")->type_name("")->required();
  command
      .add_option(
          "COMMANDS", options.commands,
          "What follow writes (commands.csv) and fk --path reads: a column\nper actuator, t_s for the times [s]; "
          "without times the motors go\nat the hardware's approach speed")
      ->type_name("F.csv")
      ->required();
  command
      .add_option("--hardware", options.hardware,
                  "Motors and regulators (docs/drive.md); default: that of the\nscene's name, finger.hardware.yaml "
                  "beside finger.yaml")
      ->type_name("F.yaml");
  command
      .add_option(
          "--pressures", options.pressures,
          "Report of the run that made the commands (follow, fk): the\npressures of chambers that are commanded "
          "by volume")
      ->type_name("F.json");
  command.add_flag("--return", options.return_home, "After the last row go back home, for the next run");
  add_outputs(command, options);
  command.add_flag("--json", options.json, "Print a report instead of the tables");
}

void check_usage(const DriveOptions& options) {
  if (options.dry_run && !options.port.empty())
    throw InvalidInput("--dry-run sends nothing, and --port sends: give one of them");
  if (!options.log.empty() && options.port.empty())
    throw InvalidInput("--log is of what is sent and received: it needs --port");
  if (!options.dry_run && options.port.empty() && options.gcode.empty() && options.schedule.empty())
    throw InvalidInput(
        "nothing is to be done: give --dry-run (print), --gcode F, --schedule F.csv (write) or --port (send)");
}

}  // namespace softkin::cli
