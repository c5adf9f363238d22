#include <algorithm>
#include <cmath>
#include <softkin/calibration/actuator_report.hpp>
#include <softkin/calibration/actuator_samples.hpp>
#include <softkin/calibration/report_parts.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/table/measurements.hpp>

namespace softkin::calibration {

namespace {

constexpr int table_rows = 10;
constexpr int drawn_points = 200;
constexpr int curve_points = 65;
constexpr double rest_remark = 1e-3;      // from 1, beyond which the table's area ratio without voltage is reported
constexpr double rest_tolerance = 0.005;  // of the atmosphere, beyond which a sensor's rest is remarked on

std::string unit(const ActuatorCurve& curve) {
  return unit_of_input(curve.input) + 1;
}

const char* input_name(const ActuatorCurve& curve) {
  return curve.input == CurveInput::pressure ? "gauge pressure" : "voltage";
}

const char* ratio_name(const ActuatorCurve& curve) {
  return curve.input == CurveInput::pressure ? "volume ratio" : "area ratio";
}

bool holds(const std::vector<double>& ascending, double value) {
  return value >= ascending.front() && value <= ascending.back();
}

/// Spread at a place of the branch, straight between points.
double spread_at(const CurveBranch& branch, double input) {
  const std::vector<double>& x = branch.ratio.x();
  const std::size_t i = std::max<std::ptrdiff_t>(1, std::lower_bound(x.begin(), x.end(), input) - x.begin());
  const double fraction = (input - x[i - 1]) / (x[i] - x[i - 1]);
  return (1 - fraction) * branch.spread[i - 1] + fraction * branch.spread[i];
}

std::vector<double> even(double low, double high, int count) {
  std::vector<double> values;
  for (int i = 0; i <= count; ++i) values.push_back(i == count ? high : low + (high - low) * i / count);
  return values;
}

/// The branches that the curve has, with their names.
std::vector<std::pair<std::string, const CurveBranch*>> branches(const ActuatorCurve& curve) {
  std::vector<std::pair<std::string, const CurveBranch*>> all{{"loading", &curve.loading}};
  if (curve.unloading) all.emplace_back("unloading", &*curve.unloading);
  return all;
}

std::string branch_quality(const std::string& name, const CurveBranch& branch, const BranchQuality& quality,
                           const ActuatorCurve& curve) {
  const std::vector<double>&x = branch.ratio.x(), &y = branch.ratio.y();
  std::string text = name + ": " + counted(quality.repeats, "sweep") + ", " + counted(quality.samples, "row") + ", " +
                     counted(x.size(), "point") + "; " + number(x.front(), 5) + " to " + number(x.back(), 5) + " " +
                     unit(curve) + ", ratio " + number(y.front(), 5) + " to " + number(y.back(), 5) +
                     " [-]; rows off the curve by " + number(quality.rms, 2) + " rms, " + number(quality.largest, 2) +
                     " at most";
  text += quality.mean_error ? "; mean of the sweeps known to +- " + number(*quality.mean_error, 2)
                             : "; one sweep: its repeatability is not known";
  if (quality.pooled > 0)
    text += "; " + counted(quality.pooled, "point") + " pooled, where the ratio fell while the input rose";
  return text + "\n";
}

PlotSeries branch_series(const CurveBranch& branch, const std::string& label, int style) {
  PlotSeries series{.label = label,
                    .x = even(branch.ratio.x().front(), branch.ratio.x().back(), drawn_points),
                    .y = {},
                    .marks = false,
                    .style = style};
  for (const double x : series.x) series.y.push_back(branch.ratio.value(x));
  return series;
}

PlotSeries sample_series(const FittedCurve& fitted, const std::string& branch, int style) {
  PlotSeries series{.label = branch + ", rows", .x = {}, .y = {}, .line = false, .style = style, .mark_radius = 2};
  for (const CurveSample& sample : fitted.samples) {
    if (branch_name(sample.branch) != branch) continue;
    series.x.push_back(sample.input);
    series.y.push_back(sample.ratio);
  }
  return series;
}

Json branch_json(const CurveBranch& branch, const BranchQuality& quality, const char* key) {
  Json json{{key, branch.ratio.x()}, {"ratio", branch.ratio.y()}};
  if (!branch.spread.empty()) json["spread"] = branch.spread;
  if (quality.samples == 0) return json;
  json.update({{"sweeps", quality.repeats},
               {"rows", quality.samples},
               {"rms", quality.rms},
               {"largest", quality.largest},
               {"mean_error", or_null(quality.mean_error)},
               {"pooled_points", quality.pooled}});
  return json;
}

Json curve_json(const FittedCurve& fitted) {
  const char* key = fitted.curve.input == CurveInput::pressure ? "gauge_pressure_kPa" : "voltage_kV";
  Json json{{"loading", branch_json(fitted.curve.loading, fitted.loading, key)}};
  json["unloading"] = fitted.curve.unloading ? branch_json(*fitted.curve.unloading, fitted.unloading, key) : Json();
  if (!fitted.curve.end.empty()) json["end"] = fitted.curve.end;
  return json;
}

Json comparison_json(const PressureComparison& comparison) {
  Json json{{"ratio", comparison.ratios}, {"predicted_kPa", Json::array()}};
  for (const std::optional<double>& pressure : comparison.predicted) json["predicted_kPa"].push_back(or_null(pressure));
  for (const auto& [branch, check] : comparison.branches)
    json[branch_name(branch)] = {
        {"factor", check.factor}, {"misfit_before", check.misfit_before}, {"misfit_after", check.misfit_after}};
  return json;
}

/// What to write into the scene: the loading branch is what a robot under slow inflation follows.
std::string suggestions(double factor, const RobotSpec& spec) {
  std::string text;
  for (const MaterialSpec& material : spec.materials) {
    if (!material.elastic) continue;
    text += "suggestion: material '" + material.region + "': ";
    if (const auto& modulus = material.elastic->youngs_modulus)
      text += "youngs_modulus " + number(*modulus) + " -> " + number(factor * *modulus, 4) + " MPa (loading)\n";
    else
      text += "its moduli times " + number(factor, 4) + " (loading)\n";
  }
  if (spec.loads.any())
    text += "note: weight and forces act too, which do not grow with the moduli: repeat this with the new ones\n";
  return text;
}

/// Reads the runs of all files. head: receives a line for each file; more: further remarks on a file's first run
template <class Read, class More>
auto read_all(const std::vector<std::string>& files, const Read& read, std::string& head, const More& more) {
  decltype(read(files.front())) all;
  for (const std::string& file : files) {
    const auto runs = read(file);
    std::size_t rows = 0;
    for (const auto& run : runs) rows += run.rows.size();
    head += file + ": " + counted(runs.size(), "run") + ", " + counted(rows, "row") + more(runs.front()) + "\n";
    all.insert(all.end(), runs.begin(), runs.end());
  }
  return all;
}

FittedCurve fitted_curve(const std::string& name, CurveInput input, double atmosphere_kPa,
                         std::vector<CurveSample> samples) {
  CurveFit fit = fit_curve(samples);
  return {{name, input, atmosphere_kPa, "", std::move(fit.loading), std::move(fit.unloading)},
          fit.loading_quality,
          fit.unloading_quality,
          std::move(samples)};
}

DeaResults measured(const DeaTask& task, const std::string& name) {
  std::string head;
  const std::vector<VoltageRun> runs = read_all(task.tests, read_voltage_runs, head, [](const auto&) { return ""; });
  VoltageSamples samples = voltage_samples(runs);
  for (std::size_t r = 0; r < runs.size(); ++r)
    if (std::abs(samples.rest_ratios[r] - 1) > rest_remark)
      head += runs[r].file + ", " + runs[r].name + ": area ratio without voltage " + number(samples.rest_ratios[r], 5) +
              "; the others are taken over it\n";
  return {fitted_curve(name, CurveInput::voltage, 100, std::move(samples.samples)), head};
}

Dielectric elastomer_of(const DeaTask& task) {
  Dielectric d;
  d.law = task.law == "gent" ? DielectricLaw::gent : DielectricLaw::neo_hookean;
  const auto need = [&](const std::optional<double>& value, const char* what) {
    if (!value) throw InvalidInput("the law " + task.law + " needs the elastomer's " + what);
    return *value;
  };
  d.shear_modulus_MPa = need(task.shear_modulus_MPa, "shear modulus [MPa]");
  d.relative_permittivity = need(task.permittivity, "permittivity, relative to vacuum");
  d.thickness_mm = need(task.thickness_mm, "thickness before any stretch [mm]");
  d.prestretch = task.prestretch.value_or(1);
  if (task.loading == "uniaxial") d.loading = DielectricLoading::uniaxial;
  if (task.loading == "constrained") d.loading = DielectricLoading::constrained;
  if (d.loading == DielectricLoading::constrained)
    d.prestretch_across = need(task.prestretch_across, "prestretch across, which its fibres keep");
  if (d.law == DielectricLaw::gent) d.stretch_limit = need(task.stretch_limit, "stretch limit J_lim");
  return d;
}

std::string loading_text(const Dielectric& d) {
  if (d.loading == DielectricLoading::equal_biaxial) return "in equal-biaxial tension";
  if (d.loading == DielectricLoading::uniaxial) return "in tension along its length alone";
  return "that stiff fibres keep at a stretch of " + number(d.prestretch_across) + " across";
}

std::string elastomer_text(const DeaTask& task, const Dielectric& d) {
  std::string text = task.law + " elastomer " + loading_text(d) + ": shear modulus " + number(d.shear_modulus_MPa) +
                     " MPa, relative permittivity " + number(d.relative_permittivity) + ", " + number(d.thickness_mm) +
                     " mm thick before any stretch, prestretch " + number(d.prestretch) +
                     (task.prestretch ? "" : " (default)");
  if (d.law == DielectricLaw::gent) text += ", J_lim " + number(d.stretch_limit);
  return text + (d.loading == DielectricLoading::equal_biaxial ? "; constant forces at its edge\n"
                                                               : "; a constant force along its length\n");
}

std::string pull_in_text(const Dielectric& d, const PullIn& pull_in) {
  const std::string stretch = number(pull_in.stretch, 5) + (d.loading == DielectricLoading::uniaxial ? " across" : "");
  return "pull-in at " + number(pull_in.voltage_kV, 5) + " kV: stretch " + stretch + " (area ratio " +
         number(pull_in.area_ratio, 5) + " to that without voltage), field " + number(pull_in.field_kV_mm, 4) +
         " kV/mm; beyond it no equilibrium follows\n";
}

std::string no_pull_in_text(const Dielectric& d) {
  if (d.law == DielectricLaw::gent) return "no pull-in: the voltage rises up to 95 % of the limit of the chains\n";
  return "no pull-in: the voltage rises with the stretch; this law has no limit of its chains (gent has), and the "
         "curve ends at " +
         number(constrained_end) + " times the prestretch\n";
}

DeaResults computed(const DeaTask& task, const std::string& name) {
  const Dielectric d = elastomer_of(task);
  const DielectricCurve curve = dielectric_curve(d, curve_points, task.breakdown_kV_mm.value_or(0));
  std::string head = elastomer_text(task, d);
  head += curve.pull_in ? pull_in_text(d, *curve.pull_in) : no_pull_in_text(d);
  if (curve.broken_down)
    head += "breakdown field of " + number(*task.breakdown_kV_mm) + " kV/mm reached at " +
            number(curve.voltages.back(), 5) + " kV, " + (curve.pull_in ? "before pull-in" : "and") +
            ": the curve ends there\n";
  else
    head += "true field at the end of the curve: " + number(curve.end_field_kV_mm, 4) + " kV/mm" +
            (task.breakdown_kV_mm ? "" : " (no breakdown field given: not checked)") + "\n";
  const std::string end = curve.broken_down                     ? "breakdown"
                          : curve.pull_in                       ? "pull-in"
                          : d.law == DielectricLaw::neo_hookean ? "the stretch to which it is computed"
                                                                : "the limit of the chains";
  const CurveBranch branch{MonotoneCurve(curve.voltages, curve.area_ratios), {}};
  return {{{name, CurveInput::voltage, 100, end, branch, std::nullopt}}, head, curve};
}

/// By Eq. (19) the ratio is 1 at rest only where the sensor then reads the atmosphere.
std::string remark_on_rest(const SyringeSetup& setup, const SyringeRun& run) {
  const std::optional<double> rest = rest_pressure(setup, run);
  if (!rest || std::abs(*rest - setup.atmosphere_kPa) <= rest_tolerance * setup.atmosphere_kPa) return "";
  return "note: " + run.file + ", " + run.name + ": the sensor reads " + number(*rest, 5) +
         " kPa absolute with the syringe at rest, and the atmosphere counts as " + number(setup.atmosphere_kPa, 5) +
         " kPa: if the sensor is right, the atmosphere is " + number(*rest, 5) + " kPa\n";
}

/// Ratios of the branches at even inputs, with their spread, and the width of the hysteresis.
Table ratio_table(const ActuatorCurve& curve) {
  Table table{{significant(input_name(curve), unit(curve), 5)}};
  double low = curve.loading.ratio.x().front(), high = curve.loading.ratio.x().back();
  for (const auto& [name, branch] : branches(curve)) {
    table.columns.push_back(decimals(name, "-", 4));
    if (!branch->spread.empty()) table.columns.push_back(decimals("+-", "", 4));
    low = std::min(low, branch->ratio.x().front());
    high = std::max(high, branch->ratio.x().back());
  }
  if (curve.unloading) table.columns.push_back(decimals("difference", "-", 4));
  for (const double input : even(low, high, table_rows)) {
    Row& row = table.rows.emplace_back(Row{input});
    bool all = true;
    for (const auto& [name, branch] : branches(curve)) {
      const bool inside = holds(branch->ratio.x(), input);
      all = all && inside;
      row.push_back(inside ? Cell(branch->ratio.value(input)) : Cell("-"));
      if (!branch->spread.empty()) row.push_back(inside ? Cell(spread_at(*branch, input)) : Cell("-"));
    }
    if (curve.unloading)
      row.push_back(all ? Cell(curve.unloading->ratio.value(input) - curve.loading.ratio.value(input)) : Cell("-"));
  }
  return table;
}

/// Inputs of the branches at these ratios.
Table input_table(const ActuatorCurve& curve, const std::vector<double>& ratios, int digits) {
  Table table{{significant(ratio_name(curve), "-", 5)}};
  for (const auto& [name, branch] : branches(curve)) table.columns.push_back(decimals(name, unit(curve), digits));
  for (const double ratio : ratios) {
    Row& row = table.rows.emplace_back(Row{ratio});
    for (const auto& [name, branch] : branches(curve))
      row.push_back(holds(branch->ratio.y(), ratio) ? Cell(branch->ratio.inverse(ratio)) : Cell("-"));
  }
  return table;
}

}  // namespace

std::string quality_text(const FittedCurve& fitted) {
  const std::string loading = branch_quality("loading", fitted.curve.loading, fitted.loading, fitted.curve);
  if (!fitted.curve.unloading) return loading + "unloading: no row; the curve has the loading branch alone\n";
  return loading + branch_quality("unloading", *fitted.curve.unloading, fitted.unloading, fitted.curve);
}

std::string curve_text(const ActuatorCurve& curve) {
  const std::vector<double>& ratios = curve.loading.ratio.y();
  return text_of(ratio_table(curve)) + "\n" +
         text_of(input_table(curve, even(ratios.front(), ratios.back(), table_rows), 3));
}

Plot curve_plot(const FittedCurve& fitted, const std::string& title) {
  PlotPanel panel = panel_of("", std::string(input_name(fitted.curve)) + " [" + unit(fitted.curve) + "]",
                             std::string(ratio_name(fitted.curve)) + " [-]");
  int style = 0;
  for (const auto& [name, branch] : branches(fitted.curve)) {
    PlotSeries rows = sample_series(fitted, name, style);
    if (!rows.x.empty()) panel.series.push_back(std::move(rows));
    panel.series.push_back(branch_series(*branch, name, style++));
  }
  return {.title = title, .rows = {{panel}}, .panel_height = 420};
}

Table syringe_table(const SyringeSetup& setup, const std::vector<SyringeSample>& samples) {
  Table table = csv_table({"p_gauge_kpa", "p_abs_kpa", "ratio", "unloading", "sweep", "run", "line"});
  for (const SyringeSample& each : samples)
    table.rows.push_back({ten_digits(each.sample.input), ten_digits(each.sample.input + setup.atmosphere_kPa),
                          ten_digits(each.sample.ratio), count_cell(each.sample.branch == Branch::unloading ? 1 : 0),
                          count_cell(each.sample.repeat), count_cell(each.run), count_cell(each.line)});
  return table;
}

std::string comparison_text(const PressureComparison& comparison, const ActuatorCurve& curve, const RobotSpec& spec) {
  const auto percent = [](double fraction) { return number(100 * fraction, 3) + " %"; };
  Table table = input_table(curve, comparison.ratios, 2);
  table.columns.push_back(decimals("predicted", "kPa", 2));
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    table.rows[i].push_back(comparison.predicted[i] ? Cell(*comparison.predicted[i]) : Cell("no equilibrium"));
  std::string text = "gauge pressures of the physical formulation of " + spec.name + ", " + comparison.actuator +
                     " inflated, other chambers open:\n" + text_of(table);
  for (const auto& [branch, check] : comparison.branches)
    text += std::string(branch_name(branch)) + ": measured = " + number(check.factor, 4) +
            " x predicted; they differ by " + percent(check.misfit_before) + " rms, with the factor by " +
            percent(check.misfit_after) + "\n";
  if (!comparison.branches.empty()) text += suggestions(comparison.branches.front().second.factor, spec);
  return text;
}

std::string pressure_json(const std::vector<std::string>& tests, const SyringeSetup& setup, const FittedCurve& fitted,
                          const PressureComparison* comparison) {
  Json json{{"softkin", SOFTKIN_VERSION},
            {"tests", tests},
            {"atmosphere_kPa", setup.atmosphere_kPa},
            {"chamber_mm3", setup.chamber_mm3},
            {"tube_mm3", setup.tube_mm3},
            {"syringe_mm3", setup.syringe_mm3}};
  json.update(curve_json(fitted));
  if (comparison != nullptr) json["physical"] = comparison_json(*comparison);
  return text_of(json);
}

std::string dea_json(const std::vector<std::string>& tests, const FittedCurve& fitted,
                     const DielectricCurve* computed) {
  Json json{{"softkin", SOFTKIN_VERSION}};
  if (computed == nullptr) {
    json["tests"] = tests;
  } else {
    json["pull_in"] = Json();
    if (const std::optional<PullIn>& at = computed->pull_in)
      json["pull_in"] = {{"voltage_kV", at->voltage_kV},
                         {"stretch", at->stretch},
                         {"area_ratio", at->area_ratio},
                         {"field_kV_mm", at->field_kV_mm}};
    json["broken_down"] = computed->broken_down;
    json["end_field_kV_mm"] = computed->end_field_kV_mm;
  }
  json.update(curve_json(fitted));
  return text_of(json);
}

SyringeResults evaluate(const SyringeTask& task, const std::string& name) {
  std::string head;
  const std::vector<SyringeRun> runs = read_all(
      task.tests, [&](const std::string& file) { return read_syringe_runs(file, task.scale); }, head,
      [](const SyringeRun& run) {
        return run.scale == PressureScale::absolute ? ", absolute pressures" : ", gauge pressures";
      });
  std::vector<SyringeSample> samples = chamber_ratios(task.setup, runs);
  std::vector<CurveSample> points;
  for (const SyringeSample& each : samples) points.push_back(each.sample);
  FittedCurve fitted = fitted_curve(name, CurveInput::pressure, task.setup.atmosphere_kPa, std::move(points));
  for (const SyringeRun& run : runs) head += remark_on_rest(task.setup, run);
  return {std::move(fitted), head, std::move(samples)};
}

DeaResults evaluate(const DeaTask& task, const std::string& name) {
  return task.tests.empty() ? computed(task, name) : measured(task, name);
}

}  // namespace softkin::calibration
