#include "calibrate_curve.hpp"

#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/scanner.hpp>

#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr int table_rows = 10;
constexpr int drawn_points = 200;

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

/// Spread at a place, straight between points.
std::optional<double> spread_at(const CurveBranch& branch, double input) {
  const std::vector<double>& x = branch.ratio.x();
  if (branch.spread.empty() || !holds(x, input)) return std::nullopt;
  const auto i =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, std::lower_bound(x.begin(), x.end(), input) - x.begin()));
  const double share = (input - x[i - 1]) / (x[i] - x[i - 1]);
  return (1 - share) * branch.spread[i - 1] + share * branch.spread[i];
}

std::vector<double> even(double low, double high, int count) {
  std::vector<double> values;
  for (int i = 0; i <= count; ++i) values.push_back(i == count ? high : low + (high - low) * i / count);
  return values;
}

void add_ratio(std::vector<std::string>& cells, const CurveBranch& branch, double input) {
  const bool inside = holds(branch.ratio.x(), input);
  cells.push_back(inside ? decimal(branch.ratio.value(input), 4) : "-");
  if (branch.spread.empty()) return;
  cells.push_back(inside ? decimal(*spread_at(branch, input), 4) : "-");
}

std::vector<std::vector<std::string>> ratio_rows(const ActuatorCurve& curve) {
  std::vector<std::vector<std::string>> rows{{std::string(input_name(curve)) + " [" + unit(curve) + "]"}};
  const auto head = [&](const char* name, const CurveBranch& branch) {
    rows[0].push_back(std::string(name) + " [-]");
    if (!branch.spread.empty()) rows[0].emplace_back("+-");
  };
  head("loading", curve.loading);
  if (curve.unloading) head("unloading", *curve.unloading);
  if (curve.unloading) rows[0].emplace_back("difference [-]");
  double low = curve.loading.ratio.x().front(), high = curve.loading.ratio.x().back();
  if (curve.unloading) {
    low = std::min(low, curve.unloading->ratio.x().front());
    high = std::max(high, curve.unloading->ratio.x().back());
  }
  for (const double input : even(low, high, table_rows)) {
    rows.push_back({number(input, 5)});
    add_ratio(rows.back(), curve.loading, input);
    if (!curve.unloading) continue;
    add_ratio(rows.back(), *curve.unloading, input);
    const bool both = holds(curve.loading.ratio.x(), input) && holds(curve.unloading->ratio.x(), input);
    rows.back().push_back(both ? decimal(curve.unloading->ratio.value(input) - curve.loading.ratio.value(input), 4)
                               : "-");
  }
  return rows;
}

std::vector<std::vector<std::string>> input_rows(const ActuatorCurve& curve) {
  std::vector<std::vector<std::string>> rows{
      {std::string(ratio_name(curve)) + " [-]", "loading [" + unit(curve) + "]"}};
  if (curve.unloading) rows[0].push_back("unloading [" + unit(curve) + "]");
  const auto cell = [](const MonotoneCurve& branch, double ratio) {
    return holds(branch.y(), ratio) ? decimal(branch.inverse(ratio), 3) : "-";
  };
  for (const double ratio : even(curve.loading.ratio.y().front(), curve.loading.ratio.y().back(), table_rows)) {
    rows.push_back({number(ratio, 5), cell(curve.loading.ratio, ratio)});
    if (curve.unloading) rows.back().push_back(cell(curve.unloading->ratio, ratio));
  }
  return rows;
}

std::string table_text(const std::vector<std::vector<std::string>>& rows) {
  return joined(aligned(rows, std::string(rows.front().size(), 'r')), "");
}

std::string branch_quality(const char* name, const CurveBranch& branch, const calibration::BranchQuality& quality,
                           const ActuatorCurve& curve) {
  const std::vector<double>&x = branch.ratio.x(), &y = branch.ratio.y();
  std::string text = std::string(name) + ": " + counted(quality.repeats, "sweep") + ", " +
                     counted(quality.samples, "row") + ", " + counted(x.size(), "point") + "; " + number(x.front(), 5) +
                     " to " + number(x.back(), 5) + " " + unit(curve) + ", ratio " + number(y.front(), 5) + " to " +
                     number(y.back(), 5) + " [-]; rows off the curve by " + number(quality.rms, 2) + " rms, " +
                     number(quality.largest, 2) + " at most";
  text += quality.mean_error ? "; mean of the sweeps known to +- " + number(*quality.mean_error, 2)
                             : "; one sweep: its repeatability is not known";
  if (quality.pooled > 0)
    text += "; " + counted(quality.pooled, "point") + " pooled, where the ratio fell while the input rose";
  return text + "\n";
}

