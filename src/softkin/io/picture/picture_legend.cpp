#include <algorithm>
#include <charconv>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/io/picture/picture_legend.hpp>
#include <softkin/io/plot/svg_axis.hpp>
#include <softkin/io/wrapped_lines.hpp>

namespace softkin {

namespace {

using Place = Canvas::Place;

constexpr int legend_width = 320, legend_height = 240;  // the smallest picture with a legend [pixel]
constexpr Rgb ink{0.13, 0.13, 0.15}, grey{0.45, 0.45, 0.48};
constexpr std::array<Rgb, 3> axis_colors{{{0.80, 0.20, 0.15}, {0.15, 0.52, 0.22}, {0.13, 0.35, 0.75}}};
constexpr int max_bar_ticks = 6, max_title_lines = 3;
// of the legend, in cells of the font
constexpr double margin = 10, title_cell = 1.25, title_height = 24, footer_height = 46;
constexpr double bar_width = 9, tick_gap = 5, tick_length = 2.5, label_gap = 8, cap = 7;
constexpr double axis_length = 15, letter_distance = 6.5;
constexpr double title_step = 14;  // from line to line of the title

/// Texts of the ticks: with as many digits as are needed to distinguish them.
std::string tick_text(double value, double low, double high) {
  const double size = std::max(std::abs(low), std::abs(high));
  const double range = low < high ? std::min(high - low, size) : size;
  if (size == 0) return "0";
  const int leading = static_cast<int>(std::floor(std::log10(range)));
  if (size >= 1e6 || leading < -4) {
    const int digits = std::clamp(static_cast<int>(std::floor(std::log10(size))) - leading + 2, 2, 16);
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::scientific, digits).ptr};
  }
  return decimal(value, std::max(0, 2 - leading));
}

}  // namespace

PictureLegend::PictureLegend(const PictureOptions& options, const Interval& values, const Mat3& camera)
    : options_(options),
      values_(values),
      camera_(camera),
      shown_(options.width >= legend_width && options.height >= legend_height),
      cell_(std::max(1.0, std::min(options.width / 640.0, options.height / 400.0))) {}

Area PictureLegend::area() const {
  if (!shown_) return {{0, 0}, {double(options_.width), double(options_.height)}};
  const double top =
      (options_.title.empty() ? margin : title_height + title_step * static_cast<double>(title_lines().size() - 1)) *
      cell_;
  const double right = margin * cell_ + (has_values() ? color_bar_space() : 0);
  return {{margin * cell_, top}, {options_.width - right, options_.height - footer_height * cell_}};
}

void PictureLegend::draw(double pixels_per_mm, RgbImage& image) const {
  if (!shown_) return;
  Canvas canvas(image);
  draw_title(canvas);
  if (has_values()) draw_color_bar(canvas);
  draw_scale_bar(pixels_per_mm, canvas);
  draw_axes(canvas);
}

std::vector<std::string> PictureLegend::title_lines() const {
  const double width = options_.width - 2 * margin * cell_;
  return wrapped_lines(options_.title, max_title_lines,
                       [&](const std::string& line) { return Canvas::text_width(line, title_cell * cell_) <= width; });
}

void PictureLegend::draw_title(Canvas& canvas) const {
  if (options_.title.empty()) return;
  const double size = title_cell * cell_;
  double y = 14 * cell_;
  for (const std::string& line : title_lines()) {
    const std::string fitted = Canvas::fitted(line, size, options_.width - 2 * margin * cell_);
    canvas.text({options_.width / 2.0, y}, fitted, size, ink, Canvas::Anchor::middle);
    y += title_step * cell_;
  }
}

/// At round numbers; one tick for equal values, and one at both ends where no round numbers distinguish them.
std::vector<PictureLegend::Tick> PictureLegend::ticks() const {
  const auto& [low, high] = values_;
  if (!(low < high)) return {{0, tick_text(low, low, high)}};
  constexpr double rounding = 1e-12;
  const bool is_drawable = 2 * values_.half_length() <= std::numeric_limits<double>::max() &&
                           high - low > rounding * std::max(std::abs(low), std::abs(high));
  if (!is_drawable) return {{0, tick_text(low, low, high)}, {1, tick_text(high, low, high)}};
  std::vector<Tick> all;
  const AxisTicks round = round_ticks({low, high}, max_bar_ticks, false);
  for (std::size_t i = 0; i < round.values.size(); ++i)
    all.push_back({std::clamp((round.values[i] - low) / (high - low), 0.0, 1.0), round.labels[i]});
  return all;
}

