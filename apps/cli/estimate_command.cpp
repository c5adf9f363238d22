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
struct EstimateRequest : SolveOptions {
  std::string readings_file, report, table, map;
  EstimateOptions estimate;
  std::optional<int> plan;
  bool json = false, may_replace = false;
};

void check_map(const EstimateRequest& requested) {
  if (requested.map.empty()) return;
  const SolveOptions usual;
  const bool changed = requested.solver_name != usual.solver_name || requested.tolerance_mm != usual.tolerance_mm ||
                       requested.max_iterations != usual.max_iterations || requested.stable || requested.instant ||
                       !requested.tuning_file.empty();
  if (requested.plan || requested.estimate.fade_s > 0 || requested.estimate.keep_all || changed)
    throw InvalidInput(
        "a map estimates each row by itself, leaves no reading out and plans none: --map goes without --plan, --fade, "
        "--keep-all and the solver's options");
}

int run_estimate(const EstimateRequest& requested) {
  check_extension("--report", requested.report, {{".json", ""}});
  check_extension("--table", requested.table, {{".csv", ""}});
  check_solver(requested);
  check_map(requested);
  const std::vector<EstimatedUnknown> unknowns = requested.estimate.requested_unknowns();
  std::vector<fs::path> inputs{requested.scene, requested.readings_file};
  if (!requested.map.empty()) inputs.emplace_back(requested.map);
  const Model model = requested_robot(requested, inputs);
  const std::vector<Output> outputs = requested_outputs({{"--report", requested.report}, {"--table", requested.table}});
  check_outputs(outputs, inputs, requested.may_replace);
  const OutputFolders folders(outputs);
  const MeasuredPoses poses = read_measured_poses(requested.readings_file, model);
  const std::array<double, readings> deviations = requested.estimate.requested_deviations();
  const EstimatorOptions how = requested.estimate.how(requested.statics());
  catch_interrupt();
  ProgressLine line;
  std::size_t done_rows = 0;
  runs::EstimatePlanner planner(model, poses, deviations, requested.plan.value_or(1));
  const auto row = [&](std::size_t number, const Estimate& reported) {
    done_rows = number + 1;
    if (requested.plan) planner.add(reported);
  };
  const runs::RequestedEstimates what{model, poses, unknowns, deviations, deviation_names()};
  runs::EstimateReport report =
      requested.map.empty()
          ? runs::estimate_poses(
                what, how, row,
                [&](const Progress&) {
                  line.show(static_cast<double>(done_rows) / static_cast<double>(poses.commands.size()),
                            "row " + std::to_string(done_rows + 1) + " of " + std::to_string(poses.commands.size()));
                  return !interrupted();
                })
          : runs::estimate_poses_by_map(runs::read_map_of(model, requested.map), what, row);
  line.clear();
  report.planned = requested.plan.has_value();
  if (report.planned) report.plan = planner.plan();
  if (!requested.report.empty()) write_file(requested.report, runs::estimate_json(report));
  if (!requested.table.empty()) write_file(requested.table, runs::estimate_table(report).csv());
  for (std::size_t r = 0; r < report.reported.size() && !requested.json; ++r) print(runs::estimate_row_text(report, r));
  print(requested.json ? runs::estimate_json(report)
                       : runs::estimate_text(report) + runs::plan_text(report) +
                             written_text({{"report", requested.report}, {"table", requested.table}}));
  return report.good() ? done : not_converged;
}

void add_options(CLI::App& command, EstimateRequest& requested) {
  add_scene(command, requested);
  add_force(command, requested);
  add_value(command, "READINGS", requested.readings_file, "F.csv",
            "Readings, a row each: measured commands as in a path (air_kPa),\nt_s, then what was read: tip_x_mm, "
            "air_volume_mm3, tendon_tension_N,\nbase_force_x_N, strain_length_mm, bend_angle_deg,\nimu_direction_x; "
            "empty cells were not read")
      ->required();
  add_unknowns(command, requested.estimate)->required();
  add_deviations(command, requested.estimate.deviations);
  add_fade(command, requested.estimate, "rows go on\nfrom each other (default: each by itself)");
  add_value(
      command, "--map", requested.map, "F.skmap",
      "Kinematic map of the robot (softkin map) whose inputs are the\nunknowns: estimates in place of the solver, in "
      "microseconds a row");
  add_value(command, "--plan", requested.plan, "N",
            "Say which N further markers on the surface, or markers, sensors,\nlengths and volumes of the scene whose "
            "deviation is given, would\ntell most, one after the other, over all rows",
            CLI::Range(1, 100).description(""));
  add_value(command, "--report", requested.report, "F.json", "All estimates, as JSON");
  add_value(command, "--table", requested.table, "F.csv", "A line for each row");
  add_solver(command, requested);
  add_overwriting(command, requested.may_replace);
  command.add_flag("--json", requested.json, "Print JSON; its keys name the units");
}

}  // namespace

void add_estimate(CLI::App& app, Run& run) {
  add_command<EstimateRequest>(
      app, run, "estimate", "Estimate external forces, their places and the shape from a few readings",
      "Each number with its standard deviation, and in words what the readings do not determine. Exit code: 0 done, 1 "
      "a "
      "row\n"
      "that does not converge or fit the model, or interrupted, 2 bad usage or bad input.\nExample:\n"
      "  softkin estimate examples/estimate/finger.yaml examples/estimate/readings.csv --unknown touch:place "
      "--deviation 0.2",
      add_options, run_estimate);
}

}  // namespace softkin::cli