PlotSeries branch_series(const CurveBranch& branch, const std::string& label, int style) {
  PlotSeries series;
  series.label = label;
  series.marks = false;
  series.style = style;
  series.x = even(branch.ratio.x().front(), branch.ratio.x().back(), drawn_points);
  for (const double x : series.x) series.y.push_back(branch.ratio.value(x));
  return series;
}

PlotSeries sample_series(const FittedCurve& fitted, Branch branch, const std::string& label, int style) {
  PlotSeries series;
  series.label = label;
  series.line = false;
  series.style = style;
  series.mark_radius = 2;
  for (const calibration::CurveSample& sample : fitted.samples) {
    if (sample.branch != branch) continue;
    series.x.push_back(sample.input);
    series.y.push_back(sample.ratio);
  }
  return series;
}

Json branch_json(const CurveBranch& branch, const calibration::BranchQuality& quality, const std::string& key) {
  Json json{{key, branch.ratio.x()}, {"ratio", branch.ratio.y()}};
  if (!branch.spread.empty()) json["spread"] = branch.spread;
  if (quality.samples == 0) return json;
  json["sweeps"] = quality.repeats;
  json["rows"] = quality.samples;
  json["rms"] = quality.rms;
  json["largest"] = quality.largest;
  json["mean_error"] = quality.mean_error ? Json(*quality.mean_error) : Json();
  json["pooled_points"] = quality.pooled;
  return json;
}

}  // namespace

std::string quality_text(const FittedCurve& fitted) {
  std::string text = branch_quality("loading", fitted.curve.loading, fitted.loading, fitted.curve);
  if (fitted.curve.unloading)
    text += branch_quality("unloading", *fitted.curve.unloading, fitted.unloading, fitted.curve);
  else
    text += "unloading: no row; the curve has the loading branch alone\n";
  return text;
}

std::string curve_table(const FittedCurve& fitted) {
  return table_text(ratio_rows(fitted.curve)) + "\n" + table_text(input_rows(fitted.curve));
}

Plot curve_plot(const FittedCurve& fitted, const std::string& title) {
  PlotPanel panel;
  panel.x.label = std::string(input_name(fitted.curve)) + " [" + unit(fitted.curve) + "]";
  panel.y.label = std::string(ratio_name(fitted.curve)) + " [-]";
  const auto add = [&](Branch branch, const CurveBranch& of, int style) {
    const std::string name = branch_name(branch);
    PlotSeries rows = sample_series(fitted, branch, name + ", rows", style);
    if (!rows.x.empty()) panel.series.push_back(std::move(rows));
    panel.series.push_back(branch_series(of, name, style));
  };
  add(Branch::loading, fitted.curve.loading, 0);
  if (fitted.curve.unloading) add(Branch::unloading, *fitted.curve.unloading, 1);
  Plot plot;
  plot.title = title;
  plot.panel_height = 420;
  plot.rows = {{panel}};
  return plot;
}

Json curve_json(const FittedCurve& fitted) {
  const bool pressure = fitted.curve.input == CurveInput::pressure;
  const std::string key = pressure ? "gauge_pressure_kPa" : "voltage_kV";
  Json json{{"loading", branch_json(fitted.curve.loading, fitted.loading, key)}};
  json["unloading"] = fitted.curve.unloading ? branch_json(*fitted.curve.unloading, fitted.unloading, key) : Json();
  if (!fitted.curve.end.empty()) json["end"] = fitted.curve.end;
  return json;
}

void check_ending(const char* option, const std::string& file, const char* ending) {
  if (!file.empty() && lower_extension(file) != ending)
    throw InvalidInput(std::string(option) + " " + file + ": must end in " + ending);
}

CLI::Validator positive_number() {
  const auto check = [](const std::string& text) -> std::string {
    double value = 0;
    if (parse_real(text, value) && value > 0) return "";
    return "must be a finite number above 0, not " + text;
  };
  return CLI::Validator(check, "");
}

}  // namespace softkin::cli
