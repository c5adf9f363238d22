#include "follow_files.hpp"

#include "fk_units.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr int exact = 17;  // digits from which a number reads back as it was
constexpr const char* axis_names[] = {"x", "y", "z"};

bool has_times(const MarkerPath& path) {
  return path.waypoints.front().time.has_value();
}

}  // namespace

std::string commands_csv(const Model& model, const MarkerPath& path, const std::vector<DoneWaypoint>& done) {
  std::string text = has_times(path) ? "t_s" : "";
  for (const Actuator& actuator : model.actuators) {
    const std::string unit = command_unit(actuator);
    text += (text.empty() ? "" : ",") + actuator.name + (unit.empty() ? "" : "_" + unit);
  }
  text += "\n";
  for (std::size_t i = 0; i < done.size(); ++i) {
    std::string row = has_times(path) ? number(*path.waypoints[i].time, exact) : "";
    for (const double value : done[i].actuation) row += (row.empty() ? "" : ",") + number(value, exact);
    text += row + "\n";
  }
  return text;
}

std::string errors_csv(const Model& model, const MarkerPath& path, const std::vector<DoneWaypoint>& done) {
  std::string text = has_times(path) ? "waypoint,t_s" : "waypoint";
  for (std::size_t m = 0; m < path.markers.size(); ++m) {
    const std::string& name = model.markers[static_cast<std::size_t>(path.markers[m])].name;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (path.axes[m][axis]) text += "," + name + "_target_" + axis_names[axis] + "_mm";
    for (const char* axis : axis_names) text += "," + name + "_" + axis + "_mm";
  }
  text += ",error_mm,reached,inserted,equilibria\n";
  for (std::size_t i = 0; i < done.size(); ++i) {
    const Waypoint& asked = path.waypoints[i];
    text += std::to_string(i);
    if (asked.time) text += "," + number(*asked.time, exact);
    for (std::size_t m = 0; m < path.markers.size(); ++m) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (path.axes[m][axis]) text += "," + number(asked.targets[m][static_cast<Index>(axis)], exact);
      for (const double x : done[i].markers[m]) text += "," + number(x, exact);
    }
    text += "," + number(done[i].error_mm, exact) + "," + (done[i].reached ? "1" : "0") + "," +
            (asked.inserted ? "1" : "0") + "," + std::to_string(done[i].equilibria) + "\n";
  }
  return text;
}

}  // namespace softkin::cli
