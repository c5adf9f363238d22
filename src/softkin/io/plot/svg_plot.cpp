#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/plot/svg_panel.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/wrapped_lines.hpp>

namespace softkin {

namespace {

constexpr double plot_margin = 14, gap = 18, heading_size = 15, heading_height = 26, heading_step = 19;  // [pixel]
constexpr double largest_extent = 1e300;  // beyond it extents overflow

[[noreturn]] void refuse(const std::string& where, const std::string& why) {
  throw InvalidInput("plot: " + where + ": " + why);
}

std::string name_of(const PlotPanel& panel, std::size_t number) {
  if (!panel.title.empty()) return "panel " + excerpt(panel.title);
  return "panel " + std::to_string(number);
}

void check_values(const std::vector<double>& values, const PlotAxis& axis, const std::string& where) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(std::abs(values[i]) <= largest_extent))
      refuse(where,
             "value " + std::to_string(i) + " along " + excerpt(axis.label) + " is not a number that can be drawn");
    if (axis.logarithmic && !(values[i] >= 1 / largest_extent))
      refuse(where, "value " + std::to_string(i) + " along " + excerpt(axis.label) +
                        " is not > 0, so a logarithmic axis cannot show it");
  }
}

void check_axis(const PlotAxis& axis, const std::string& where) {
  for (const auto& end : {axis.low, axis.high})
    if (end) check_values({*end}, axis, where);
  if (axis.low && axis.high && !(*axis.low < *axis.high))
    refuse(where, "the ends of the axis " + excerpt(axis.label) + " do not ascend");
}

void check_panel(const PlotPanel& panel, const std::string& where) {
  if (panel.equal && (panel.x.logarithmic || panel.y.logarithmic))
    refuse(where, "axes of equal units cannot be logarithmic");
  check_axis(panel.x, where);
  check_axis(panel.y, where);
  for (const PlotSeries& series : panel.series) {
    const std::string at = where + ", series " + excerpt(series.label);
    if (series.x.size() != series.y.size())
      refuse(at, std::to_string(series.x.size()) + " values along x, " + std::to_string(series.y.size()) + " along y");
    if (!(series.width > 0 && series.mark_radius > 0 && series.width <= 100 && series.mark_radius <= 100))
      refuse(at, "width and radius must be > 0 and <= 100 pixels");
    check_values(series.x, panel.x, at);
    check_values(series.y, panel.y, at);
  }
}

void check_plot(const Plot& plot) {
  if (!(plot.width >= 300 && plot.width <= 10000)) refuse("width", "must be 300 to 10000 pixels");
  if (!(plot.panel_height >= 80 && plot.panel_height <= 5000)) refuse("panel_height", "must be 80 to 5000 pixels");
  if (plot.rows.empty()) refuse("rows", "there is no panel");
  std::size_t number = 0;
  for (const auto& row : plot.rows) {
    if (row.empty()) refuse("rows", "a row has no panel");
    if ((plot.width - 2 * plot_margin) / static_cast<double>(row.size()) < 180)
      refuse("rows", std::to_string(row.size()) + " panels side by side are too many for the width");
    for (const PlotPanel& panel : row) check_panel(panel, name_of(panel, number++));
  }
}

struct PanelRow {
  std::vector<SvgPanel> panels;
  double height = 0;
};

PanelRow row_of(const Plot& plot, const std::vector<PlotPanel>& panels) {
  const auto count = static_cast<double>(panels.size());
  const double width = (plot.width - 2 * plot_margin - gap * (count - 1)) / count;
  PanelRow row;
  SvgPanel::Heights heights;
  for (const PlotPanel& panel : panels) {
    row.panels.emplace_back(panel, width, plot.panel_height);
    heights.cover(row.panels.back().heights());
  }
  for (SvgPanel& panel : row.panels) panel.correct(heights);
  row.height = heights.all();
  return row;
}

constexpr std::size_t max_heading_lines = 4;

/// Of the heading; none without a title.
std::vector<std::string> heading_lines(const Plot& plot) {
  if (plot.title.empty()) return {};
  return wrapped_lines(plot.title, max_heading_lines, [&](const std::string& line) {
    return svg_text_width(line, heading_size * svg_bold) <= plot.width - 2 * plot_margin;
  });
}

}  // namespace

std::string svg_text(const Plot& plot) {
  check_plot(plot);
  const std::vector<std::string> heading = heading_lines(plot);
  std::vector<PanelRow> rows;
  const double heading_room =
      heading.empty() ? 0 : heading_height + heading_step * static_cast<double>(heading.size() - 1);
  double height = plot_margin + heading_room;
  for (const auto& panels : plot.rows) {
    rows.push_back(row_of(plot, panels));
    height += rows.back().height + gap;
  }
  SvgCanvas canvas(plot.width, height - gap + plot_margin, plot.title);
  double y = plot_margin;
  for (std::size_t i = 0; i < heading.size(); ++i)
    canvas.text({{plot.width / 2, y + heading_size + heading_step * static_cast<double>(i)},
                 svg_fitted(heading[i], heading_size * svg_bold, plot.width - 2 * plot_margin),
                 heading_size,
                 SvgAnchor::middle,
                 true});
  y += heading_room;
  int number = 0;
  for (PanelRow& row : rows) {
    double x = plot_margin;
    for (SvgPanel& panel : row.panels) {
      panel.draw(canvas, {x, y}, number++);
      x += panel.width() + gap;
    }
    y += row.height + gap;
  }
  return canvas.finish();
}

void write_svg(const std::filesystem::path& path, const Plot& plot) {
  write_file(path, svg_text(plot));
}

}  // namespace softkin
