#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/runs/exported_files.hpp>

#include "command.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

/// What the user asks of `softkin map export`.
struct ExportOptions : runs::MapExport {
  std::string map;
  bool may_replace = false;

  [[nodiscard]] std::vector<Output> outputs() const {
    return requested_outputs({{"--c", c}, {"--numpy", numpy}, {"--js", js}, {"--js", js_types()}});
  }
};

void add_options(CLI::App& command, ExportOptions& options) {
  command.add_option("MAP", options.map, "Of softkin map")->type_name("F.skmap")->required();
  add_value(
      command, "--c", options.c, "F.h",
      "A header of C99 for microcontrollers, that includes nothing:\noutputs, their Jacobian, inverse kinematics");
  command.add_flag("--float", options.floats, "With --c: numbers of 4 bytes instead of 8");
  add_value(command, "--numpy", options.numpy, "F.npz", "All arrays, for numpy alone (examples/python/map_numpy.py)");
  add_value(command, "--js", options.js, "F.mjs",
            "A module for browsers and node, and beside it F.d.mts with its\ntypes: outputs, their Jacobian, inverse "
            "kinematics, the shape");
  add_overwriting(command, options.may_replace);
}

void check_usage(const ExportOptions& options) {
  if (options.c.empty() && options.numpy.empty() && options.js.empty())
    throw InvalidInput("nothing is to be written: give --c F.h, --numpy F.npz or --js F.mjs");
  if (options.floats && options.c.empty()) throw InvalidInput("--float is of the header in C: it needs --c F.h");
  check_extension("--c", options.c, {{".h", ""}});
  check_extension("--numpy", options.numpy, {{".npz", ""}});
  check_extension("--js", options.js, {{".mjs", ""}});
}

int run_export(const ExportOptions& options) {
  check_usage(options);
  check_outputs(options.outputs(), {options.map}, options.may_replace);
  const std::vector<runs::ExportedFile> all = runs::exported_files(options.map, options);
  const OutputFolders folders(options.outputs());
  for (const runs::ExportedFile& each : all) {
    write_file(each.file, each.text);
    print(each.file + ": " + each.what + "\n");
  }
  return done;
}

}  // namespace

void add_map_export(CLI::App& map, Run& run) {
  CLI::App* const command = add_command(
      map, run, "export", "A map for programs without softkin: C, numpy, JavaScript",
      "Each file but numpy's checks itself: call check() once. Exit code: 0 done, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin map export actuator.skmap --c actuator.h --float --js actuator.mjs",
      add_options, run_export);
  CLI::Option *const scene = map.get_option("SCENE"), *const output = map.get_option("--output");
  for (CLI::Option* option : map.get_options())
    if (option != map.get_help_ptr()) command->excludes(option);
  command->preparse_callback([output](std::size_t) { output->required(false); });
  scene->required(false);  // as long as it lacks one CLI11 would take the name of the command for it
  map.parse_complete_callback([&map, scene] {
    if (scene->count() == 0 && map.get_subcommands().empty()) throw CLI::RequiredError("SCENE");
  });
}

}  // namespace softkin::cli
