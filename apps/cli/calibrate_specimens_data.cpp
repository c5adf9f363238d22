#include <cmath>

#include "calibrate_results.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

const char* status_name(Status status) {
  return status == Status::converged ? "converged" : status == Status::limit ? "limit" : "not converged";
}

Json estimate_json(const calibration::RatioEstimate& estimate) {
  Json json{{"ratio", estimate.ratio}, {"specimens", estimate.specimens}};
  json["relative_spread"] = estimate.specimens > 1 ? Json(estimate.spread) : Json();
  json["least"] = estimate.least;
  json["greatest"] = estimate.greatest;
  return json;
}

Json moduli_json(const std::optional<calibration::Moduli>& moduli) {
  if (!moduli) return {};
  return {{"a_MPa", moduli->a_mpa},
          {"b_MPa", moduli->b_mpa},
          {"relative_spread", moduli->specimens > 1 ? Json(moduli->spread) : Json()},
          {"specimens", moduli->specimens}};
}

Json shape_json(double log_ratio, double stiffer) {
  const calibration::ShapeRatios shape = calibration::shape_ratios(log_ratio, stiffer);
  return {{"a", shape.a}, {"b", shape.b}};
}

Json fit_json(const calibration::RatioFit& fit) {
  Json json{{"status", status_name(fit.status)}};
  json["ratio"] = fit.estimate.specimens > 0 ? estimate_json(fit.estimate) : Json();
  Json& rows = json["specimens"] = Json::array();
  for (const calibration::SpecimenFit& each : fit.specimens) {
    Json row{{"status", status_name(each.status)}, {"simulations", each.simulations}};
    if (!each.remark.empty()) row["remark"] = each.remark;
    if (each.status == Status::converged) {
      row["own_ratio"] = std::exp(each.own_log_ratio);
      row["dl1_mm"] = each.response.moved_mm;
    }
    rows.push_back(row);
  }
  return json;
}

Json turns_json(const std::vector<calibration::SpecimenResponse>& responses) {
  Json turns = Json::array();
  for (const calibration::SpecimenResponse& each : responses)
    turns.push_back(each.status == Status::converged ? Json(each.turned_deg) : Json());
  return turns;
}

Json measured_json(const SpecimenResults& results) {
  Json rows = Json::array();
  for (const StretchedSpecimen& s : results.specimens) {
    Json row{{"line", s.line},
             {"l_mm", s.length_mm},
             {"l1_mm", s.interface_mm},
             {"dl_mm", s.stretch_mm},
             {"dl1_mm", s.interface_moved_mm},
             {"eq16", calibration::elasticity_ratio(s)}};
    if (s.force_n) row["force_N"] = *s.force_n;
    if (s.area_mm2) row["area_mm2"] = *s.area_mm2;
    rows.push_back(row);
  }
  return rows;
}

Json twists_json(const SpecimenResults& results) {
  Json rows = Json::array();
  for (const TwistedSpecimen& t : results.twists)
    rows.push_back({{"line", t.line},
                    {"l_mm", t.length_mm},
                    {"l1_mm", t.interface_mm},
                    {"twist_deg", t.twist_deg},
                    {"interface_deg", t.interface_deg ? Json(*t.interface_deg) : Json()},
                    {"rod_deg", t.twist_deg * calibration::rod_share(results.rod.ratio, t.length_mm, t.interface_mm)}});
  return rows;
}

/// Delta L_1 / Delta L over L_1 / L.
PlotSeries shares(const std::string& label, const std::vector<StretchedSpecimen>& specimens,
                  const std::vector<double>& moved) {
  PlotSeries series;
  series.label = label;
  series.line = false;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    series.x.push_back(specimens[i].interface_mm / specimens[i].length_mm);
    series.y.push_back(moved[i] / specimens[i].stretch_mm);
  }
  return series;
}

PlotSeries rod_curve(double ratio) {
  PlotSeries series;
  series.label = "rod, E_A / E_B " + decimal(ratio, 2);
  series.marks = false;
  for (int i = 0; i <= 100; ++i) {
    series.x.push_back(0.01 * i);
    series.y.push_back(i == 100 ? 1 : calibration::rod_share(ratio, 1, 0.01 * i));
  }
  return series;
}

PlotPanel stretch_panel(const SpecimenResults& results) {
  PlotPanel panel;
  panel.title = "Stretched";
  panel.x.label = "L1 / L [-]";
  panel.y.label = "dL1 / dL [-]";
  std::vector<double> measured;
  for (const StretchedSpecimen& s : results.specimens) measured.push_back(s.interface_moved_mm);
  const auto moved = [](const auto& rows, const auto& response) {
    std::vector<double> all;
    for (const auto& row : rows) all.push_back(response(row).moved_mm);
    return all;
  };
  const auto of_fit = [](const calibration::SpecimenFit& fit) { return fit.response; };
  panel.series = {rod_curve(results.rod.ratio), shares("measured", results.specimens, measured)};
  if (results.physical)
    panel.series.push_back(shares("physical", results.specimens, moved(results.physical->specimens, of_fit)));
  if (results.target)
    panel.series.push_back(shares("target-shape", results.specimens, moved(results.target->specimens, of_fit)));
  for (const TriedRatio& each : results.tried)
    panel.series.push_back(shares("R_A / R_B " + number(each.ratio), results.specimens,
                                  moved(each.stretched, [](const calibration::SpecimenResponse& r) { return r; })));
  return panel;
}

