#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/runs/map_export.hpp>
#include <softkin/runs/map_file.hpp>

#include "command.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

/// What the user asks of `softkin map export`. An empty file name: not given.
struct ExportOptions {
  std::string map;
  std::string c, numpy, js;
  bool floats = false;

  /// Those of the module, beside it: robot.d.mts of robot.mjs.
  [[nodiscard]] std::string js_types() const {
    return js.empty() ? "" : fs::path(js).replace_extension(".d.mts").string();
  }
  [[nodiscard]] std::vector<Output> outputs() const {
    return asked_outputs({{"--c", c}, {"--numpy", numpy}, {"--js", js}, {"--js", js_types()}});
  }
};

/// A file that is written once all of them are known.
struct Exported {
  std::string file, text, what;
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
}

void check_usage(const ExportOptions& options) {
  if (options.c.empty() && options.numpy.empty() && options.js.empty())
    throw InvalidInput("nothing is to be written: give --c F.h, --numpy F.npz or --js F.mjs");
  if (options.floats && options.c.empty()) throw InvalidInput("--float is of the header in C: it needs --c F.h");
  check_extension("--c", options.c, {{".h", ""}});
  check_extension("--numpy", options.numpy, {{".npz", ""}});
  check_extension("--js", options.js, {{".mjs", ""}});
}

/// "arm_fk(), ...; tables: 1216 bytes of flash ...": how it is called, and what the header says that it takes.
std::string c_text(const MapData& data, const std::string& header) {
  std::string text = runs::c_name(data) + "_fk(), ...";
  const std::size_t from = header.find("Tables: "), end = header.find(" No heap.", from);
  if (end != std::string::npos) text += "; t" + header.substr(from + 1, end - from - 2);
  return text;
}

std::vector<Exported> exported(const ExportOptions& options, const MapData& data) {
  std::vector<Exported> all;
  if (!options.c.empty()) {
    std::string header = runs::map_c_header(data, options.floats ? runs::CNumbers::floats : runs::CNumbers::doubles);
    std::string what = c_text(data, header);
    all.push_back({options.c, std::move(header), std::move(what)});
  }
  if (!options.numpy.empty()) all.push_back({options.numpy, runs::map_npz(data), ""});
  if (!options.js.empty()) {
    all.push_back({options.js, runs::map_js_module(data), data.shape ? "" : "without the shape, which the map lacks"});
    all.push_back({options.js_types(), runs::map_js_types(data), "types"});
  }
  return all;
}

std::vector<Exported> exported_from(const ExportOptions& options) {
  const MapData data = runs::read_map(options.map);
  try {
    return exported(options, data);
  } catch (const InvalidInput& error) {
    throw InvalidInput({options.map}, error.what());
  }
}

int run_export(const ExportOptions& options) {
  check_usage(options);
  check_outputs(options.outputs(), {options.map});
  const std::vector<Exported> all = exported_from(options);
  const OutputFolders folders(options.outputs());
  constexpr double kilo = 1000;
  for (const Exported& each : all) {
    write_file(each.file, each.text);
    print(each.file + ": " + number(static_cast<double>(each.text.size()) / kilo, 3) + " kB" +
          (each.what.empty() ? "" : "; " + each.what) + "\n");
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
