#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/io/table/measured_poses.hpp>
#include <softkin/runs/answers.hpp>
#include <softkin/runs/estimate_plan.hpp>
#include <softkin/runs/map_estimates.hpp>

#include "command.hpp"
#include "estimate_options.hpp"
#include "run_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

/// What the user asks of `softkin estimate`.
struct EstimateAsked : SolveOptions {
  std::string readings_file, report, table, map;
  EstimateOptions estimate;
  std::optional<int> plan;
  bool json = false, may_replace = false;
};

void check_map(const EstimateAsked& asked) {
  if (asked.map.empty()) return;
  const SolveOptions usual;
  const bool changed = asked.solver_name != usual.solver_name || asked.tolerance_mm != usual.tolerance_mm ||
                       asked.max_iterations != usual.max_iterations || asked.stable || asked.instant;
  if (asked.plan || asked.estimate.fade_s > 0 || asked.estimate.keep_all || changed)
    throw InvalidInput(
        "a map tells each row by itself, leaves no reading out and plans none: --map goes without --plan, --fade, "
        "--keep-all and the solver's options");
}

int run_estimate(const EstimateAsked& asked) {
  check_extension("--report", asked.report, {{".json", ""}});
  check_extension("--table", asked.table, {{".csv", ""}});
  check_solver(asked);
  check_map(asked);
  const std::vector<EstimatedUnknown> unknowns = asked.estimate.asked_unknowns();
  std::vector<fs::path> inputs{asked.scene, asked.readings_file};
  if (!asked.map.empty()) inputs.emplace_back(asked.map);
  const Model model = asked_robot(asked, inputs);
  const std::vector<Output> outputs = asked_outputs({{"--report", asked.report}, {"--table", asked.table}});
  check_outputs(outputs, inputs, asked.may_replace);
  const OutputFolders folders(outputs);
  const MeasuredPoses poses = read_measured_poses(asked.readings_file, model);
  const std::array<double, readings> deviations = asked.estimate.asked_deviations();
  const EstimatorOptions how = asked.estimate.how(asked.statics());
  catch_interrupt();
  ProgressLine line;
  std::size_t done_rows = 0;
  runs::EstimatePlanner planner(model, poses, deviations, asked.plan.value_or(1));
  const auto row = [&](std::size_t number, const Estimate& told) {
    done_rows = number + 1;
    if (asked.plan) planner.add(told);
  };
  const runs::AskedEstimates what{model, poses, unknowns, deviations, deviation_names()};
  runs::EstimateReport report =
      asked.map.empty()
          ? runs::estimate_poses(
                what, how, row,
                [&](const Progress&) {
                  line.show(static_cast<double>(done_rows) / static_cast<double>(poses.commands.size()),
                            "row " + std::to_string(done_rows + 1) + " of " + std::to_string(poses.commands.size()));
                  return !interrupted();
                })
          : runs::estimate_poses_by_map(runs::read_map_of(model, asked.map), what, row);
  line.clear();
  report.planned = asked.plan.has_value();
  if (report.planned) report.plan = planner.plan();
  if (!asked.report.empty()) write_file(asked.report, runs::estimate_json(report));
  if (!asked.table.empty()) write_file(asked.table, runs::estimate_table(report).csv());
  for (std::size_t r = 0; r < report.told.size() && !asked.json; ++r) print(runs::estimate_row_text(report, r));
  print(asked.json ? runs::estimate_json(report)
                   : runs::estimate_text(report) + runs::plan_text(report) +
                         written_text({{"report", asked.report}, {"table", asked.table}}));
  return report.good() ? done : not_converged;
}

void add_options(CLI::App& command, EstimateAsked& asked) {
  add_scene(command, asked);
  add_force(command, asked);
  add_value(command, "READINGS", asked.readings_file, "F.csv",
            "Readings, a row each: measured commands as in a path (air_kPa),\nt_s, then what was read: tip_x_mm, "
            "air_volume_mm3, tendon_tension_N,\nbase_force_x_N, strain_length_mm, bend_angle_deg,\nimu_direction_x; "
            "empty cells were not read")
      ->required();
  add_unknowns(command, asked.estimate)->required();
  add_deviations(command, asked.estimate.deviations);
  add_fade(command, asked.estimate, "rows go on\nfrom each other (default: each by itself)");
  add_value(command, "--map", asked.map, "F.skmap",
            "Kinematic map of the robot (softkin map) whose inputs are the\nunknowns: tells in its place, in "
            "microseconds a row");
  add_value(command, "--plan", asked.plan, "N",
            "Say which N further markers on the surface, or markers, sensors,\nlengths and volumes of the scene whose "
            "deviation is given, would\ntell most, one after the other, over all rows",
            CLI::Range(1, 100).description(""));
  add_value(command, "--report", asked.report, "F.json", "All that is told, as JSON");
  add_value(command, "--table", asked.table, "F.csv", "A line for each row");
  add_solver(command, asked);
  add_overwriting(command, asked.may_replace);
  command.add_flag("--json", asked.json, "Print JSON; its keys name the units");
}

}  // namespace

void add_estimate(CLI::App& app, Run& run) {
  add_command<EstimateAsked>(
      app, run, "estimate", "What pushes a robot, where, and its shape, from a few readings",
      "Each number with its standard deviation, and in words what the readings do not tell. Exit code: 0 done, 1 a "
      "row\n"
      "that does not converge or fit the model, or interrupted, 2 bad usage or bad input.\nExample:\n"
      "  softkin estimate examples/estimate/finger.yaml examples/estimate/readings.csv --unknown touch:place "
      "--deviation 0.2",
      add_options, run_estimate);
}

}  // namespace softkin::cli
