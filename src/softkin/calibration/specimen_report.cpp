#include <algorithm>
#include <cmath>
#include <softkin/calibration/report_parts.hpp>
#include <softkin/calibration/specimen_report.hpp>
#include <softkin/core/text.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/model/names.hpp>

namespace softkin::calibration {

namespace {

/// Difference over what was measured [%].
double off_percent(double found, double measured) {
  return 100 * (found / measured - 1);
}

std::string spread_text(double spread) {
  return "; spread " + decimal(100 * spread, 2) + " %";
}

std::string ratio_text(const RatioEstimate& estimate) {
  const std::string ratio = decimal(estimate.ratio, 3);
  if (estimate.specimens < 2) return ratio + "; one specimen: no spread";
  return ratio + spread_text(estimate.spread) + ", " + decimal(estimate.least, 3) + " to " +
         decimal(estimate.greatest, 3);
}

std::string shape_text(const ShapeRatios& shape) {
  return "R_omega " + number(shape.a, 4) + " and " + number(shape.b, 4) + ", which stand for Poisson's ratios of " +
         decimal(poisson_ratio_of_shape_ratio(shape.a), 2) + " and " +
         decimal(poisson_ratio_of_shape_ratio(shape.b), 2);
}

std::string moduli_text(const Moduli& moduli) {
  return "E_A " + number(moduli.a_mpa, 5) + " MPa, E_B " + number(moduli.b_mpa, 5) + " MPa" +
         (moduli.specimens > 1 ? spread_text(moduli.spread) : "");
}

std::string ratios_text(const SpecimenResults& results, double stiffer) {
  Table table{{{.key = "", .left = true}, {.key = "", .left = true}}};
  std::vector<Row>& rows = table.rows;
  rows.push_back({"E_A / E_B of a rod, Eq. (16):", ratio_text(results.rod)});
  if (results.rod_moduli) rows.push_back({"moduli of a rod:", moduli_text(*results.rod_moduli)});
  if (const RatioFit* fit = results.fit(Formulation::physical); fit != nullptr && fit->estimate.specimens > 0) {
    rows.push_back({"E_A / E_B, physical simulation:", ratio_text(fit->estimate)});
    if (fit->moduli) rows.push_back({"moduli, physical simulation:", moduli_text(*fit->moduli)});
  }
  if (const RatioFit* fit = results.fit(Formulation::target_shape); fit != nullptr && fit->estimate.specimens > 0) {
    rows.push_back({"R_A / R_B, target-shape simulation:", ratio_text(fit->estimate)});
    rows.push_back({"", shape_text(shape_ratios(std::log(fit->estimate.ratio), stiffer))});
    const double closed = closed_form_log_ratio(results.rod.ratio, stiffer);
    rows.push_back({"R_A / R_B, closed form of Eq. (16):", decimal(std::exp(closed), 3)});
    rows.push_back({"", shape_text(shape_ratios(closed, stiffer))});
  }
  const std::string text = text_of(table);
  return text.substr(text.find('\n') + 1);  // nothing is to be said above them
}

std::string shear_note(const SpecimenTask& task) {
  const SpecimenOptions& s = task.options;
  const double nu = poisson_ratio_of_shape_ratio(s.stiffer_shape_ratio);
  constexpr double most = 0.1;
  if (!task.target_shape || std::abs(nu - s.poisson_ratio) < most) return "";
  const double right = shape_ratio_of_poisson_ratio(s.poisson_ratio);
  std::string text = "note: R_omega " + number(s.stiffer_shape_ratio, 4) +
                     " of the stiffer material stands for a Poisson's ratio of " + decimal(nu, 2) + ", not " +
                     number(s.poisson_ratio) + ": tension agrees, twist does not";
  if (right > 0 && right <= 1) text += "; a stiffer one of " + number(right, 3) + " has that Poisson's ratio";
  return text + "\n";
}

Json estimate_json(const RatioEstimate& estimate) {
  return {{"ratio", estimate.ratio},
          {"specimens", estimate.specimens},
          {"relative_spread", estimate.specimens > 1 ? Json(estimate.spread) : Json()},
          {"least", estimate.least},
          {"greatest", estimate.greatest}};
}

Json moduli_json(const std::optional<Moduli>& moduli) {
  if (!moduli) return {};
  return {{"a_MPa", moduli->a_mpa},
          {"b_MPa", moduli->b_mpa},
          {"relative_spread", moduli->specimens > 1 ? Json(moduli->spread) : Json()},
          {"specimens", moduli->specimens}};
}

Json shape_json(double log_ratio, double stiffer) {
  const ShapeRatios shape = shape_ratios(log_ratio, stiffer);
  return {{"a", shape.a}, {"b", shape.b}};
}

Json fit_json(const RatioFit& fit) {
  Json json{{"status", name_of(fit.status)}};
  json["ratio"] = fit.estimate.specimens > 0 ? estimate_json(fit.estimate) : Json();
  Json& rows = json["specimens"] = Json::array();
  for (const SpecimenFit& each : fit.specimens) {
    Json row{{"status", name_of(each.status)}, {"simulations", each.simulations}};
    if (!each.remark.empty()) row["remark"] = each.remark;
    if (each.status == Status::converged)
      row.update({{"own_ratio", std::exp(each.own_log_ratio)}, {"dl1_mm", each.response.moved_mm}});
    rows.push_back(row);
  }
  return json;
}

/// A number of every response that is converged.
Json responses_json(const std::vector<SpecimenResponse>& responses, double SpecimenResponse::*value) {
  Json values = Json::array();
  for (const SpecimenResponse& each : responses)
    values.push_back(each.status == Status::converged ? Json(each.*value) : Json());
  return values;
}

Json measured_json(const SpecimenResults& results) {
  Json rows = Json::array();
  for (const StretchedSpecimen& s : results.specimens) {
    Json row{{"line", s.line},
             {"l_mm", s.length_mm},
             {"l1_mm", s.interface_mm},
             {"dl_mm", s.stretch_mm},
             {"dl1_mm", s.interface_moved_mm},
             {"eq16", elasticity_ratio(s)}};
    if (s.force_n) row["force_N"] = *s.force_n;
    if (s.area_mm2) row["area_mm2"] = *s.area_mm2;
    rows.push_back(row);
  }
  return rows;
}

double rod_deg(const SpecimenResults& results, const TwistedSpecimen& t) {
  return t.twist_deg * rod_fraction(results.rod.ratio, t.length_mm, t.interface_mm);
}

Json twists_json(const SpecimenTask& task, const SpecimenResults& results) {
  Json rows = Json::array();
  for (const TwistedSpecimen& t : results.twists)
    rows.push_back({{"line", t.line},
                    {"l_mm", t.length_mm},
                    {"l1_mm", t.interface_mm},
                    {"twist_deg", t.twist_deg},
                    {"interface_deg", or_null(t.interface_deg)},
                    {"rod_deg", rod_deg(results, t)}});
  Json json{{"file", task.twist_file}, {"tests", rows}};
  for (const SimulatedTests& tests : results.simulated)
    if (tests.fit)
      json[tests.is(Formulation::physical) ? "physical_deg" : "target_shape_deg"] =
          responses_json(tests.twisted, &SpecimenResponse::turned_deg);
  return json;
}

Json target_json(const RatioFit& fit, double rod_ratio, double stiffer) {
  Json json = fit_json(fit);
  if (fit.estimate.specimens > 0) json["shape_ratios"] = shape_json(std::log(fit.estimate.ratio), stiffer);
  const double closed = closed_form_log_ratio(rod_ratio, stiffer);
  json["closed_form"] = {{"ratio", std::exp(closed)}, {"shape_ratios", shape_json(closed, stiffer)}};
  return json;
}

PlotSeries points(const std::string& label, int style = -1) {
  return {.label = label, .x = {}, .y = {}, .line = false, .style = style};
}

/// Delta L_1 / Delta L over L_1 / L.
void add_fraction(PlotSeries& series, const StretchedSpecimen& specimen, double moved_mm) {
  series.x.push_back(specimen.interface_mm / specimen.length_mm);
  series.y.push_back(moved_mm / specimen.stretch_mm);
}

PlotSeries rod_curve(double ratio) {
  PlotSeries series{.label = "rod, E_A / E_B " + decimal(ratio, 2), .x = {}, .y = {}, .marks = false};
  for (int i = 0; i <= 100; ++i) {
    series.x.push_back(0.01 * i);
    series.y.push_back(i == 100 ? 1 : rod_fraction(ratio, 1, 0.01 * i));
  }
  return series;
}

PlotPanel stretch_panel(const SpecimenResults& results) {
  PlotPanel panel = panel_of("Stretched", "L1 / L [-]", "dL1 / dL [-]");
  panel.series = {rod_curve(results.rod.ratio), points("measured")};
  for (const StretchedSpecimen& s : results.specimens) add_fraction(panel.series.back(), s, s.interface_moved_mm);
  for (const SimulatedTests& tests : results.simulated) {
    PlotSeries& series = panel.series.emplace_back(points(tests.name));
    for (std::size_t i = 0; i < tests.stretched.size(); ++i)
      add_fraction(series, results.specimens[i], tests.stretched[i].moved_mm);
  }
  return panel;
}

PlotPanel twist_panel(const SpecimenResults& results) {
  PlotPanel panel = panel_of("Twisted", "free end [deg]", "interface [deg]");
  PlotSeries measured = points("measured", 1);
  for (const TwistedSpecimen& t : results.twists) {
    if (!t.interface_deg) continue;
    measured.x.push_back(t.twist_deg);
    measured.y.push_back(*t.interface_deg);
  }
  if (!measured.x.empty()) panel.series.push_back(measured);
  int style = results.fit(Formulation::physical) != nullptr ? 2 : 3;
  for (const SimulatedTests& tests : results.simulated) {
    PlotSeries series = points(tests.name, style++);
    for (std::size_t i = 0; i < tests.twisted.size(); ++i) {
      series.x.push_back(results.twists[i].twist_deg);
      series.y.push_back(tests.twisted[i].turned_deg);
    }
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  return panel;
}

Table stretch_table(const SpecimenResults& results) {
  Table table{{significant("line", ""), significant("L", "mm"), significant("L1", "mm"), significant("dL", "mm"),
               significant("dL1", "mm"), decimals("Eq. (16)", "", 3)}};
  for (const StretchedSpecimen& s : results.specimens)
    table.rows.push_back(
        {count_cell(s.line), s.length_mm, s.interface_mm, s.stretch_mm, s.interface_moved_mm, elasticity_ratio(s)});
  for (const SimulatedTests& tests : results.simulated) {
    if (tests.fit)  // the specimen's own ratio, and its interface at the ratio of all
      table.columns.push_back(
          decimals(tests.name + (tests.is(Formulation::physical) ? ": E_A/E_B" : ": R_A/R_B"), "", 3));
    table.columns.push_back(decimals((tests.fit ? "" : "at R_A/R_B " + number(tests.ratio) + ": ") + "dL1", "mm", 4));
    table.columns.push_back(decimals("off", "%", 2));
    for (std::size_t i = 0; i < results.specimens.size(); ++i) {
      const bool found = !tests.fit || tests.fit->specimens[i].status == Status::converged;
      const double moved = tests.stretched[i].moved_mm;
      Row& row = table.rows[i];
      if (tests.fit) row.push_back(or_dash(found, std::exp(tests.fit->specimens[i].own_log_ratio)));
      row.push_back(or_dash(found, moved));
      row.push_back(or_dash(found, off_percent(moved, results.specimens[i].interface_moved_mm)));
    }
  }
  return table;
}

Table twist_table(const SpecimenResults& results) {
  Table table{{significant("line", ""), significant("L", "mm"), significant("L1", "mm"), significant("twist", "deg"),
               significant("interface measured", "deg"), decimals("rod", "deg", 3)}};
  for (const TwistedSpecimen& t : results.twists)
    table.rows.push_back({count_cell(t.line), t.length_mm, t.interface_mm, t.twist_deg,
                          or_dash(t.interface_deg.has_value(), t.interface_deg.value_or(0)), rod_deg(results, t)});
  for (const SimulatedTests& tests : results.simulated) {
    if (tests.twisted.empty()) continue;
    table.columns.push_back(decimals(tests.fit ? tests.name : "at R_A/R_B " + number(tests.ratio), "deg", 3));
    table.columns.push_back(decimals("off", "%", 2));
    for (std::size_t i = 0; i < results.twists.size(); ++i) {
      const std::optional<double>& measured = results.twists[i].interface_deg;
      table.rows[i].push_back(tests.twisted[i].turned_deg);
      table.rows[i].push_back(
          or_dash(measured.has_value(), off_percent(tests.twisted[i].turned_deg, measured.value_or(1))));
    }
  }
  return table;
}

}  // namespace

std::string specimens_fragment(const SpecimenTask& task, const SpecimenResults& results) {
  std::string a = "  - {region: " + task.regions[0], b = "  - {region: " + task.regions[1];
  std::string remark;
  const RatioFit *physical = results.fit(Formulation::physical), *target = results.fit(Formulation::target_shape);
  if (target != nullptr) {
    const ShapeRatios shape = shape_ratios(std::log(target->estimate.ratio), task.options.stiffer_shape_ratio);
    a += ", shape_ratio: " + number(shape.a, 5);
    b += ", shape_ratio: " + number(shape.b, 5);
  }
  if (physical != nullptr) {
    const double ratio = physical->estimate.ratio;
    std::optional<Moduli> moduli = physical->moduli;
    if (!moduli && task.modulus_b) moduli = Moduli{ratio * *task.modulus_b, *task.modulus_b};
    if (moduli) {
      const Law law = task.options.law;
      const std::string rest = ", poisson_ratio: " + number(task.options.poisson_ratio) +
                               (law == Law::neo_hookean ? "" : std::string(", law: ") + law_name(law));
      a += ", youngs_modulus: " + number(moduli->a_mpa, 5) + rest;
      b += ", youngs_modulus: " + number(moduli->b_mpa, 5) + rest;
    } else {
      remark = "  # physical: youngs_modulus of " + task.regions[0] + " = " + number(ratio, 5) + " x that of " +
               task.regions[1] + "; a column force_n or the modulus of B gives both\n";
    }
  }
  if (target == nullptr && !remark.empty()) return "# no materials without a modulus\n" + remark;
  return "materials:   # softkin calibrate material " + printable(task.file) + "\n" + a + "}\n" + b + "}\n" + remark;
}

std::string specimens_text(const SpecimenTask& task, const SpecimenResults& results) {
  std::string text = task.file + ": " + counted(results.specimens.size(), "specimen") + "; simulated with\n";
  for (const std::string& line : task.set_up) text += "  " + line + "\n";
  text += "\n" + text_of(stretch_table(results)) + "\n" + ratios_text(results, task.options.stiffer_shape_ratio) +
          shear_note(task);
  if (!results.twists.empty())
    text += "\nTurn of the interface where the free end is twisted:\n" + text_of(twist_table(results));
  return failure(task, results).empty() ? text + "\n" + specimens_fragment(task, results) : text;
}

std::string specimens_json(const SpecimenTask& task, const SpecimenResults& results) {
  const double stiffer = task.options.stiffer_shape_ratio;
  Json json{{"softkin", SOFTKIN_VERSION}, {"specimens_file", task.file}, {"set_up", task.set_up}};
  json["specimens"] = measured_json(results);
  json["rod"] = {{"elasticity_ratio", estimate_json(results.rod)}, {"moduli", moduli_json(results.rod_moduli)}};
  if (const RatioFit* fit = results.fit(Formulation::physical)) {
    json["physical"] = fit_json(*fit);
    json["physical"]["moduli"] = moduli_json(fit->moduli);
  }
  if (const RatioFit* fit = results.fit(Formulation::target_shape))
    json["target_shape"] = target_json(*fit, results.rod.ratio, stiffer);
  for (const SimulatedTests& tests : results.simulated)
    if (!tests.fit)
      json["tried"].push_back({{"ratio", tests.ratio},
                               {"dl1_mm", responses_json(tests.stretched, &SpecimenResponse::moved_mm)},
                               {"interface_deg", responses_json(tests.twisted, &SpecimenResponse::turned_deg)}});
  if (!results.twists.empty()) json["twist"] = twists_json(task, results);
  if (failure(task, results).empty()) json["materials_yaml"] = specimens_fragment(task, results);
  return text_of(json);
}

Table residual_table(const SpecimenResults& results) {
  Table table = csv_table({"line", "l1_mm", "dl_mm", "dl1_mm"});
  for (const StretchedSpecimen& s : results.specimens)
    table.rows.push_back(
        {count_cell(s.line), ten_digits(s.interface_mm), ten_digits(s.stretch_mm), ten_digits(s.interface_moved_mm)});
  for (const SimulatedTests& tests : results.simulated) {
    if (!tests.fit) continue;
    const std::string name = tests.is(Formulation::physical) ? "physical" : "target_shape";
    table.columns.push_back({.key = name + "_dl1_mm"});
    table.columns.push_back({.key = name + "_off_mm"});
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const double moved = tests.stretched[i].moved_mm;
      table.rows[i].push_back(ten_digits(moved));
      table.rows[i].push_back(ten_digits(moved - results.specimens[i].interface_moved_mm));
    }
  }
  return table;
}

Plot specimens_plot(const SpecimenTask& task, const SpecimenResults& results) {
  std::vector<PlotPanel> panels{stretch_panel(results)};
  if (!results.twists.empty()) panels.push_back(twist_panel(results));
  return {.title = "Two materials: " + task.file, .rows = {panels}, .panel_height = 320};
}

}  // namespace softkin::calibration
