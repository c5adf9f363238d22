#pragma once

#include <optional>
#include <softkin/core/types.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin {

/// Values of one kind over the steps of a path.
struct StepCurve {
  std::string name, unit;  // "air", "kPa"; a ratio is "-"
  std::vector<double> values;
};

/// Of an actuator's commands; without values.
[[nodiscard]] StepCurve command_curve(const Actuator& actuator);

/// Along what the steps of a path are drawn.
struct StepAxis {
  PlotAxis axis;
  std::vector<double> values;
  bool command = false;  // the axis is a command
};

/// The times where every step has one; else the only command that changes, where it ascends or descends throughout;
/// else the step's number.
[[nodiscard]] StepAxis step_axis(const std::vector<std::optional<double>>& times,
                                 const std::vector<StepCurve>& commands);

/// A panel for each unit, in the order in which they first appear. what: "command"; its unit is added.
[[nodiscard]] std::vector<PlotPanel> curve_panels(const StepAxis& along, const std::vector<StepCurve>& curves,
                                                  const std::string& what);

/// A curve in space.
struct SpaceCurve {
  std::string name;
  std::vector<Vec3> points;                                     // [mm]
  bool line = true, marks = true, pairs = false, pale = false;  // as those of PlotSeries
  int style = -1;
  double width = PlotSeries().width;
};

/// The one projection that shows all, where the curves lie in a plane across an axis to 1 % of their extent; else as
/// projections.
[[nodiscard]] std::vector<PlotPanel> planar_or_projections(const std::vector<SpaceCurve>& curves);

/// Side by side: seen along y, z and x, a millimetre as long in every direction of a panel.
[[nodiscard]] std::vector<PlotPanel> projections(const std::vector<SpaceCurve>& curves);

}  // namespace softkin
