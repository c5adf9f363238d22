#include <algorithm>
#include <charconv>
#include <cmath>
#include <softkin/io/picture/color_map.hpp>
#include <softkin/io/picture/picture_legend.hpp>
#include <vector>

namespace softkin {

namespace {

using Place = Canvas::Place;
using Anchor = Canvas::Anchor;

constexpr Rgb ink{0.13, 0.13, 0.15}, grey{0.45, 0.45, 0.48};
constexpr std::array<Rgb, 3> axis_colors{{{0.80, 0.20, 0.15}, {0.15, 0.52, 0.22}, {0.13, 0.35, 0.75}}};
constexpr int ticks = 5;
// in cells of the font
constexpr double margin = 10, title_cell = 1.25, title_height = 24, footer_height = 46;
constexpr double bar_width = 9, tick_gap = 5, tick_length = 2.5, label_gap = 8, cap = 7;
constexpr double axis_length = 15, letter_distance = 6.5;

/// Size of a cell of the font [pixel].
double cell_of(int width, int height) {
  return std::max(1.0, std::min(width / 640.0, height / 400.0));
}

std::string number(double value, int decimals, std::chars_format format) {
  char buffer[400];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, format, decimals).ptr;
  return {buffer, end};
}

/// Texts of the ticks: as many digits as tell them apart.
std::string tick_text(double value, double low, double high) {
  const double size = std::max(std::abs(low), std::abs(high));
  const double range = low < high ? std::min(high - low, size) : size;
  if (size == 0) return "0";
  const int leading = static_cast<int>(std::floor(std::log10(range)));
  if (size >= 1e6 || leading < -4) {
    const int digits = static_cast<int>(std::floor(std::log10(size))) - leading + 2;
    return number(value, std::clamp(digits, 2, 16), std::chars_format::scientific);
  }
  const int decimals = std::max(0, 2 - leading);
  const bool zero = std::abs(value) < 0.5 * std::pow(10, -decimals);
  return number(zero ? 0 : value, decimals, std::chars_format::fixed);
}

/// One where all values are equal.
std::vector<std::string> tick_texts(const PictureLegend& legend) {
  std::vector<std::string> texts;
  const bool constant = !(legend.low < legend.high);
  for (int i = 0; i < (constant ? 1 : ticks); ++i) {
    const double share = double(i) / (ticks - 1);
    texts.push_back(tick_text((1 - share) * legend.low + share * legend.high, legend.low, legend.high));
  }
  return texts;
}

/// What the colour bar with its texts takes at the right [pixel].
double color_bar_space(const PictureLegend& legend, double cell) {
  double longest = 0;
  for (const std::string& text : tick_texts(legend)) longest = std::max(longest, Canvas::text_width(text, cell));
  const double cells = bar_width + tick_gap + margin + (legend.label.empty() ? 0 : label_gap + cap);
  return cells * cell + longest;
}

void draw_color_bar(const PictureLegend& legend, const PictureArea& area, double cell, int width, Canvas& canvas) {
  const double left = std::round(area.high.x() + margin * cell), right = left + std::round(bar_width * cell);
  const double top = std::round(area.low.y() + margin * cell), bottom = std::round(area.high.y() - margin * cell);
  for (double y = top; y < bottom; ++y) {
    canvas.fill({left, y}, {right, y + 1}, mapped_color((bottom - 1 - y) / (bottom - 1 - top)));
  }
  const double thin = 0.5 * cell;  // the frame stands just outside
  const Place low(left - thin / 2, top - thin / 2), high(right + thin / 2, bottom + thin / 2);
  const Place corner(high.x(), low.y()), opposite(low.x(), high.y());
  canvas.strokes({{low, corner}, {corner, high}, {high, opposite}, {opposite, low}}, thin, ink);
  double y = bottom;
  for (const std::string& text : tick_texts(legend)) {
    canvas.strokes({{{right, y}, {right + tick_length * cell, y}}}, thin, ink);
    canvas.text({right + tick_gap * cell, y}, text, cell, ink);
    y -= (bottom - top) / (ticks - 1);
  }
  const std::string label = Canvas::fitted(legend.label, cell, bottom - top);
  canvas.text({width - (margin + cap / 2) * cell, (top + bottom) / 2}, label, cell, ink, Anchor::middle, true);
}

void draw_scale_bar(const PictureLegend& legend, const PictureArea& area, double cell, int height, Canvas& canvas) {
  const double length = round_length(0.22 * (area.high.x() - area.low.x()) / legend.pixels_per_mm);
  const double half = length * legend.pixels_per_mm / 2, tick = 2.5 * cell;
  const Place middle((area.low.x() + area.high.x()) / 2, height - (margin + 3) * cell);
  const Place left = middle - Place(half, 0), right = middle + Place(half, 0), up(0, tick);
  canvas.strokes({{left, right}, {left - up, left + up}, {right - up, right + up}}, 0.8 * cell, ink);
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, length, std::chars_format::general, 6).ptr;
  canvas.text(middle - Place(0, 8 * cell), std::string(buffer, end) + " mm", cell, ink, Anchor::middle);
}

void draw_axes(const PictureLegend& legend, double cell, int height, Canvas& canvas) {
  const double reach = (axis_length + letter_distance) * cell;
  const Place origin(reach + margin * cell, height - reach - margin / 2 * cell);
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return legend.axes[a].z() < legend.axes[b].z(); });
  for (const int i : order) {
    const Place along = legend.axes[i].head<2>();
    const Place tip = origin + axis_length * cell * along;
    canvas.strokes({{origin, tip}}, 1.2 * cell, axis_colors[i]);
    // an axis along the line of sight has its letter below the origin, beside the other axes
    const Place side = along.norm() > 0.2 ? Place(along.normalized()) : Place(-0.7, 0.7);
    const std::string letter(1, static_cast<char>('x' + i));
    const Place middle = tip + letter_distance * cell * side + Place(0.5 * cell, -1 * cell);
    canvas.text(middle, letter, cell, axis_colors[i], Anchor::middle);
  }
  canvas.strokes({{origin, origin}}, 2 * cell, grey);
}

}  // namespace

double round_length(double limit) {
  const double power = std::pow(10, std::floor(std::log10(limit)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= limit) return factor * power;
  }
  return power;
}

PictureArea drawing_area(const PictureLegend& legend, int width, int height) {
  if (!legend.shown) return {{0, 0}, {double(width), double(height)}};
  const double cell = cell_of(width, height);
  const double top = (legend.title.empty() ? margin : title_height) * cell;
  const double right = margin * cell + (legend.values ? color_bar_space(legend, cell) : 0);
  return {{margin * cell, top}, {width - right, height - footer_height * cell}};
}

void draw_legend(const PictureLegend& legend, RgbImage& image) {
  if (!legend.shown) return;
  Canvas canvas(image);
  const double cell = cell_of(image.width, image.height);
  const PictureArea area = drawing_area(legend, image.width, image.height);
  if (!legend.title.empty()) {
    const double size = title_cell * cell;
    const std::string title = Canvas::fitted(legend.title, size, image.width - 2 * margin * cell);
    canvas.text({image.width / 2.0, 14 * cell}, title, size, ink, Anchor::middle);
  }
  if (legend.values) draw_color_bar(legend, area, cell, image.width, canvas);
  draw_scale_bar(legend, area, cell, image.height, canvas);
  draw_axes(legend, cell, image.height, canvas);
}

}  // namespace softkin
