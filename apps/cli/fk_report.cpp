#include "fk_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <softkin/model/curve_command.hpp>
#include <utility>

#include "curve_settings.hpp"
#include "fk_fingerprint.hpp"
#include "fk_units.hpp"

namespace softkin::cli {

using Json = Report::Json;

namespace {

constexpr const char* converged = "converged";

const char* name_of(Status status) {
  switch (status) {
    case Status::converged:
      return converged;
    case Status::interrupted:
      return "interrupted";
    case Status::limit:
      return "limit";
    case Status::not_converged:
      break;
  }
  return "not converged";
}

/// JSON knows no NaN: what a diverged solve does not know is null.
Json known(double value) {
  return std::isfinite(value) ? Json(value) : Json();
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

/// As many digits as a curve needs.
Json rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return known(std::strtod(text, nullptr));
}

/// Every iteration up to 50, then ever sparser: a curve stays a curve and a report stays small.
Json history_json(const std::vector<IterationRecord>& history) {
  Json json = {
      {"iteration", Json::array()}, {"energy", Json::array()}, {"step_mm", Json::array()}, {"residual", Json::array()}};
  for (std::size_t i = 0; i < history.size(); i += std::max<std::size_t>(1, i / 50)) {
    json["iteration"].push_back(i + 1);
    json["energy"].push_back(rounded(history[i].energy));
    json["step_mm"].push_back(rounded(history[i].step_mm));
    json["residual"].push_back(rounded(history[i].gradient_norm));
  }
  return json;
}

Json solver_json(const SolveOptions& options) {
  const StaticsOptions statics = options.statics();
  Json json = {{"name", options.solver_name},
               {"tolerance_mm", statics.step_tolerance_mm},
               {"max_iterations", statics.max_iterations}};
  if (statics.solver == Solver::local_global) json["anderson"] = statics.anderson;
  return json;
}

Json elastic_json(const ElasticLaw& e) {
  if (e.law == Law::mooney_rivlin) return {{"c10_MPa", e.c10}, {"c01_MPa", e.c01}, {"bulk_modulus_MPa", e.bulk}};
  if (e.law == Law::yeoh)
    return {{"c10_MPa", e.c10}, {"c20_MPa", e.c20}, {"c30_MPa", e.c30}, {"bulk_modulus_MPa", e.bulk}};
  return {{"mu_MPa", e.mu}, {"lambda_MPa", e.lambda}};
}

Json materials_json(const Model& model) {
  Json materials = Json::array();
  for (const Material& material : model.materials) {
    Json json = {{"region", material.region}};
    if (model.formulation == Formulation::physical) {
      json["law"] = law_name(material.elastic.law);
      json.update(elastic_json(material.elastic));
      json["density_kg_m3"] = material.density;
    } else {
      json["shape_ratio"] = material.shape_ratio;
      json["weight"] = material.weight;
    }
    materials.push_back(json);
  }
  return materials;
}

Json actuators_json(const Model& model) {
  Json actuators = Json::object();
  for (const Actuator& actuator : model.actuators) {
    const std::string unit = command_unit(actuator);
    actuators[actuator.name] = {{"kind", kind_name(actuator)},
                                {"control", control_name(actuator)},
                                {"unit", unit.empty() ? "ratio to rest" : unit},
                                {"range", {actuator.low, actuator.high}}};
    if (actuator.curve)
      actuators[actuator.name]["curve"] = {{"file", actuator.curve->file}, {"branch", branch_name(actuator.branch)}};
  }
  return actuators;
}

Json units_json(const Model& model) {
  const bool physical = model.formulation == Formulation::physical;
  return {{"markers", "mm"},
          {"requested", "the unit of each actuator"},
          {"achieved", "ratio to rest"},
          {"strain", "stretch minus 1"},
          {"energy", physical ? "mJ" : "mm^5"},
          {"residual", physical ? "N" : "mm^4"}};
}

/// A cable under length control that carries nothing because its path is shorter than the cable.
bool is_slack(const Actuator& actuator, double achieved, double length, double tension) {
  constexpr double rounding = 1e-9;
  return actuator.kind == ActuatorKind::cable && actuator.control == Control::ratio && tension == 0 &&
         achieved < length * (1 - rounding);
}

/// Share of the way from the step before to what was asked for.
Json reached_json(const Model& model, const SolveReport& report) {
  if (report.status == Status::converged) return 1.0;
  return model.formulation == Formulation::physical ? known(report.reached) : Json();
}

Json actuator_json(const Model& model, const Equilibrium& found, std::size_t a) {
  const Actuator& actuator = model.actuators[a];
  const auto i = static_cast<Index>(a);
  const double achieved = achieved_ratio(model, actuator, found.state.positions);
  Json json = {{"requested", found.actuation[i]}, {"achieved", known(achieved)}};
  if (actuator.curve) {
    const auto input = input_by_curve(actuator, found.actuation[i], actuator.branch);
    json[curve_key(*actuator.curve)] = input ? known(*input) : Json();
  }
  const std::string key = multiplier_key(actuator);
  if (model.formulation != Formulation::physical || key.empty()) return json;
  const double multiplier = found.state.multipliers[i];
  json[key] = known(multiplier);
  if (actuator.kind == ActuatorKind::cable)
    json["slack"] = is_slack(actuator, achieved, found.state.actuation[i], multiplier);
  return json;
}

std::string line_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

Json step_json(const Model& model, const Equilibrium& equilibrium, const ElementDeformation& deformation) {
  const SolveReport& report = equilibrium.report;
  const Points& positions = equilibrium.state.positions;
  Json step = {{"actuation", Json::object()},
               {"status", name_of(report.status)},
               {"reached", reached_json(model, report)},
               {"remark", report.remark},
               {"shape_actuation", Json()},
               {"iterations", report.iterations},
               {"factorisations", report.factorisations},
               {"projections", report.projections},
               {"shifts", report.shifts},
               {"continuation_steps", report.continuation_steps},
               {"residual", known(report.gradient_norm)},
               {"step_mm", known(report.step_mm)},
               {"tolerance_mm", report.tolerance_mm},
               {"estimated_error_mm", known(report.estimated_error_mm)},
               {"seconds", report.seconds},
               {"energy", known(report.energy)}};
  step["inverted_elements"] =
      std::count_if(deformation.volume_ratio.begin(), deformation.volume_ratio.end(), [](double j) { return j <= 0; });
  step["markers"] = Json::object();
  for (const Marker& marker : model.markers) {
    const Vec3 p = marker.point.at(positions);
    step["markers"][marker.name] = {p.x(), p.y(), p.z()};
  }
  step["actuators"] = Json::object();
  const bool is_known = equilibrium.state.actuation.size() == equilibrium.actuation.size();
  if (is_known) step["shape_actuation"] = Json::object();
  if (model.formulation == Formulation::physical) step["shape_load_share"] = equilibrium.state.share;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const std::string& name = model.actuators[a].name;
    step["actuation"][name] = equilibrium.actuation[static_cast<Index>(a)];
    if (is_known) step["shape_actuation"][name] = equilibrium.state.actuation[static_cast<Index>(a)];
    step["actuators"][name] = actuator_json(model, equilibrium, a);
  }
  step["strain"] = strain_json(strain_histogram(model, deformation));
  step["history"] = history_json(report.history);
  return step;
}

Report::Report(const Model& model, const SolveOptions& options)
    : head_{{"softkin", SOFTKIN_VERSION},
            {"scene", options.scene},
            {"robot_fingerprint", fingerprint_of(model)},
            {"formulation", formulation_name(model.formulation)},
            {"materials", materials_json(model)},
            {"actuators", actuators_json(model)},
            {"solver", solver_json(options)},
            {"units", units_json(model)},
            {"mesh",
             {{"order", model.edge_nodes.empty() ? 1 : 2},
              {"vertices", model.rest.rows()},
              {"tetrahedra", model.tetrahedra.size()},
              {"prisms", model.prisms.size()}}},
            {"notes", model.notes}} {}

void Report::add(Json step) {
  seconds_ += step.at("seconds").get<double>();
  if (step.at("status").get<std::string>() != converged) {
    unconverged_.push_back({lines_.size(), step});
    unconverged_.back().step.erase("history");
  }
  lines_.push_back(line_of(step));
  last_ = std::move(step);
}

std::string Report::text() const {
  std::string text = "{\n";
  for (const auto& [key, value] : head_.items()) text += " " + line_of(key) + ": " + line_of(value) + ",\n";
  text += " \"steps\": [";
  for (std::size_t i = 0; i < lines_.size(); ++i) text += (i > 0 ? ",\n  " : "\n  ") + lines_[i];
  return text + (lines_.empty() ? "" : "\n ") + "],\n \"seconds\": " + line_of(seconds_) + "\n}\n";
}

}  // namespace softkin::cli
