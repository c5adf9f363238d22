#include "workspace_options.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/text_mesh_tools.hpp>

namespace softkin::cli {

namespace {

constexpr std::int64_t most_samples = 100'000'000, most_threads = 512;

CLI::Validator whole_number(std::int64_t low, std::int64_t high) {
  const auto check = [low, high](const std::string& text) -> std::string {
    std::int64_t value = 0;
    if (parse_integer(text, value) && value >= low && value <= high) return "";
    return "must be an integer from " + std::to_string(low) + " to " + std::to_string(high) + ", not " + text;
  };
  return CLI::Validator(check, "");
}

void add_files(CLI::App& command, WorkspaceOptions& options) {
  command.add_option("SCENE", options.robot.scene, "Scene, YAML (docs/scene.md)")->type_name("")->required();
  command
      .add_option("-o,--output", options.output,
                  "A row per sample: actuation, markers [mm], tensions [N] and\npressures [kPa], status; grows while "
                  "samples are solved")
      ->type_name("F.csv")
      ->required();
  command.add_option("--cloud", options.cloud, "The marker at every sample, with actuation and loads, for\nParaView")
      ->type_name("F.vtu");
  command.add_option("--hull", options.hull, "Convex hull of the marker's positions; its volume is printed")
      ->type_name("F");
  command.add_option("--plot", options.plot, "The marker's positions, seen along the axes")->type_name("F.svg");
  command
      .add_option("--marker", options.marker,
                  "The marker that --cloud, --hull and --plot show (default: the\nscene's first); the CSV has all")
      ->type_name("NAME");
}

void add_sampling(CLI::App& command, WorkspaceOptions& options) {
  command
      .add_option("--samples", options.samples,
                  "How many actuations, inside the ranges of the actuators; a grid\ntakes the nearest number that "
                  "fills it")
      ->type_name("N")
      ->required()
      ->check(whole_number(1, most_samples));
  command
      .add_option("--sampling", options.sampling,
                  "grid (default): as many values for every actuator, ends\nincluded; sobol: a low-discrepancy "
                  "sequence; random: uniform")
      ->type_name("NAME")
      ->check(CLI::IsMember({"grid", "sobol", "random"}).description(""));
  command.add_option("--seed", options.seed, "Of --sampling random (default: 0)")
      ->type_name("S")
      ->check(whole_number(0, std::numeric_limits<std::int64_t>::max()));
}

void add_robot(CLI::App& command, FkOptions& robot) {
  command
      .add_option("--formulation", robot.formulation,
                  "physical: elastic laws, pressures, tensions and forces;\ntarget-shape: Fang et al. 2020; default: "
                  "the scene's")
      ->type_name("NAME")
      ->check(CLI::IsMember({"physical", "target-shape"}).description(""));
  command
      .add_option("--solver", robot.solver_name,
                  "newton (default), or local-global: Algorithm 1 of Fang et al.\n2020, target-shape only")
      ->type_name("NAME")
      ->check(CLI::IsMember({"newton", "local-global"}).description(""));
  command
      .add_option("--force", robot.forces,
                  "NAME=FX,FY,FZ: another size and direction for the scene's\nforce of that name [N]; physical; "
                  "repeatable")
      ->type_name("N=F")
      ->expected(1)
      ->take_all();
  command
      .add_option("--threads", robot.threads,
                  "Samples solved at once, each on one thread; 0: as many as the\nmachine has (default); under mpirun: "
                  "of each rank")
      ->type_name("N")
      ->check(whole_number(0, most_threads));
  command.add_flag("--resume", robot.resume, "Go on where the same command was interrupted or killed");
  command.add_flag("--json", robot.json, "Print a summary as JSON");
}

void check_extension(const char* option, const std::string& file, const std::vector<std::string>& extensions) {
  if (file.empty()) return;
  std::string known;
  for (const std::string& extension : extensions) {
    if (lower_extension(file) == extension) return;
    known += (known.empty() ? "" : " or ") + extension;
  }
  throw InvalidInput(std::string(option) + " " + file + ": must end in " + known);
}

}  // namespace

std::vector<Output> WorkspaceOptions::outputs() const {
  std::vector<Output> outputs;
  const auto add = [&](const char* option, const std::string& file) {
    if (!file.empty()) outputs.push_back({option, file, 0});
  };
  add("--output", output);
  add("--cloud", cloud);
  add("--hull", hull);
  add("--plot", plot);
  return outputs;
}

Sampling WorkspaceOptions::kind() const {
  return sampling == "grid" ? Sampling::grid : sampling == "sobol" ? Sampling::sobol : Sampling::random;
}

void add_options(CLI::App& command, WorkspaceOptions& options) {
  add_files(command, options);
  add_sampling(command, options);
  add_robot(command, options.robot);
}

void check_usage(const WorkspaceOptions& options) {
  check_extension("--output", options.output, {".csv"});
  check_extension("--cloud", options.cloud, {".vtu"});
  check_extension("--hull", options.hull, {".vtu", ".stl"});
  check_extension("--plot", options.plot, {".svg"});
  if (options.seed && options.kind() != Sampling::random)
    throw InvalidInput("--seed is the seed of random samples: it needs --sampling random");
}

}  // namespace softkin::cli
