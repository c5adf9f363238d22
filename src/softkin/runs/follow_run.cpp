#include <algorithm>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/runs/follow_run.hpp>
#include <softkin/runs/plots.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/run_tables.hpp>
#include <sstream>

namespace softkin::runs {

bool FollowFolder::has_written_commands() const {
  try {
    const Json report = parse_json(read_file(run().report));
    std::istringstream lines(read_file(commands()));
    std::string line;
    std::getline(lines, line);  // the header
    for (const Json& step : report.at("steps")) {
      std::string values;
      for (const Json& value : step.at("actuation")) values += "," + exact(value.get<double>());
      if (!std::getline(lines, line) || !("," + line).ends_with(values)) return false;
    }
    return !std::getline(lines, line);
  } catch (const InvalidInput&) {
  } catch (const Json::exception&) {
  }
  return false;
}

FollowRun::FollowRun(const Statics& statics, FollowTask task, const TrajectoryOptions& options, FollowFolder folder)
    : model_(statics.model()),
      task_(std::move(task)),
      tolerance_mm_(options.inverse.tolerance_mm),
      folder_(std::move(folder)),
      job_(statics, task_.path, task_.file, options),
      run_(model_, job_, folder_.run(), follow_head(model_, task_.scene, options, task_.map), {"follow"}) {}

Table FollowRun::commands() {
  return commands_table(model_, task_.path, records());
}

Table FollowRun::errors() {
  return errors_table(model_, task_.path, records());
}

Plot FollowRun::plot() {
  return plot_of_path(model_, task_.path, records(), tolerance_mm_, plot_title(model_, task_.scene, task_.file),
                      task_.line);
}

void FollowRun::finish() {
  if (run_.done() == 0) return;
  run_.finish();
  if (!folder_.commands().empty()) write_file(folder_.commands(), commands().csv());
  if (!folder_.errors().empty()) write_file(folder_.errors(), errors().csv());
  if (!folder_.plot().empty()) write_svg(folder_.plot(), plot());
}

std::string summary_of(const std::vector<WaypointRecord>& done, double tolerance_mm, bool nearest) {
  double worst = 0, errors = 0, equilibria = 0, seconds = 0;
  std::size_t reached = 0;
  for (const WaypointRecord& each : done) {
    equilibria += each.equilibria;
    seconds += each.seconds;
    if (nearest ? each.end == InverseStatus::not_converged : !each.is_reached()) continue;
    ++reached;
    worst = std::max(worst, each.error_mm);
    errors += each.error_mm;
  }
  std::string text = counted(done.size(), "waypoint") + ", " + std::to_string(reached) +
                     (nearest ? " at their nearest samples" : " reached to " + number(tolerance_mm) + " mm");
  if (reached > 0)
    text += ": error at most " + number(worst, 2) + " mm, " + number(errors / static_cast<double>(reached), 2) +
            " mm in the mean";
  return text + "; " + decimal(equilibria / static_cast<double>(done.size()), 2) + " equilibria per waypoint, " +
         decimal(seconds, 2) + " s";
}

std::string jumps_of(const std::vector<WaypointRecord>& done) {
  double change = 0, step = 0;
  for (const WaypointRecord& each : done) {
    change = std::max(change, each.command_change);
    step = std::max(step, each.step_mm);
  }
  return "from waypoint to waypoint commands change by at most " + number(100 * change, 3) +
         " % of a range, the marker moves by at most " + number(step, 3) + " mm";
}

std::string missed_text(const std::vector<WaypointRecord>& done, bool nearest) {
  std::vector<std::size_t> missed, lost;
  double worst = 0;
  for (std::size_t i = 0; i < done.size(); ++i) {
    if (done[i].is_reached()) continue;
    (done[i].end == InverseStatus::not_converged ? lost : missed).push_back(i);
    worst = std::max(worst, done[i].error_mm);
  }
  std::string text;
  const auto describe = [&text](const std::vector<std::size_t>& numbers, const std::string& what) {
    if (numbers.empty()) return;
    text += (text.empty() ? "" : "; ") + std::string(numbers.size() == 1 ? "waypoint " : "waypoints ") +
            list_text(numbers) + (numbers.size() == 1 ? " was " : " were ") + what;
  };
  describe(missed, nearest ? "not reached: the commands are those of the nearest sample"
                           : "not reached: the marker stands at the nearest point that the ranges allow");
  describe(lost, nearest ? "not reached: the nearest sample has no equilibrium from the waypoint before, nor from rest"
                         : "not reached, and the search for a nearer point did not converge");
  if (!text.empty()) text += "; at most " + number(worst, 3) + " mm off";
  return text;
}

}  // namespace softkin::runs
