#include <softkin/io/plot/curves.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/plots.hpp>
#include <utility>

namespace softkin::runs {

namespace {

/// Drawn along the steps in a panel of its own.
PlotPanel panel_of(const StepAxis& along, const std::string& label) {
  PlotPanel panel;
  panel.x = along.axis;
  panel.y.label = label;
  return panel;
}

PlotSeries series_of(const StepAxis& along, const std::string& label, const std::vector<WalkRecord>& steps,
                     double WalkStep::*value) {
  PlotSeries series;
  series.label = label;
  series.x = along.values;
  for (const WalkRecord& step : steps) series.y.push_back(step.walk.*value);
  return series;
}

}  // namespace

Plot plot_of_walk(const Model& model, const std::vector<WalkRecord>& steps, const std::string& title) {
  std::vector<std::optional<double>> times;
  for (const WalkRecord& step : steps) times.push_back(step.time_s);
  const StepAxis along = step_axis(times, {});

  PlotPanel feet = panel_of(along, "place [mm]");
  feet.series = {series_of(along, foot_name(model, 0), steps, &WalkStep::rear_mm),
                 series_of(along, foot_name(model, 1), steps, &WalkStep::front_mm)};
  std::vector<StepCurve> commands;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    commands.push_back(command_curve(model.actuators[a]));
    for (const WalkRecord& step : steps) commands.back().values.push_back(step.actuation[static_cast<Index>(a)]);
  }
  Plot plot;
  plot.title = title;
  plot.rows = {{std::move(feet)}, curve_panels(along, commands, "command")};
  if (model.formulation == Formulation::physical) {
    PlotPanel friction = panel_of(along, "friction [N]");
    friction.series = {series_of(along, "", steps, &WalkStep::friction_N)};
    plot.rows.push_back({std::move(friction)});
  }
  return plot;
}

}  // namespace softkin::runs
