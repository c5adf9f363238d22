#include <signal.h>

#include <cstdio>
#include <filesystem>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/hardware.hpp>
#include <softkin/io/stream_log.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/runs/answers.hpp>
#include <softkin/runs/drive_text.hpp>
#include <softkin/runs/map_commands.hpp>
#include <softkin/runs/map_file.hpp>
#include <softkin/runs/reports.hpp>

#include "command.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

/// What the user asks of `softkin drive`. An empty file name: not given.
struct DriveOptions {
  SolveOptions robot;  // scene alone
  std::string commands, hardware, pressures, map;
  std::string gcode, schedule, log;  // to write
  std::string port;
  int baud = 115200;
  double boot_wait_s = 3;
  bool dry_run = false, return_home = false, json = false, may_replace = false;

  /// As given, or that of the scene's name: finger.yaml has finger.hardware.yaml.
  [[nodiscard]] fs::path hardware_file() const {
    return hardware.empty() ? fs::path(robot.scene).replace_extension(".hardware.yaml") : fs::path(hardware);
  }
};

CLI::Validator baud_rate() {
  return must_be("an integer from 1200 to 4000000 baud", [](const std::string& text) {
    std::int64_t value = 0;
    return parse_integer(text, value) && value >= 1200 && value <= 4'000'000;
  });
}

CLI::Validator seconds() {
  return must_be("0 to 600 s", [](const std::string& text) {
    double value = 0;
    return parse_real(text, value) && value >= 0 && value <= 600;
  });
}

void add_outputs(CLI::App& command, DriveOptions& options) {
  command.add_flag("--dry-run", options.dry_run, "Print what would be sent, and send nothing");
  add_value(command, "--gcode", options.gcode, "F.gcode", "Write the moves of tendons and plungers for Marlin");
  add_value(command, "--schedule", options.schedule, "F.csv", "Write the chambers' pressures over time (t_s, air_kPa)");
  add_value(command, "--port", options.port, "/dev/ttyUSB0", "Send the moves to the board at this serial port");
  add_value(command, "--baud", options.baud, "N", "Rate of the port (default: 115200; many boards have 250000)",
            baud_rate());
  add_value(command, "--boot-wait", options.boot_wait_s, "S",
            "Wait so long before the first line [s]: many boards boot when\ntheir port is opened (default: 3)",
            seconds());
  add_value(command, "--log", options.log, "F", "With --port: every line sent and received, with its time");
  add_overwriting(command, options.may_replace);
}

void add_options(CLI::App& command, DriveOptions& options) {
  add_scene(command, options.robot);
  add_value(command, "COMMANDS", options.commands, "F.csv",
            "What follow writes (commands.csv) and fk --path reads: a column\nper actuator, t_s for the times [s]; "
            "without times the motors go\nat the hardware's approach speed")
      ->required();
  add_value(command, "--hardware", options.hardware, "F.yaml",
            "Motors and regulators (docs/drive.md); default: that of the\nscene's name, finger.hardware.yaml beside "
            "finger.yaml");
  add_value(command, "--pressures", options.pressures, "F",
            "The pressures of chambers that are commanded by volume: F.json,\nreport of the run that made the commands "
            "(follow, "
            "fk), or F.csv,\nmeasured ratios of coupled chambers by all their pressures");
  add_value(command, "--map", options.map, "F.skmap",
            "Kinematic map of the robot (softkin map), which knows these\npressures; rows outside it are refused");
  command.add_flag("--return", options.return_home, "After the last row go back home, for the next run");
  add_outputs(command, options);
  command.add_flag("--json", options.json, "Print a report instead of the tables");
}

void check_usage(const DriveOptions& options) {
  if (!options.map.empty() && !options.pressures.empty())
    throw InvalidInput("--map and --pressures both give the chambers' pressures: use one of them");
  if (options.dry_run && !options.port.empty())
    throw InvalidInput("--dry-run sends nothing, and --port sends: give one of them");
  if (!options.log.empty() && options.port.empty())
    throw InvalidInput("--log is of what is sent and received: it needs --port");
  if (!options.dry_run && options.port.empty() && options.gcode.empty() && options.schedule.empty())
    throw InvalidInput(
        "nothing is to be done: give --dry-run (print), --gcode F, --schedule F.csv (write) or --port (send)");
}

