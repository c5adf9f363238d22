#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <softkin/io/plot/svg_canvas.hpp>
#include <softkin/io/plot/svg_panel.hpp>

namespace softkin {

namespace {

constexpr double text_size = 12, title_size = 13, tick_size = 11;  // [pixel]
constexpr double title_room = 20, legend_line = 17, label_height = 18, tick_mark = 4;
constexpr double sample_length = 30, sample_gap = 6, entry_gap = 16;  // of the legend
constexpr double label_room = 14;                                     // between the labels of ticks
constexpr double min_equal_height = 110;

// colours of one lightness would be one grey: these differ in lightness, the dashes and marks in form
constexpr std::array<const char*, 6> colors{"#0b5394", "#c2410c", "#15803d", "#7e22ce", "#000000", "#0891b2"};
constexpr std::array<const char*, 6> dashes{"", "7 3", "2 2.5", "9 3 2 3", "13 4", "5 2 1.5 2 1.5 2"};
constexpr const char *frame_color = "#000000", *grid_color = "#e2e2e2", *paper_color = "#ffffff",
                     *pale_color = "#b4b4b4";

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void cover(const std::vector<double>& values) {
    for (const double value : values) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  [[nodiscard]] bool empty() const { return !(low <= high); }
};

AxisRange range_of(const PlotAxis& axis, Extent extent) {
  if (axis.low) extent.cover({*axis.low});
  if (axis.high) extent.cover({*axis.high});
  if (extent.empty()) extent = axis.logarithmic ? Extent{1, 10} : Extent{0, 1};
  AxisRange range = range_around(extent.low, extent.high, axis.logarithmic);
  if (axis.low && (!axis.logarithmic)) range.low = *axis.low;
  if (axis.high && (!axis.logarithmic)) range.high = *axis.high;
  if (!(range.low < range.high)) range = range_around(range.low, range.low, false);
  return range;
}

double widest(const std::vector<std::string>& labels) {
  double width = 0;
  for (const std::string& label : labels) width = std::max(width, svg_text_width(label, tick_size));
  return width;
}

AxisTicks ticks_of(const PlotAxis& axis, const AxisRange& range, double most) {
  const int count = static_cast<int>(std::clamp(most, 5.0, 12.0));
  return axis.logarithmic ? decade_ticks(range, count) : round_ticks(range, count, axis.whole);
}

/// Of axes of equal units, one along which the data do not extend takes its size from the other.
void flatten(AxisRange& x_range, const Extent& x, AxisRange& y_range, const Extent& y) {
  constexpr double flat = 1e-6;
  const double width = x.high - x.low, height = y.high - y.low, half = 0.05 * std::max(width, height);
  if (width < flat * height) x_range = {x.low - half, x.low + half};
  if (height < flat * width) y_range = {y.low - half, y.low + half};
}

/// Widens a range about its middle.
void widen(AxisRange& range, double extent) {
  const double half = extent / 2, middle = range.low + (range.high - range.low) / 2;
  range = {middle - half, middle + half};
}

}  // namespace

void SvgPanel::Heights::cover(const Heights& other) {
  title = std::max(title, other.title);
  legend = std::max(legend, other.legend);
  frame = std::max(frame, other.frame);
  below = std::max(below, other.below);
}

SvgPanel::SvgPanel(const PlotPanel& panel, double width, double frame_height) : panel_(panel), width_(width) {
  heights_.title = panel.title.empty() ? 0 : title_room;
  heights_.frame = frame_height;
  heights_.below = tick_mark + 2 + tick_size + (panel.x.label.empty() ? 0 : label_height);
  arrange_axes();
  if (panel.equal) {
    const double wanted = frame_width() * (y_range_.high - y_range_.low) / (x_range_.high - x_range_.low);
    heights_.frame = std::clamp(wanted, std::min(min_equal_height, frame_height), frame_height);
  }
  arrange_legend();
}

void SvgPanel::correct(const Heights& heights) {
  heights_ = heights;
  arrange_axes();
  if (panel_.equal) equalize();
}

void SvgPanel::arrange_axes() {
  Extent x, y;
  for (const PlotSeries& series : panel_.series) {
    x.cover(series.x);
    y.cover(series.y);
  }
  x_range_ = range_of(panel_.x, x);
  y_range_ = range_of(panel_.y, y);
  if (panel_.equal && !x.empty()) flatten(x_range_, x, y_range_, y);
  find_y_ticks();
  find_x_ticks();
}

/// Widens one of the ranges until a pixel is as long along x as along y.
void SvgPanel::equalize() {
  for (int pass = 0; pass < 2; ++pass) {  // labels of ticks take room from the frame
    const double x = x_range_.high - x_range_.low, y = y_range_.high - y_range_.low;
    const double unit = std::max(x / frame_width(), y / heights_.frame);
    widen(x_range_, unit * frame_width());
    widen(y_range_, unit * heights_.frame);
    const double left = left_;
    find_y_ticks();
    left_ = std::max(left, left_);
    find_x_ticks();
  }
}

void SvgPanel::find_y_ticks() {
  y_ticks_ = ticks_of(panel_.y, y_range_, heights_.frame / 32);
  left_ = (panel_.y.label.empty() ? 0 : label_height) + widest(y_ticks_.labels) + tick_mark + 4;
}

void SvgPanel::find_x_ticks() {
  right_ = 0;
  for (double most = frame_width() / 50; most >= 5; --most) {
    x_ticks_ = ticks_of(panel_.x, x_range_, most);
    const double room = frame_width() / static_cast<double>(x_ticks_.values.size());
    if (widest(x_ticks_.labels) + label_room <= room) break;
  }
  if (x_ticks_.values.empty() || frame_width() / 50 < 5) x_ticks_ = ticks_of(panel_.x, x_range_, 5);
  const AxisScale scale{x_range_, 0, frame_width(), panel_.x.logarithmic};
  if (!x_ticks_.values.empty()) {  // half the last label may stand beyond the frame
    const double beyond =
        scale.at(x_ticks_.values.back()) + svg_text_width(x_ticks_.labels.back(), tick_size) / 2 - frame_width();
    right_ = std::max(0.0, beyond);
  }
}

int SvgPanel::style_of(std::size_t series) const {
  const int style = panel_.series[series].style;
  return style >= 0 ? style : static_cast<int>(series);
}

SvgStroke SvgPanel::stroke_of(std::size_t series) const {
  if (panel_.series[series].pale) return {pale_color, panel_.series[series].width, "", "none"};
  const std::size_t style = style_of(series);
  return {colors[style % colors.size()], panel_.series[series].width, dashes[style % dashes.size()], "none"};
}

void SvgPanel::arrange_legend() {
  double x = 0;
  int line = 0;
  for (std::size_t i = 0; i < panel_.series.size(); ++i) {
    if (panel_.series[i].label.empty()) continue;
    const double before = sample_length + sample_gap;
    const std::string text = svg_fitted(panel_.series[i].label, text_size, width_ - before);
    const double needed = before + svg_text_width(text, text_size);
    if (x > 0 && x + needed > width_) {
      x = 0;
      ++line;
    }
    legend_.push_back({i, text, x, line});
    x += needed + entry_gap;
  }
  heights_.legend = legend_.empty() ? 0 : legend_line * (line + 1) + 3;
}

void SvgPanel::draw(SvgCanvas& canvas, SvgPoint corner, int number) const {
  canvas.open("panel");
  draw_title(canvas, corner);
  draw_legend(canvas, {corner.x, corner.y + heights_.title});
  const SvgPoint low{corner.x + left_, corner.y + heights_.title + heights_.legend};
  const SvgPoint high{low.x + frame_width(), low.y + heights_.frame};
  draw_axes(canvas, low, high);
  draw_series(canvas, low, high, number);
  canvas.rectangle(low, high, {frame_color, 1, "", "none"}, "frame");
  canvas.close();
}

void SvgPanel::draw_title(SvgCanvas& canvas, SvgPoint corner) const {
  if (panel_.title.empty()) return;
  canvas.text({{corner.x + left_ + frame_width() / 2, corner.y + title_size},
               svg_fitted(panel_.title, title_size * svg_bold, frame_width()),
               title_size,
               SvgAnchor::middle,
               true});
}

void SvgPanel::draw_legend(SvgCanvas& canvas, SvgPoint corner) const {
  canvas.open("legend");
  for (const Entry& entry : legend_) {
    const PlotSeries& series = panel_.series[entry.series];
    const double x = corner.x + entry.x, y = corner.y + legend_line * entry.line + legend_line / 2;
    SvgStroke stroke = stroke_of(entry.series);
    if (series.line) canvas.line({x, y}, {x + sample_length, y}, stroke);
    stroke = {stroke.color, 1.2, "", paper_color};
    if (series.marks)
      canvas.marks({{x + sample_length / 2, y}}, style_of(entry.series) % svg_mark_shapes, series.mark_radius, stroke);
    canvas.text({{x + sample_length + sample_gap, y + 0.35 * text_size}, entry.text, text_size});
  }
  canvas.close();
}

void SvgPanel::draw_axes(SvgCanvas& canvas, SvgPoint low, SvgPoint high) const {
  const AxisScale x{x_range_, low.x, high.x, panel_.x.logarithmic}, y{y_range_, high.y, low.y, panel_.y.logarithmic};
  const SvgStroke faint{grid_color, 1, "", "none"}, black{frame_color, 1, "", "none"};
  canvas.open("x-axis");
  for (std::size_t i = 0; i < x_ticks_.values.size(); ++i) {
    const double at = x.at(x_ticks_.values[i]);
    canvas.line({at, low.y}, {at, high.y}, faint);
    canvas.line({at, high.y}, {at, high.y + tick_mark}, black);
    canvas.text({{at, high.y + tick_mark + 2 + 0.85 * tick_size}, x_ticks_.labels[i], tick_size, SvgAnchor::middle});
  }
  const double below = high.y + tick_mark + 2 + tick_size;
  if (!panel_.x.label.empty())
    canvas.text({{(low.x + high.x) / 2, below + text_size + 2},
                 svg_fitted(panel_.x.label, text_size, frame_width()),
                 text_size,
                 SvgAnchor::middle});
  canvas.close();
  canvas.open("y-axis");
  for (std::size_t i = 0; i < y_ticks_.values.size(); ++i) {
    const double at = y.at(y_ticks_.values[i]);
    canvas.line({low.x, at}, {high.x, at}, faint);
    canvas.line({low.x - tick_mark, at}, {low.x, at}, black);
    canvas.text({{low.x - tick_mark - 3, at + 0.35 * tick_size}, y_ticks_.labels[i], tick_size, SvgAnchor::end});
  }
  if (!panel_.y.label.empty())
    canvas.text({{low.x - left_ + text_size, (low.y + high.y) / 2},
                 svg_fitted(panel_.y.label, text_size, heights_.frame),
                 text_size,
                 SvgAnchor::middle,
                 false,
                 true});
  canvas.close();
}

void SvgPanel::draw_series(SvgCanvas& canvas, SvgPoint low, SvgPoint high, int number) const {
  const AxisScale x{x_range_, low.x, high.x, panel_.x.logarithmic}, y{y_range_, high.y, low.y, panel_.y.logarithmic};
  const std::string clip = "frame" + std::to_string(number);
  canvas.clip(clip, low, high);
  for (std::size_t i = 0; i < panel_.series.size(); ++i) {
    const PlotSeries& series = panel_.series[i];
    std::vector<SvgPoint> points;
    for (std::size_t k = 0; k < series.x.size(); ++k) points.push_back({x.at(series.x[k]), y.at(series.y[k])});
    canvas.open("series", "clip-path=\"url(#" + clip + ")\"");
    SvgStroke stroke = stroke_of(i);
    if (series.line && series.pairs)
      canvas.segments(points, stroke);
    else if (series.line && points.size() > 1)
      canvas.polyline(thinned_line(points), stroke);
    stroke = {stroke.color, 1.2, "", paper_color};
    const bool alone = !series.line || points.size() == 1;
    if (!points.empty() && (series.marks || alone))
      canvas.marks(alone ? apart_on_grid(points) : apart_along(points, 4 * series.mark_radius),
                   style_of(i) % svg_mark_shapes, series.mark_radius, stroke);
    canvas.close();
  }
}

}  // namespace softkin