/// What the colour bar with its texts takes at the right [pixel].
double PictureLegend::color_bar_space() const {
  double longest = 0;
  for (const Tick& tick : ticks()) longest = std::max(longest, Canvas::text_width(tick.text, cell_));
  const double cells = bar_width + tick_gap + margin + (options_.value_label.empty() ? 0 : label_gap + cap);
  return cells * cell_ + longest;
}

void PictureLegend::draw_color_bar(Canvas& canvas) const {
  const auto [low_end, high_end] = area();
  const double left = std::round(high_end.x() + margin * cell_), right = left + std::round(bar_width * cell_);
  const double top = std::round(low_end.y() + margin * cell_), bottom = std::round(high_end.y() - margin * cell_);
  for (double y = top; y < bottom; ++y)
    canvas.fill({left, y}, {right, y + 1}, mapped_color((bottom - 1 - y) / (bottom - 1 - top)));
  const double thin = 0.5 * cell_;  // the frame stands just outside
  const Place low(left - thin / 2, top - thin / 2), high(right + thin / 2, bottom + thin / 2);
  const Place corner(high.x(), low.y()), opposite(low.x(), high.y());
  canvas.strokes({{low, corner}, {corner, high}, {high, opposite}, {opposite, low}}, thin, ink);
  for (const auto& [fraction, text] : ticks()) {
    const double y = bottom - fraction * (bottom - top);
    canvas.strokes({{{right, y}, {right + tick_length * cell_, y}}}, thin, ink);
    canvas.text({right + tick_gap * cell_, y}, text, cell_, ink);
  }
  const std::string label = Canvas::fitted(options_.value_label, cell_, bottom - top);
  canvas.text({options_.width - (margin + cap / 2) * cell_, (top + bottom) / 2}, label, cell_, ink,
              Canvas::Anchor::middle, true);
}

void PictureLegend::draw_scale_bar(double pixels_per_mm, Canvas& canvas) const {
  const auto [low, high] = area();
  const double length = round_length(0.22 * (high.x() - low.x()) / pixels_per_mm);
  const double half = length * pixels_per_mm / 2, tick = 2.5 * cell_;
  const Place middle((low.x() + high.x()) / 2, options_.height - (margin + 3) * cell_);
  const Place left = middle - Place(half, 0), right = middle + Place(half, 0), up(0, tick);
  canvas.strokes({{left, right}, {left - up, left + up}, {right - up, right + up}}, 0.8 * cell_, ink);
  canvas.text(middle - Place(0, 8 * cell_), number(length) + " mm", cell_, ink, Canvas::Anchor::middle);
}

void PictureLegend::draw_axes(Canvas& canvas) const {
  const double reach = (axis_length + letter_distance) * cell_;
  const Place origin(reach + margin * cell_, options_.height - reach - margin / 2 * cell_);
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return camera_(2, a) < camera_(2, b); });
  for (const int i : order) {
    const Place along = camera_.col(i).head<2>();
    const Place tip = origin + axis_length * cell_ * along;
    canvas.strokes({{origin, tip}}, 1.2 * cell_, axis_colors[i]);
    // an axis along the line of sight has its letter below the origin, beside the other axes
    const Place side = along.norm() > 0.2 ? Place(along.normalized()) : Place(-0.7, 0.7);
    const std::string letter(1, static_cast<char>('x' + i));
    const Place middle = tip + letter_distance * cell_ * side + Place(0.5 * cell_, -1 * cell_);
    canvas.text(middle, letter, cell_, axis_colors[i], Canvas::Anchor::middle);
  }
  canvas.strokes({{origin, origin}}, 2 * cell_, grey);
}

}  // namespace softkin
