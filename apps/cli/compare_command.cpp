#include <algorithm>
#include <cmath>
#include <memory>
#include <softkin/calibration/path_comparison.hpp>
#include <softkin/calibration/path_tracks.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/runs/page.hpp>
#include <softkin/runs/report_comparison.hpp>

#include "command.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

struct CompareOptions {
  std::vector<std::string> reports, turn, sum;
  std::string marker, plot, by, plane, output, page;
  std::vector<double> poses;    // [degrees]
  std::optional<double> start;  // [s]
  bool align = false, json = false, may_replace = false;

  /// Reports of the same steps side by side, or paths of markers?
  [[nodiscard]] bool of_paths() const {
    const bool requested = align || !sum.empty() || !by.empty() || !plane.empty() || !output.empty() || start;
    return requested || std::any_of(reports.begin(), reports.end(),
                                    [](const std::string& file) { return lower_extension(file) != ".json"; });
  }
  [[nodiscard]] std::vector<Output> outputs() const {
    return requested_outputs({{"--output", output}, {"--plot", plot}, {"--html", page}});
  }
  /// The files themselves, without markers.
  [[nodiscard]] std::vector<std::filesystem::path> inputs() const {
    std::vector<std::filesystem::path> inputs(sum.begin(), sum.end());
    for (const std::string& file : reports) {
      inputs.emplace_back(file);
      inputs.emplace_back(file.substr(0, file.rfind('@')));
    }
    return inputs;
  }
};

/// Writes the page where it is requested; returns the line to print about it.
std::string page_text(const CompareOptions& options, const runs::Comparison& comparison) {
  if (options.page.empty()) return "";
  return runs::write_comparison_page(options.page, comparison, runs::kept_command()) + "\n";
}

int compare_steps(const CompareOptions& options) {
  check_outputs(options.outputs(), options.inputs(), options.may_replace);
  const runs::ReportComparison found =
      runs::compare_reports(options.reports, options.marker, options.turn, options.poses);
  const OutputFolders folders(options.outputs());
  if (!options.plot.empty()) write_svg(options.plot, found.plot());
  std::vector<std::string> heads;
  for (std::size_t p = 0; p < found.paths.size(); ++p)
    heads.push_back(std::to_string(p + 1) + ": " + found.paths[p].method + " (" + found.paths[p].file + ")\n");
  const std::string page =
      page_text(options, {heads, {{"Steps", found.steps()}, {"Time", found.times()}}, found.plot()});
  if (options.json) {
    print(found.json() + "\n");
    return done;
  }
  print(joined(heads, "") + table_text(found.steps()) + "\n" + table_text(found.times()) +
        (options.plot.empty() ? "" : "plot: " + options.plot + "\n") + page);
  return done;
}

int compare_paths(const CompareOptions& options) {
  check_outputs(options.outputs(), options.inputs(), options.may_replace);
  calibration::PathRequest request{options.reports, options.sum, options.marker, options.by, {}, options.start};
  if (!options.plane.empty()) request.plane = calibration::parse_plane(options.plane);
  const calibration::PathReport report =
      calibration::path_report(calibration::read_tracks(request), options.by, options.align);
  const OutputFolders folders(options.outputs());
  if (!options.output.empty()) write_file(options.output, report.errors().csv());
  if (!options.plot.empty()) write_svg(options.plot, report.plot());
  const std::string page = page_text(
      options, {report.heads(), {{"Errors", report.summary()}, {"Waypoints", report.errors()}}, report.plot()});
  if (options.json) {
    print(report.json() + "\n");
    return done;
  }
  const Table waypoints = report.waypoints();
  std::string text = joined(report.heads(), "") + table_text(waypoints);
  if (const std::size_t all = report.tracks[0].points.size(); waypoints.rows.size() < all)
    text += std::to_string(waypoints.rows.size()) + " of " + counted(all, "waypoint") + " shown; all: -o F.csv\n";
  text += "\n" + table_text(report.summary());
  if (!options.output.empty()) text += "errors: " + options.output + "\n";
  if (!options.plot.empty()) text += "plot: " + options.plot + "\n";
  print(text + page);
  return done;
}

