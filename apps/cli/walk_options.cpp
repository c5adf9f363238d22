#include "walk_options.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <softkin/core/error.hpp>

namespace softkin::cli {

std::vector<Output> WalkOptions::outputs(std::size_t steps) const {
  std::vector<Output> outputs;
  for (const auto& name : {this->steps(), plot(), report()}) outputs.push_back({"--output", name});
  outputs.push_back({"--output", shapes(), steps});
  return outputs;
}

void add_options(CLI::App& command, WalkOptions& options) {
  add_scene(command, options);
  command
      .add_option("GAIT", options.gait,
                  "One cycle of commands, a column for each actuator that\nchanges, and t_s; the last row is the first "
                  "one again")
      ->type_name("F.csv")
      ->required();
  command
      .add_option("-o,--output", options.folder,
                  "Folder for walk.csv, walk.pvd with the shapes, walk.svg and\nreport.json")
      ->type_name("DIR")
      ->required();
  command
      .add_option("--cycles", options.cycles,
                  "How often the gait is walked (default: " + std::to_string(WalkOptions().cycles) + ")")
      ->type_name("N")
      ->check(integer_from(1, 100'000));
  add_force(command, options);
  add_solver(command, options, "--tolerance");
  command.add_flag("--resume", options.resume, "Go on where the same command was interrupted, or with more\n--cycles");
  command.add_flag("--json", options.json, "Print the report instead of the table");
}

void check_usage(const WalkOptions& options) {
  if (options.folder.empty()) throw InvalidInput("--output: the name of the folder is empty");
  check_solver(options);
}

}  // namespace softkin::cli
