#include <softkin/calibration/specimen_report.hpp>
#include <softkin/core/text.hpp>

namespace softkin::calibration {

namespace {

PlotPanel panel_of(const std::string& title, const std::string& x, const std::string& y) {
  PlotPanel panel;
  panel.title = title;
  panel.x.label = x;
  panel.y.label = y;
  return panel;
}

PlotSeries points(const std::string& label, int style = -1) {
  PlotSeries series;
  series.label = label;
  series.line = false;
  series.style = style;
  return series;
}

/// Delta L_1 / Delta L over L_1 / L.
void add_share(PlotSeries& series, const StretchedSpecimen& specimen, double moved_mm) {
  series.x.push_back(specimen.interface_mm / specimen.length_mm);
  series.y.push_back(moved_mm / specimen.stretch_mm);
}

PlotSeries rod_curve(double ratio) {
  PlotSeries series;
  series.label = "rod, E_A / E_B " + decimal(ratio, 2);
  series.marks = false;
  for (int i = 0; i <= 100; ++i) {
    series.x.push_back(0.01 * i);
    series.y.push_back(i == 100 ? 1 : rod_share(ratio, 1, 0.01 * i));
  }
  return series;
}

PlotPanel stretch_panel(const SpecimenResults& results) {
  PlotPanel panel = panel_of("Stretched", "L1 / L [-]", "dL1 / dL [-]");
  panel.series = {rod_curve(results.rod.ratio), points("measured")};
  for (const StretchedSpecimen& s : results.specimens) add_share(panel.series.back(), s, s.interface_moved_mm);
  for (const SimulatedTests& tests : results.simulated) {
    PlotSeries& series = panel.series.emplace_back(points(tests.name));
    for (std::size_t i = 0; i < tests.stretched.size(); ++i)
      add_share(series, results.specimens[i], tests.stretched[i].moved_mm);
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

}  // namespace

Plot specimens_plot(const SpecimenTask& task, const SpecimenResults& results) {
  Plot plot;
  plot.title = "Two materials: " + task.file;
  plot.rows.push_back({stretch_panel(results)});
  if (!results.twists.empty()) plot.rows.back().push_back(twist_panel(results));
  plot.panel_height = 320;
  return plot;
}

}  // namespace softkin::calibration