void check(const CompareOptions& options) {
  if (options.reports.size() + (options.sum.empty() ? 0 : 1) < 2)
    throw CLI::ValidationError("REPORTS", "give two reports or more");
  if (options.of_paths() && (!options.turn.empty() || !options.poses.empty()))
    throw CLI::ValidationError("--turn", "compares reports of the same steps, not paths");
  if (options.start && !std::isfinite(*options.start)) throw CLI::ValidationError("--start", "must be a time in s");
  if (options.start && !options.by.empty() && options.by != "time")
    throw CLI::ValidationError("--start", "is a time, and --by " + options.by + " compares by something else");
  if (!options.output.empty() && lower_extension(options.output) != ".csv")
    throw CLI::ValidationError("--output", "must end in .csv");
  if (!options.plot.empty() && lower_extension(options.plot) != ".svg")
    throw CLI::ValidationError("--plot", "must end in .svg");
  if (!options.poses.empty() && options.turn.empty())
    throw CLI::ValidationError("--poses", "give --turn too, which says what turns");
}

void add_path_options(CLI::App& command, CompareOptions& options) {
  add_value(command, "--by", options.by, "NAME",
            "Paths: which points belong together: time, waypoint (row by row), arc (fractions of the length), or a "
            "column or actuator that ascends (default: time where both have it, else waypoint where both have "
            "as many, else arc)");
  add_value(command, "--start", options.start, "S",
            "Paths by time: when the first file's clock begins, in that of the tables after it [s], such as the "
            "time in a film at which the robot sets off (default: 0)");
  command.add_flag(
      "--align", options.align,
      "Paths: first turn and move each onto the first, to the least squares (no mirroring); predictions among each "
      "other stay as they are");
  add_value(command, "--plane", options.plane, "AXES",
            "Paths: axes of the robot that the two coordinates of a flat track are, such as xz; x-z: the second "
            "turned round");
  add_value(command, "--sum", options.sum, "F.json",
            "Paths: reports in which one actuator moves each; adds the sum of their displacements for the "
            "commands of the first report among the files");
  add_value(command, "-o,--output", options.output, "F.csv", "Paths: every waypoint with its error");
}

}  // namespace

void add_compare(CLI::App& app, Run& run) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App& command =
      *app.add_subcommand("compare", "Reports of the same steps side by side, or predicted beside measured paths");
  command
      .add_option("REPORTS", options->reports,
                  "Two or more reports of softkin fk --report; the first is the one to compare with. Or paths: reports "
                  "and tracks F.csv (t_s,x_mm,y_mm,z_mm or tip_x_mm, ...; F.csv@tip chooses a marker)")
      ->type_name("F")
      ->required();
  add_value(command, "--marker", options->marker, "NAME",
            "The marker whose distance from that of the first report is shown (default: the first)");
  command
      .add_option("--turn", options->turn,
                  "Two markers: by how much the line from one to the other has turned since the first step [degrees]")
      ->type_name("FROM TO")
      ->expected(2);
  add_value(command, "--poses", options->poses, "DEGREES",
            "With --turn: the time until each of these turns is reached [degrees]",
            CLI::PositiveNumber.description(""));
  add_value(command, "--plot", options->plot, "F.svg",
            "Turns, distances and loads over the steps, and the marker's trajectory in each report");
  add_page(command, options->page, "The comparison as a page for a browser, one file that needs no network");
  add_path_options(command, *options);
  add_overwriting(command, options->may_replace);
  command.add_flag("--json", options->json, "Print JSON; its keys name the units");
  command.footer(
      "Times are sums over the steps of a report, so they are those of a path that begins at rest. Exit code: 0 done, "
      "2 bad usage or bad input.\nExample:\n  softkin compare physical.json target.json --turn tip end --poses 90 180\n"
      "  softkin compare camera.csv predicted.json --marker tip --plane xz --align --plot errors.svg");
  command.callback([&run, options] {
    check(*options);
    run = [options] { return options->of_paths() ? compare_paths(*options) : compare_steps(*options); };
  });
}

}  // namespace softkin::cli
