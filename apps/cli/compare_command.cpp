#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <memory>
#include <softkin/io/svg_plot.hpp>
#include <softkin/io/text_mesh_tools.hpp>

#include "command.hpp"
#include "compare_table.hpp"
#include "mesh_text.hpp"
#include "output_files.hpp"

namespace softkin::cli {

namespace {

struct CompareOptions {
  std::vector<std::string> reports, turn;
  std::string marker, plot;
  std::vector<double> poses;  // [degrees]
  bool json = false;
};

int compare(const CompareOptions& options) {
  std::vector<ReportedPath> paths;
  for (const std::string& file : options.reports) {
    paths.push_back(read_reported_path(file));
    check_same_steps(paths.front(), paths.back());
  }
  const std::vector<Output> outputs =
      options.plot.empty() ? std::vector<Output>() : std::vector<Output>{{"--plot", options.plot}};
  check_outputs(outputs, {options.reports.begin(), options.reports.end()});
  const Comparison comparison(std::move(paths), options.marker, options.turn, options.poses);
  const OutputFolders folders(outputs);
  if (!options.plot.empty()) write_svg(options.plot, comparison.plot());
  if (options.json)
    print(comparison.json());
  else
    print(comparison.text() + (options.plot.empty() ? "" : "plot: " + options.plot + "\n"));
  return done;
}

void check(const CompareOptions& options) {
  if (options.reports.size() < 2) throw CLI::ValidationError("REPORTS", "give two reports or more");
  if (!options.plot.empty() && lower_extension(options.plot) != ".svg")
    throw CLI::ValidationError("--plot", "must end in .svg");
  if (!options.poses.empty() && options.turn.empty())
    throw CLI::ValidationError("--poses", "give --turn too, which says what turns");
}

}  // namespace

void add_compare(CLI::App& app, Run& run) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App& command =
      *app.add_subcommand("compare", "Reports of the same steps side by side: distances, turns, loads, times");
  command
      .add_option("REPORTS", options->reports,
                  "Two or more reports of softkin fk --report; the first is the one to compare with")
      ->type_name("F.json")
      ->required();
  command
      .add_option("--marker", options->marker,
                  "The marker whose distance from that of the first report is shown (default: the first)")
      ->type_name("NAME");
  command
      .add_option("--turn", options->turn,
                  "Two markers: by how much the line from one to the other has turned since the first step [degrees]")
      ->type_name("FROM TO")
      ->expected(2);
  command.add_option("--poses", options->poses, "With --turn: the time until each of these turns is reached [degrees]")
      ->type_name("DEGREES")
      ->check(CLI::PositiveNumber.description(""));
  command
      .add_option("--plot", options->plot,
                  "Turns, distances and loads over the steps, and the marker's way by each report")
      ->type_name("F.svg");
  command.add_flag("--json", options->json, "Print JSON; its keys name the units");
  command.footer(
      "Times are sums over the steps of a report, so they are those of a path that begins at rest. Exit code: 0 done, "
      "2 bad usage or bad input.\nExample:\n  softkin compare physical.json target.json --turn tip end --poses 90 180");
  command.callback([&run, options] {
    check(*options);
    run = [options] { return compare(*options); };
  });
}

}  // namespace softkin::cli