std::string plan_text(const drive::Plan& plan) {
  std::string text = "hardware: " + plan.machine.file + "\n";
  for (const std::string& line : plan.machine.defaults) text += "default: " + printable(line) + "\n";
  if (!plan.machine.tendons.empty()) text += table_text(runs::tendon_table(plan));
  if (!plan.machine.syringes.empty()) text += table_text(runs::syringe_table(plan));
  if (!plan.machine.chambers.empty()) text += table_text(runs::chamber_table(plan));
  return text + runs::times_text(plan) + "\n";
}

std::string dry_text(const drive::Plan& plan) {
  std::string text;
  if (!plan.machine.syringes.empty()) text += "\n" + table_text(runs::plunger_table(plan));
  if (plan.has_motors()) text += "\n" + drive::gcode_text(plan.machine, plan.program);
  if (!plan.machine.chambers.empty()) text += "\n" + drive::schedule_csv(plan.schedule);
  return text;
}

volatile sig_atomic_t stop_count = 0, pause_requested = 0;

void on_stop(int signal_number) {
  stop_count = stop_count + 1;
  if (stop_count < 3) return;
  ::signal(signal_number, SIG_DFL);
  ::raise(signal_number);
}

void on_pause(int) {
  pause_requested = !pause_requested;
}

void catch_signals() {
  struct sigaction action = {};
  action.sa_flags = SA_RESTART;
  action.sa_handler = on_stop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = on_pause;
  sigaction(SIGTSTP, &action, nullptr);
}

drive::Order order_of_user() {
  if (stop_count > 1) return drive::Order::quick_stop;
  if (stop_count > 0) return drive::Order::stop;
  return pause_requested ? drive::Order::pause : drive::Order::go;
}

/// Sends a program to the board at the port. Ctrl-C stops after the moves that the board has, a second one at once,
/// a third one ends the program; Ctrl-Z pauses and resumes.
///
/// throws  InvalidInput where the log cannot be opened
drive::StreamReport send_to_board(drive::SerialPort& port, const DriveOptions& options,
                                  const drive::GcodeProgram& program) {
  std::optional<StreamLog> log;
  if (!options.log.empty())
    log.emplace(options.log, [&](const std::string& why) {
      std::fprintf(stderr, "softkin: warning: --log %s: %s\n", options.log.c_str(), why.c_str());
    });
  catch_signals();
  ProgressLine line;
  const double begin = seconds_now();
  bool was_paused = false;
  drive::LinkHooks hooks;
  hooks.order = [&] {
    const drive::Order order = order_of_user();
    if ((order == drive::Order::pause) != was_paused) {
      was_paused = !was_paused;
      line.clear();
      std::fprintf(stderr, was_paused ? "softkin: paused: Ctrl-Z continues, Ctrl-C stops\n" : "softkin: continues\n");
    }
    return order;
  };
  if (log) hooks.log = [&](char kind, const std::string& text) { log->add(kind, text); };
  hooks.progress = [&](std::size_t lines) {
    line.show(static_cast<double>(lines) / static_cast<double>(program.lines.size()),
              std::to_string(lines) + "/" + std::to_string(program.lines.size()) + " lines, " +
                  duration(seconds_now() - begin) + "; Ctrl-C stops, Ctrl-Z pauses");
  };
  drive::LinkOptions link;
  link.boot_s = options.boot_wait_s;
  return drive::stream(port, program, link, hooks);
}

/// Returns the plan to drive. map: receives the map that gave the pressures, where one was requested.
drive::Plan plan_of(const DriveOptions& options, std::vector<fs::path>& inputs, std::optional<KinematicMap>& map) {
  const Model model = requested_robot(options.robot, inputs);
  Commands commands = read_commands(model, options.commands, options.pressures);
  if (!options.map.empty()) {
    map = runs::read_map_of(model, options.map);
    runs::take_pressures(model, *map, options.map, commands);
  }
  const fs::path hardware = options.hardware_file();
  if (options.hardware.empty() && !fs::exists(hardware))
    throw InvalidInput({hardware.string()},
                       "no such file; describe motors and regulators there (docs/drive.md), or name the file with "
                       "--hardware");
  return drive::make_plan(model, read_hardware(hardware), std::move(commands), options.return_home);
}

