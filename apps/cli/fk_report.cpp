#include "fk_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "fk_fingerprint.hpp"

namespace softkin::cli {

using Json = Report::Json;

namespace {

constexpr const char* converged = "converged";

const char* name_of(Status status) {
  return status == Status::converged ? converged : status == Status::interrupted ? "interrupted" : "not converged";
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

Json solver_json(const FkOptions& options) {
  return {{"name", options.solver},
          {"tolerance_mm", options.statics.step_tolerance_mm},
          {"max_iterations", options.statics.max_iterations},
          {"anderson", options.statics.anderson}};
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
               {"iterations", report.iterations},
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
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const double requested = equilibrium.actuation[static_cast<Index>(a)];
    step["actuation"][actuator.name] = requested;
    step["actuators"][actuator.name] = {{"requested", requested},
                                        {"achieved", achieved_ratio(model, actuator, positions)}};
  }
  step["strain"] = strain_json(strain_histogram(model, deformation));
  step["history"] = history_json(report.history);
  return step;
}

Report::Report(const Model& model, const FkOptions& options)
    : head_{
          {"softkin", SOFTKIN_VERSION},
          {"scene", options.scene},
          {"robot_fingerprint", fingerprint_of(model)},
          {"formulation", "target-shape"},
          {"solver", solver_json(options)},
          {"units",
           {{"markers", "mm"},
            {"actuators", "ratio to rest"},
            {"strain", "stretch minus 1"},
            {"energy", "mm^5"},
            {"residual", "mm^4"}}},
          {"mesh",
           {{"vertices", model.rest.rows()}, {"tetrahedra", model.tetrahedra.size()}, {"prisms", model.prisms.size()}}},
          {"notes", model.notes}} {}

void Report::add(Json step) {
  seconds_ += step.at("seconds").get<double>();
  if (step.at("status").get<std::string>() != converged) unconverged_.push_back(lines_.size());
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
