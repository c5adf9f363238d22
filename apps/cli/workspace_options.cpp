#include "workspace_options.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/scanner.hpp>

namespace softkin::cli {

namespace {

constexpr std::int64_t most_samples = 100'000'000;

void add_files(CLI::App& command, WorkspaceOptions& options) {
  add_scene(command, options);
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
      ->check(integer_from(1, most_samples));
  command
      .add_option("--sampling", options.sampling,
                  "grid (default): as many values for every actuator, ends\nincluded; sobol: a low-discrepancy "
                  "sequence; random: uniform")
      ->type_name("NAME")
      ->check(CLI::IsMember({"grid", "sobol", "random"}).description(""));
  command.add_option("--seed", options.seed, "Of --sampling random (default: 0)")
      ->type_name("S")
      ->check(integer_from(0, std::numeric_limits<std::int64_t>::max()));
}

}  // namespace

std::vector<Output> WorkspaceOptions::outputs() const {
  return asked_outputs({{"--output", output}, {"--cloud", cloud}, {"--hull", hull}, {"--plot", plot}});
}

Sampling WorkspaceOptions::kind() const {
  return sampling == "grid" ? Sampling::grid : sampling == "sobol" ? Sampling::sobol : Sampling::random;
}

void add_options(CLI::App& command, WorkspaceOptions& options) {
  add_files(command, options);
  add_sampling(command, options);
  add_force(command, options);
  add_solver(command, options, "--tolerance",
             "Samples solved at once, each on one thread; 0: as many as the\nmachine has (default); under mpirun: "
             "of each rank");
  add_run(command, options, "Go on where the same command was interrupted or killed", "Print a summary as JSON");
}

void check_usage(const WorkspaceOptions& options) {
  check_solver(options);
  check_extension("--output", options.output, {{".csv", ""}});
  check_extension("--cloud", options.cloud, {{".vtu", ""}});
  check_extension("--hull", options.hull, {{".vtu", ""}, {".stl", ""}});
  check_extension("--plot", options.plot, {{".svg", ""}});
  if (options.seed && options.kind() != Sampling::random)
    throw InvalidInput("--seed is the seed of random samples: it needs --sampling random");
}

}  // namespace softkin::cli
