#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/strain_plot.hpp>
#include <utility>

namespace softkin::runs {

namespace {

constexpr std::size_t max_histograms = 12, histograms_in_a_row = 2;
constexpr double at_rest = 1e-6;  // strains below it are all in one bin, which would dwarf the others

/// Ends of both axes over all histograms [%].
struct StrainAxes {
  double least = 0, greatest = 0, fraction = 0;

  void cover(const StrainHistogram& strain) {
    least = std::min(least, 100 * strain.edges.front());
    greatest = std::max(greatest, 100 * strain.edges.back());
    fraction = std::max(fraction, 100 * *std::max_element(strain.fractions.begin(), strain.fractions.end()));
  }
};

/// The outline of the bars.
PlotSeries outline(const StrainHistogram& strain) {
  PlotSeries series;
  series.marks = false;
  series.style = 0;
  const auto add = [&series](double x, double y) {
    series.x.push_back(100 * x);
    series.y.push_back(100 * y);
  };
  for (std::size_t i = 0; i < strain.fractions.size(); ++i) {
    add(strain.edges[i], 0);
    add(strain.edges[i], strain.fractions[i]);
    add(strain.edges[i + 1], strain.fractions[i]);
    add(strain.edges[i + 1], 0);
  }
  return series;
}

/// Upright lines at both ends of a linear range, where they are within the axes.
PlotSeries limits(double linear_range, const StrainAxes& axes) {
  PlotSeries series;
  series.label = "linear up to " + number(100 * linear_range) + " %";
  series.pairs = true;
  series.marks = false;
  series.style = 4;
  for (const double x : {-100 * linear_range, 100 * linear_range}) {
    if (x < axes.least || x > axes.greatest) continue;
    series.x.insert(series.x.end(), {x, x});
    series.y.insert(series.y.end(), {0, axes.fraction});
  }
  return series;
}

std::string beyond_text(const StrainHistogram& strain) {
  std::string text;
  for (const StrainHistogram::Beyond& each : strain.beyond) {
    char fraction[32];
    std::snprintf(fraction, sizeof fraction, "%.1f", 100 * each.fraction);
    text += "; " + std::string(fraction) + " % of " + each.region + " beyond";
  }
  return text;
}

PlotPanel panel_of(const Model& model, const StepRecord& step, const StrainAxes& axes) {
  PlotPanel panel;
  panel.title = commands_title(model, step.actuation) + beyond_text(step.strain);
  panel.x.label = "principal strain [%]";
  panel.y.label = "fraction of volume [%]";
  panel.x.low = axes.least;
  panel.x.high = axes.greatest;
  panel.y.low = 0;
  panel.y.high = axes.fraction;
  panel.series.push_back(outline(step.strain));
  std::set<double> ranges;
  for (const StrainHistogram::Beyond& each : step.strain.beyond) ranges.insert(each.linear_range);
  for (const double range : ranges)
    if (PlotSeries series = limits(range, axes); !series.x.empty()) panel.series.push_back(std::move(series));
  return panel;
}

/// At most so many, evenly spread, the first and the last among them.
std::vector<const StepRecord*> spread(const std::vector<const StepRecord*>& steps, std::size_t most) {
  if (steps.size() <= most) return steps;
  std::vector<const StepRecord*> chosen;
  for (std::size_t i = 0; i < most; ++i) chosen.push_back(steps[i * (steps.size() - 1) / (most - 1)]);
  return chosen;
}

}  // namespace

std::string commands_title(const Model& model, const Actuation& actuation, int digits) {
  std::string title;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    title += (title.empty() ? "" : ", ") + actuator.name + " = " + command_text(actuator, actuation[a], digits) +
             (actuator.control == Control::ratio ? " [-]" : "");
  }
  return title;
}

Plot plot_of_strains(const Model& model, const std::vector<StepRecord>& steps, const std::string& title) {
  std::vector<const StepRecord*> known, strained;
  for (const StepRecord& step : steps) {
    if (step.strain.fractions.empty() || !std::isfinite(step.strain.percentile_95)) continue;
    known.push_back(&step);
    if (step.strain.percentile_95 > at_rest) strained.push_back(&step);
  }
  known = spread(strained.empty() ? known : strained, max_histograms);
  StrainAxes axes;
  for (const StepRecord* step : known) axes.cover(step->strain);
  Plot plot;
  plot.title = title;
  for (const StepRecord* step : known) {
    if (plot.rows.empty() || plot.rows.back().size() == histograms_in_a_row) plot.rows.emplace_back();
    plot.rows.back().push_back(panel_of(model, *step, axes));
  }
  if (plot.rows.empty()) plot.rows = {{PlotPanel{}}};
  return plot;
}

}  // namespace softkin::runs
