#include "follow_files.hpp"

#include "fk_units.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

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
    std::string row = has_times(path) ? exact(*path.waypoints[i].time) : "";
    for (const double value : done[i].actuation) row += (row.empty() ? "" : ",") + exact(value);
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
    if (asked.time) text += "," + exact(*asked.time);
    for (std::size_t m = 0; m < path.markers.size(); ++m) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (path.axes[m][axis]) text += "," + exact(asked.targets[m][static_cast<Index>(axis)]);
      for (const double x : done[i].markers[m]) text += "," + exact(x);
    }
    text += "," + exact(done[i].error_mm) + "," + (done[i].reached ? "1" : "0") + "," + (asked.inserted ? "1" : "0") +
            "," + std::to_string(done[i].equilibria) + "\n";
  }
  return text;
}

}  // namespace softkin::cli