void check_requested(const DriveOptions& options, const drive::Plan& plan) {
  if (!plan.has_motors())
    for (const auto& [option, value] : {std::pair{"--gcode", options.gcode}, std::pair{"--port", options.port}})
      if (!value.empty())
        throw InvalidInput(std::string(option) + " " + value + ": there is no tendon or plunger to move");
  if (!options.schedule.empty() && plan.machine.chambers.empty())
    throw InvalidInput("--schedule " + options.schedule + ": " + options.commands +
                       " commands no chamber of a regulator");
}

/// A schedule does not name softkin, as its player may not support comments: only an identical one is replaced.
std::vector<Output> outputs_of(const DriveOptions& options, const drive::Plan& plan) {
  std::vector<Output> outputs =
      requested_outputs({{"--gcode", options.gcode}, {"--schedule", options.schedule}, {"--log", options.log}});
  for (Output& output : outputs)
    if (output.option == "--schedule")
      output.is_own = [text = drive::schedule_csv(plan.schedule)](const fs::path& file) {
        return read_file(file) == text;
      };
  return outputs;
}

int run_drive(const DriveOptions& options) {
  check_usage(options);
  std::vector<fs::path> inputs{options.robot.scene, options.commands, options.hardware_file()};
  for (const std::string& file : {options.pressures, options.map})
    if (!file.empty()) inputs.emplace_back(file);
  ProgressLine line;
  line.show(-1, "reading the scene");
  std::optional<KinematicMap> map;
  const drive::Plan plan = plan_of(options, inputs, map);
  line.clear();
  check_requested(options, plan);
  const std::vector<Output> outputs = outputs_of(options, plan);
  check_outputs(outputs, inputs, options.may_replace);
  check_extension("--gcode", options.gcode, {{".gcode", ""}, {".gco", ""}, {".g", ""}});
  check_extension("--schedule", options.schedule, {{".csv", ""}});
  const OutputFolders folders(outputs);
  std::optional<drive::SerialPort> port;  // before anything is written
  if (!options.port.empty()) port.emplace(options.port, options.baud);
  if (!options.json)
    print(plan_text(plan) +
          (map ? "pressures by the map " + options.map + ": " + runs::map_text(map->data()) + "\n" : "") +
          (options.dry_run ? dry_text(plan) : ""));
  if (!options.gcode.empty()) write_file(options.gcode, drive::gcode_text(plan.machine, plan.program));
  if (!options.schedule.empty()) write_file(options.schedule, drive::schedule_csv(plan.schedule));
  std::optional<drive::StreamReport> sent;
  if (port) sent = send_to_board(*port, options, plan.program);
  const bool failed = sent && sent->end != drive::StreamEnd::finished;
  const std::string text = sent ? runs::stream_text(options.commands, plan.program, *sent) + "\n" : "";
  if (failed)
    std::fprintf(stderr, "softkin: %s", text.c_str());
  else if (!options.json)
    print(text);
  if (options.json) {
    std::optional<runs::UsedMap> used;
    if (map) used.emplace(runs::UsedMap{options.map, map->data()});
    print(runs::drive_report(options.robot.scene, plan, options.dry_run, sent ? &*sent : nullptr,
                             used ? &*used : nullptr));
  }
  return failed ? not_converged : done;
}

}  // namespace

void add_drive(CLI::App& app, Run& run) {
  add_command(
      app, run, "drive", "Hardware: stepper moves and pressures from a file of commands",
      "The whole file is checked against all limits before anything is written or sent. While it sends, Ctrl-C stops\n"
      "after the moves that the board has, a second Ctrl-C at once (the position is then unknown), Ctrl-Z pauses and\n"
      "goes on. Exit code: 0 done, 1 stopped or failed before the end, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin drive examples/three_tendon_finger/three_tendon_finger.yaml \\\n"
      "      examples/three_tendon_finger/path.csv --dry-run",
      add_options, run_drive);
}

}  // namespace softkin::cli
