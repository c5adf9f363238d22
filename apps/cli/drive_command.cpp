#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scene/hardware.hpp>

#include "command.hpp"
#include "drive_commands.hpp"
#include "drive_options.hpp"
#include "drive_stream.hpp"
#include "drive_text.hpp"
#include "mesh_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

DrivePlan plan_of(const DriveOptions& options, std::vector<fs::path>& inputs) {
  const Model model = asked_robot(options.robot, inputs);
  DrivePlan plan;
  plan.commands = read_commands(model, options.commands, options.pressures);
  const fs::path hardware = options.hardware_file();
  if (options.hardware.empty() && !fs::exists(hardware))
    throw InvalidInput({hardware.string()},
                       "no such file; describe motors and regulators there (docs/drive.md), or name the file with "
                       "--hardware");
  plan.machine = drive::assemble(model, read_hardware(hardware), plan.commands);
  plan.schedule = drive::plan_pressures(plan.machine, plan.commands);
  if (!plan.machine.tendons.empty()) {
    plan.motion = drive::plan_motion(plan.machine, plan.commands, options.return_home);
    plan.program = drive::make_gcode(plan.machine, plan.motion);
  }
  return plan;
}

void check_asked(const DriveOptions& options, const DrivePlan& plan) {
  if (plan.machine.tendons.empty())
    for (const auto& [option, value] : {std::pair{"--gcode", options.gcode}, std::pair{"--port", options.port}})
      if (!value.empty()) throw InvalidInput(std::string(option) + " " + value + ": there is no tendon to move");
  if (!options.schedule.empty() && plan.machine.chambers.empty())
    throw InvalidInput("--schedule " + options.schedule + ": " + options.commands + " commands no chamber");
}

void write_files(const DriveOptions& options, const DrivePlan& plan) {
  if (!options.gcode.empty()) write_file(options.gcode, drive::gcode_text(plan.machine, plan.program));
  if (!options.schedule.empty()) write_file(options.schedule, drive::schedule_csv(plan.schedule));
}

std::string dry_text(const DrivePlan& plan) {
  std::string text;
  if (!plan.machine.tendons.empty()) text += "\n" + drive::gcode_text(plan.machine, plan.program);
  if (!plan.machine.chambers.empty()) text += "\n" + drive::schedule_csv(plan.schedule);
  return text;
}

int run_drive(const DriveOptions& options) {
  check_usage(options);
  std::vector<fs::path> inputs{options.robot.scene, options.commands, options.hardware_file()};
  if (!options.pressures.empty()) inputs.emplace_back(options.pressures);
  ProgressLine line;
  line.show(-1, "reading the scene");
  const DrivePlan plan = plan_of(options, inputs);
  line.clear();
  check_asked(options, plan);
  check_outputs(options.outputs(), inputs);
  const OutputFolders folders(options.outputs());
  std::optional<drive::SerialPort> port;  // before anything is written
  if (!options.port.empty()) port.emplace(options.port, options.baud);
  if (!options.json) print(plan_text(plan) + (options.dry_run ? dry_text(plan) : ""));
  write_files(options, plan);
  Json json = {{"softkin", SOFTKIN_VERSION}, {"scene", options.robot.scene}, {"commands", options.commands}};
  json.update(plan_json(plan));
  if (options.dry_run && !plan.machine.tendons.empty()) json["gcode"] = drive::gcode_text(plan.machine, plan.program);
  if (options.dry_run && !plan.machine.chambers.empty()) json["schedule"] = drive::schedule_csv(plan.schedule);
  int code = done;
  if (port) {
    const drive::StreamReport report = send_to_board(*port, options, plan.program);
    const std::string text = stream_text(options, plan.program, report);
    code = report.end == drive::StreamEnd::finished ? done : not_converged;
    json["stream"] = stream_json(plan.program, report);
    if (code != done)
      std::fprintf(stderr, "softkin: %s\n", text.c_str());
    else if (!options.json)
      print(text + "\n");
  }
  if (options.json) print(json);
  return code;
}

}  // namespace

void add_drive(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("drive", "Hardware: stepper moves and pressures from a file of commands");
  const auto options = std::make_shared<DriveOptions>();
  add_options(*command, *options);
  command->footer(
      "The whole file is checked against all limits before anything is written or sent. While it sends, Ctrl-C stops\n"
      "after the moves that the board has, a second Ctrl-C at once (the position is then unknown), Ctrl-Z pauses and\n"
      "goes on. Exit code: 0 done, 1 stopped or failed on the way, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin drive examples/three_tendon_finger/three_tendon_finger.yaml \\\n"
      "      examples/three_tendon_finger/path.csv --dry-run");
  command->callback([options, &run] { run = [options] { return run_drive(*options); }; });
}

}  // namespace softkin::cli
