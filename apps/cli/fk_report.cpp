#include "fk_report.hpp"

#include <algorithm>
#include <cstdio>
#include <softkin/statics/measure.hpp>

#include "terminal.hpp"

namespace softkin::cli {

using Json = nlohmann::ordered_json;

namespace {

const char* name_of(Status status) {
  switch (status) {
    case Status::converged:
      return "converged";
    case Status::interrupted:
      return "interrupted";
    default:
      return "not converged";
  }
}

std::string cell(const std::string& text, std::size_t width) {
  return std::string(text.size() < width ? width - text.size() : 0, ' ') + text + "  ";
}

std::string fixed(double value, int decimals) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string grouped(std::size_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

Json strain_json(const StrainHistogram& histogram) {
  Json json = {{"least", histogram.least},
               {"greatest", histogram.greatest},
               {"magnitude_percentile_95", histogram.percentile_95},
               {"bin_edges", histogram.edges},
               {"volume_shares", histogram.shares},
               {"beyond_linear_range", Json::array()}};
  for (const auto& beyond : histogram.beyond)
    json["beyond_linear_range"].push_back(
        {{"region", beyond.region}, {"linear_range", beyond.linear_range}, {"volume_share", beyond.share}});
  return json;
}

/// Every iteration up to 100, then ever sparser: a curve stays a curve and a report stays small.
Json history_json(const std::vector<IterationRecord>& history) {
  Json json = {
      {"iteration", Json::array()}, {"energy", Json::array()}, {"step_mm", Json::array()}, {"residual", Json::array()}};
  for (std::size_t i = 0; i < history.size(); i += std::max<std::size_t>(1, i / 100)) {
    json["iteration"].push_back(i + 1);
    json["energy"].push_back(history[i].energy);
    json["step_mm"].push_back(history[i].step_mm);
    json["residual"].push_back(history[i].gradient_norm);
  }
  return json;
}

}  // namespace

Json step_json(const Model& model, const Equilibrium& equilibrium) {
  const SolveReport& report = equilibrium.report;
  const Points& positions = equilibrium.state.positions;
  Json step = {{"actuation", Json::object()},
               {"status", name_of(report.status)},
               {"iterations", report.iterations},
               {"residual", report.gradient_norm},
               {"step_mm", report.step_mm},
               {"tolerance_mm", report.tolerance_mm},
               {"estimated_error_mm", report.estimated_error_mm},
               {"seconds", report.seconds},
               {"energy", report.energy}};
  const ElementDeformation deformation = deformation_of(model, positions);
  step["inverted_elements"] =
      std::count_if(deformation.volume_ratio.begin(), deformation.volume_ratio.end(), [](double j) { return j <= 0; });
  step["markers"] = Json::object();
  for (const Marker& marker : model.markers) {
    const Vec3 p = marker.point.at(positions);
    step["markers"][marker.name] = {p.x(), p.y(), p.z()};
  }
  step["actuators"] = Json::object();
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const double requested = equilibrium.actuation[static_cast<Index>(a)];
    step["actuation"][model.actuators[a].name] = requested;
    step["actuators"][model.actuators[a].name] = {{"requested", requested},
                                                  {"achieved", achieved_ratio(model, model.actuators[a], positions)}};
  }
  step["strain"] = strain_json(strain_histogram(model, deformation));
  step["history"] = history_json(report.history);
  return step;
}

Json report_json(const Model& model, const std::string& scene) {
  return {{"softkin", SOFTKIN_VERSION},
          {"scene", scene},
          {"formulation", "target-shape"},
          {"units", {{"markers", "mm"}, {"actuators", "ratio to rest"}, {"energy", "mm^5"}, {"residual", "mm^4"}}},
          {"mesh",
           {{"vertices", model.rest.rows()}, {"tetrahedra", model.tetrahedra.size()}, {"prisms", model.prisms.size()}}},
          {"notes", model.notes},
          {"steps", Json::array()},
          {"seconds", 0.0}};
}

std::string table_header(const Model& model) {
  std::string line = "step  ";
  for (const Actuator& actuator : model.actuators) line += cell(actuator.name + " [-]", 8) + cell("achieved", 8);
  for (const Marker& marker : model.markers) line += cell(marker.name + " x, y, z [mm]", 26);
  return line + cell("iterations", 10) + cell("[s]", 7) + "status";
}

std::string table_row(const Model& model, std::size_t step, const Json& json) {
  std::string line = cell(std::to_string(step), 4);
  for (const Actuator& actuator : model.actuators) {
    const Json& values = json["actuators"][actuator.name];
    line += cell(fixed(values["requested"].get<double>(), 4), std::max<std::size_t>(8, actuator.name.size() + 4)) +
            cell(fixed(values["achieved"].get<double>(), 4), 8);
  }
  for (const Marker& marker : model.markers) {
    std::string point;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string value = fixed(json["markers"][marker.name][axis].get<double>(), 3);
      point += std::string(value.size() < 8 ? 8 - value.size() : 0, ' ') + value + (axis < 2 ? " " : "");
    }
    line += cell(point, std::max<std::size_t>(26, marker.name.size() + 13));
  }
  return line + cell(std::to_string(json["iterations"].get<int>()), 10) +
         cell(fixed(json["seconds"].get<double>(), 2), 7) + json["status"].get<std::string>();
}

std::string summary(const Model& model) {
  std::string text = grouped(static_cast<std::size_t>(model.rest.rows())) + " vertices";
  if (!model.tetrahedra.empty()) text += ", " + grouped(model.tetrahedra.size()) + " tetrahedra";
  if (!model.prisms.empty()) text += ", " + grouped(model.prisms.size()) + " prisms";
  for (const Actuator& a : model.actuators) {
    const char* kind = a.kind == ActuatorKind::cable ? "cable" : a.kind == ActuatorKind::dea ? "dea" : "pneumatic";
    const char* unit = a.kind == ActuatorKind::cable ? "mm" : a.kind == ActuatorKind::dea ? "mm^2" : "mm^3";
    text += "\nactuator " + a.name + ": " + kind + ", " + number(a.rest_measure) + " " + unit + " at rest, ratio " +
            number(a.low) + " to " + number(a.high);
  }
  for (const std::string& note : model.notes) text += "\nnote: " + note;
  return text;
}

std::string findings(const Json& step) {
  const Json& strain = step["strain"];
  const auto percent = [](const Json& value) { return fixed(100 * value.get<double>(), 1) + " %"; };
  std::string text = "principal strain of the body: " + percent(strain["least"]) + " to " +
                     percent(strain["greatest"]) + ", 95 % of the volume within " +
                     percent(strain["magnitude_percentile_95"]);
  for (const Json& beyond : strain["beyond_linear_range"])
    text += "\n" + percent(beyond["volume_share"]) + " of region '" + beyond["region"].get<std::string>() +
            "' is strained beyond its linear range of " + percent(beyond["linear_range"]);
  if (const auto inverted = step["inverted_elements"].get<Index>(); inverted > 0)
    text += "\nwarning: " + std::to_string(inverted) + " elements are inverted";
  text += "\nlast step of the iteration " + number(step["step_mm"].get<double>(), 2) +
          " mm; estimated distance from the " + "equilibrium " + number(step["estimated_error_mm"].get<double>(), 2) +
          " mm";
  return text;
}

}  // namespace softkin::cli
