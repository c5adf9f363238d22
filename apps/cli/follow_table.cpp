#include "follow_table.hpp"

#include <algorithm>
#include <cmath>

#include "fk_table.hpp"
#include "fk_units.hpp"
#include "mesh_text.hpp"

namespace softkin::cli {

namespace {

constexpr int value_decimals = 4;
constexpr std::size_t longest_name = 16;

std::string right(const std::string& text, std::size_t width) {
  const std::size_t length = characters(text);
  return length < width ? std::string(width - length, ' ') + text : text;
}

}  // namespace

FollowTable::FollowTable(const Model& model, const MarkerPath& path) {
  const auto add = [this](const std::string& header, std::size_t width) {
    headers_.push_back(header);
    widths_.push_back(std::max(width, characters(header)));
  };
  add("waypoint", std::to_string(path.waypoints.size()).size());
  for (const Actuator& actuator : model.actuators) {
    const std::string name = characters(actuator.name) > longest_name ? "command" : actuator.name;
    add(name + " " + bracketed_unit(actuator),
        std::max(decimal(actuator.high, value_decimals).size(), decimal(actuator.low, value_decimals).size()));
  }
  add("error [mm]", 10);
  add("equilibria", 10);
  add("time [s]", 8);
}

std::string FollowTable::header() const {
  std::string line;
  for (std::size_t i = 0; i < headers_.size(); ++i) line += right(headers_[i], widths_[i]) + "  ";
  return line + "status";
}

std::string FollowTable::row(std::size_t waypoint, const DoneWaypoint& done) const {
  std::vector<std::string> cells{std::to_string(waypoint)};
  for (const double value : done.actuation) cells.push_back(decimal(value, value_decimals));
  cells.push_back(number(done.error_mm, 2));
  cells.push_back(std::to_string(done.equilibria));
  cells.push_back(decimal(done.seconds, 2));
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) line += right(cells[i], widths_[i]) + "  ";
  return line + done.status;
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