PlotPanel twist_panel(const SpecimenResults& results) {
  PlotPanel panel;
  panel.title = "Twisted";
  panel.x.label = "free end [deg]";
  panel.y.label = "interface [deg]";
  PlotSeries measured;
  measured.label = "measured";
  measured.line = false;
  measured.style = 1;
  for (const TwistedSpecimen& t : results.twists)
    if (t.interface_deg) {
      measured.x.push_back(t.twist_deg);
      measured.y.push_back(*t.interface_deg);
    }
  if (!measured.x.empty()) panel.series.push_back(measured);
  const auto add = [&](const std::string& label, const std::vector<calibration::SpecimenResponse>& responses,
                       int style) {
    if (responses.empty()) return;
    PlotSeries series;
    series.label = label;
    series.line = false;
    series.style = style;
    for (std::size_t i = 0; i < responses.size(); ++i) {
      series.x.push_back(results.twists[i].twist_deg);
      series.y.push_back(responses[i].turned_deg);
    }
    panel.series.push_back(series);
  };
  add("physical", results.physical_twists, 2);
  add("target-shape", results.target_twists, 3);
  int style = 4;
  for (const TriedRatio& each : results.tried) add("R_A / R_B " + number(each.ratio), each.twisted, style++);
  return panel;
}

}  // namespace

Json specimens_json(const SpecimenResults& results, const MaterialOptions& options) {
  const calibration::SpecimenOptions& s = options.specimen;
  Json json{{"softkin", SOFTKIN_VERSION}, {"specimens_file", options.specimens}};
  json["set_up"] = set_up_lines(options);
  json["specimens"] = measured_json(results);
  json["rod"] = {{"elasticity_ratio", estimate_json(results.rod)}, {"moduli", moduli_json(results.rod_moduli)}};
  if (results.physical) {
    json["physical"] = fit_json(*results.physical);
    json["physical"]["moduli"] = moduli_json(results.physical->moduli);
  }
  if (results.target) {
    Json& target = json["target_shape"] = fit_json(*results.target);
    if (results.target->estimate.specimens > 0)
      target["shape_ratios"] = shape_json(std::log(results.target->estimate.ratio), s.stiffer_shape_ratio);
    const double closed = calibration::closed_form_log_ratio(results.rod.ratio, s.stiffer_shape_ratio);
    target["closed_form"] = {{"ratio", std::exp(closed)}, {"shape_ratios", shape_json(closed, s.stiffer_shape_ratio)}};
  }
  for (const TriedRatio& each : results.tried) {
    Json moved = Json::array();
    for (const calibration::SpecimenResponse& r : each.stretched)
      moved.push_back(r.status == Status::converged ? Json(r.moved_mm) : Json());
    json["tried"].push_back({{"ratio", each.ratio}, {"dl1_mm", moved}, {"interface_deg", turns_json(each.twisted)}});
  }
  if (!results.twists.empty()) {
    json["twist"] = {{"file", options.twist}, {"tests", twists_json(results)}};
    if (results.physical) json["twist"]["physical_deg"] = turns_json(results.physical_twists);
    if (results.target) json["twist"]["target_shape_deg"] = turns_json(results.target_twists);
  }
  if (results.failure(options).empty()) json["materials_yaml"] = specimens_fragment(results, options);
  return json;
}

Plot specimens_plot(const SpecimenResults& results, const MaterialOptions& options) {
  Plot plot;
  plot.title = "Two materials: " + options.specimens;
  plot.rows.push_back({stretch_panel(results)});
  if (!results.twists.empty()) plot.rows.back().push_back(twist_panel(results));
  plot.panel_height = 320;
  return plot;
}

std::string specimens_residuals(const SpecimenResults& results) {
  std::string text = "line,l1_mm,dl_mm,dl1_mm";
  if (results.physical) text += ",physical_dl1_mm,physical_off_mm";
  if (results.target) text += ",target_shape_dl1_mm,target_shape_off_mm";
  text += "\n";
  for (std::size_t i = 0; i < results.specimens.size(); ++i) {
    const StretchedSpecimen& s = results.specimens[i];
    text += std::to_string(s.line) + "," + number(s.interface_mm, 10) + "," + number(s.stretch_mm, 10) + "," +
            number(s.interface_moved_mm, 10);
    for (const auto* fit : {&results.physical, &results.target}) {
      if (!*fit) continue;
      const double moved = (*fit)->specimens[i].response.moved_mm;
      text += "," + number(moved, 10) + "," + number(moved - s.interface_moved_mm, 10);
    }
    text += "\n";
  }
  return text;
}

}  // namespace softkin::cli
