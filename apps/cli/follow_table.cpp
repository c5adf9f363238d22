#include "follow_table.hpp"

#include <algorithm>
#include <cmath>

#include "fk_table.hpp"
#include "fk_units.hpp"
#include "mesh_text.hpp"

namespace softkin::cli {

FollowTable::FollowTable(const Model& model, const MarkerPath& path) {
  columns_.add("waypoint", std::to_string(path.waypoints.size()).size());
  for (const Actuator& actuator : model.actuators) columns_.add_command(actuator);
  columns_.add("error [mm]", 10);
  columns_.add("equilibria", 10);
  columns_.add("time [s]", 8);
}

std::string FollowTable::header() const {
  return columns_.header() + "status";
}

std::string FollowTable::row(std::size_t waypoint, const DoneWaypoint& done) const {
  std::vector<std::string> cells{std::to_string(waypoint)};
  for (const double value : done.actuation) cells.push_back(Columns::command(value));
  cells.push_back(number(done.error_mm, 2));
  cells.push_back(std::to_string(done.equilibria));
  cells.push_back(decimal(done.seconds, 2));
  return columns_.row(cells) + done.status;
}

FollowProgress::FollowProgress(std::size_t first, std::size_t waypoints)
    : first_(first), waypoints_(waypoints), start_(seconds_now()) {}

void FollowProgress::show(std::size_t waypoint, const Progress& p) {
  const double done = static_cast<double>(waypoint - first_), all = static_cast<double>(waypoints_ - first_);
  const double elapsed = seconds_now() - start_;
  std::string text = std::to_string(waypoint) + "/" + std::to_string(waypoints_) + " waypoints, " + duration(elapsed);
  if (done > 0) text += ", " + duration(elapsed * (all - done) / done) + " left";
  text += ", " + counted(static_cast<std::size_t>(std::max(0, p.iteration)), "equilibrium", "equilibria");
  if (std::isfinite(p.step_mm)) text += ", " + number(p.step_mm, 2) + " mm off";
  line_.show(static_cast<double>(waypoint) / static_cast<double>(waypoints_), text);
}

std::string summary_of(const std::vector<DoneWaypoint>& done, double tolerance_mm) {
  double worst = 0, errors = 0, equilibria = 0, seconds = 0;
  std::size_t reached = 0;
  for (const DoneWaypoint& each : done) {
    equilibria += each.equilibria;
    seconds += each.seconds;
    if (!each.reached) continue;
    ++reached;
    worst = std::max(worst, each.error_mm);
    errors += each.error_mm;
  }
  const auto count = static_cast<double>(done.size());
  std::string text =
      counted(done.size(), "waypoint") + ", " + std::to_string(reached) + " reached to " + number(tolerance_mm) + " mm";
  if (reached > 0)
    text += ": error at most " + number(worst, 2) + " mm, " + number(errors / static_cast<double>(reached), 2) +
            " mm in the mean";
  return text + "; " + decimal(equilibria / count, 2) + " equilibria per waypoint, " + decimal(seconds, 2) + " s";
}

std::string missed_text(const std::vector<DoneWaypoint>& done) {
  std::vector<std::size_t> missed, lost;
  double worst = 0;
  for (std::size_t i = 0; i < done.size(); ++i) {
    if (done[i].reached) continue;
    (done[i].status == "not converged" ? lost : missed).push_back(i);
    worst = std::max(worst, done[i].error_mm);
  }
  std::string text;
  const auto tell = [&text](const std::vector<std::size_t>& numbers, const std::string& what) {
    if (numbers.empty()) return;
    text += (text.empty() ? "" : "; ") + std::string(numbers.size() == 1 ? "waypoint " : "waypoints ") +
            list_text(numbers) + (numbers.size() == 1 ? " was " : " were ") + what;
  };
  tell(missed, "not reached: the marker stands at the nearest point that the ranges allow");
  tell(lost, "not reached, and the search for a nearer point did not converge");
  if (!text.empty()) text += "; at most " + number(worst, 3) + " mm off";
  return text;
}

}  // namespace softkin::cli
