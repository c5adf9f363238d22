#include "follow_waypoint.hpp"

#include <utility>

#include "ik_report.hpp"
#include "mesh_text.hpp"

namespace softkin::cli {

namespace {

const std::string& marker_name(const Model& model, const MarkerPath& path, std::size_t m) {
  return model.markers[static_cast<std::size_t>(path.markers[m])].name;
}

}  // namespace

Json asked_json(const Model& model, const MarkerPath& path, std::size_t waypoint) {
  const Waypoint& asked = path.waypoints[waypoint];
  Json json = {{"inserted", asked.inserted}, {"targets", Json::object()}};
  if (asked.time) json["time_s"] = *asked.time;
  for (std::size_t m = 0; m < path.markers.size(); ++m) {
    Json& target = json["targets"][marker_name(model, path, m)] = Json::array();
    for (std::size_t axis = 0; axis < 3; ++axis)
      target.push_back(path.axes[m][axis] ? Json(asked.targets[m][static_cast<Index>(axis)]) : Json());
  }
  return json;
}

Json waypoint_json(const Model& model, const MarkerPath& path, std::size_t waypoint, const InverseResult& found,
                   const ElementDeformation& deformation) {
  Json step = step_json(model, found.equilibrium, deformation);
  step["seconds"] = found.seconds;
  if (const auto& time = path.waypoints[waypoint].time) step["time_s"] = *time;
  step["waypoint"] = asked_json(model, path, waypoint);
  Json& json = step["waypoint"];
  json["status"] = name_of(found.status);
  json["reached"] = found.status == InverseStatus::reached;
  json["error_mm"] = found.errors_mm.maxCoeff();
  json["equilibria"] = found.equilibria;
  json["remark"] = found.remark;
  return step;
}

DoneWaypoint done_waypoint(const Model& model, const MarkerPath& path, const Json& step) {
  const Json& json = step.at("waypoint");
  DoneWaypoint done;
  done.reached = json.at("reached").get<bool>();
  done.status = json.at("status").get<std::string>();
  done.error_mm = json.at("error_mm").get<double>();
  done.equilibria = json.at("equilibria").get<int>();
  done.seconds = step.at("seconds").get<double>();
  done.actuation.resize(static_cast<Index>(model.actuators.size()));
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    done.actuation[static_cast<Index>(a)] = step.at("actuation").at(model.actuators[a].name).get<double>();
  for (std::size_t m = 0; m < path.markers.size(); ++m) {
    const Json& p = step.at("markers").at(marker_name(model, path, m));
    done.markers.emplace_back(p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>());
  }
  return done;
}

}  // namespace softkin::cli
