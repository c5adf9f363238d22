#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/picture/canvas.hpp>
#include <softkin/io/picture/picture.hpp>
#include <softkin/io/picture/rasterizer.hpp>

namespace softkin {

namespace {

constexpr int fewest_pixels = 64, most_pixels = 8192;   // width and height [pixel]
constexpr int legend_width = 320, legend_height = 240;  // the smallest picture with a legend [pixel]
constexpr double filled = 0.9;                          // share of the drawing area that the layers fill
constexpr double no_distance = 0.005;                   // share of the layers' size that is as good as no distance
constexpr double deepest = 1e12;                        // [pixel]
constexpr double shadow = 0.42, highlight = 0.18;       // how much the light darkens and brightens

using Place = Canvas::Place;

constexpr Rgb ink{0.13, 0.13, 0.15}, grey{0.45, 0.45, 0.48};
constexpr std::array<Rgb, 3> axis_colors{{{0.80, 0.20, 0.15}, {0.15, 0.52, 0.22}, {0.13, 0.35, 0.75}}};
constexpr int bar_ticks = 5;  // of the colour bar
// of the legend, in cells of the font
constexpr double margin = 10, title_cell = 1.25, title_height = 24, footer_height = 46;
constexpr double bar_width = 9, tick_gap = 5, tick_length = 2.5, label_gap = 8, cap = 7;
constexpr double axis_length = 15, letter_distance = 6.5;

/// Smallest and largest of what was given; low > high: nothing yet.
struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Halves keep the difference of huge numbers finite.
  [[nodiscard]] double half_length() const { return high / 2 - low / 2; }
  [[nodiscard]] double middle() const { return high / 2 + low / 2; }
};

class Checker {
 public:
  explicit Checker(const std::filesystem::path& path) : origin_{path.string()} {}

  [[noreturn]] void refuse(const std::string& message) const { throw InvalidInput(origin_, message); }

  void check(const PictureOptions& options) const {
    for (const auto& [name, pixels] : {std::pair("width", options.width), std::pair("height", options.height)}) {
      if (pixels >= fewest_pixels && pixels <= most_pixels) continue;
      refuse("picture " + std::string(name) + " " + std::to_string(pixels) + " is outside [" +
             std::to_string(fewest_pixels) + ", " + std::to_string(most_pixels) + "] pixels");
    }
  }

  void check(const std::vector<PictureLayer>& layers) const {
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      check(layers[i], "picture layer " + std::to_string(i) + ": ");
      triangles += layers[i].triangles.size();
    }
    if (triangles == 0) refuse("a picture needs at least one triangle");
  }

  void check(const std::vector<PictureMark>& marks) const {
    for (std::size_t i = 0; i < marks.size(); ++i) {
      const std::string where = "picture mark " + std::to_string(i) + ": ";
      if (marks[i].points.rows() == 0) refuse(where + "it has no point");
      if (!marks[i].points.allFinite()) refuse(where + "a point is not finite");
    }
  }

 private:
  void check(const PictureLayer& layer, const std::string& where) const {
    for (Eigen::Index i = 0; i < layer.points.rows(); ++i)
      if (!layer.points.row(i).allFinite()) refuse(where + "point " + std::to_string(i) + " is not finite");
    const std::size_t points = layer.points.rows();
    if (!layer.values.empty() && layer.values.size() != points)
      refuse(where + std::to_string(layer.values.size()) + " values for " + std::to_string(points) + " points");
    for (std::size_t i = 0; i < layer.values.size(); ++i)
      if (!std::isfinite(layer.values[i])) refuse(where + "value " + std::to_string(i) + " is not finite");
    for (std::size_t i = 0; i < layer.triangles.size(); ++i) {
      for (const Index v : layer.triangles[i]) {
        if (v >= 0 && v < layer.points.rows()) continue;
        refuse(where + "triangle " + std::to_string(i) + " names point " + std::to_string(v) + " of " +
               std::to_string(points));
      }
    }
    for (const double channel : layer.color)
      if (!(channel >= 0 && channel <= 1)) refuse(where + "a colour is outside [0, 1]");
    if (!(layer.opacity > 0 && layer.opacity <= 1)) refuse(where + "opacity is outside (0, 1]");
  }

  Origin origin_;
};

/// Rows: right, down, towards the eye.
Mat3 make_camera(const PictureOptions& options, const Checker& checker) {
  if (!options.view.allFinite() || !options.up.allFinite()) checker.refuse("picture view or up is not finite");
  const Vec3 eye = options.view.stableNormalized(), up = options.up.stableNormalized();
  const Vec3 right = up.cross(eye);
  if (right.norm() < 1e-6) checker.refuse("picture view and up must be neither zero nor parallel");
  Mat3 camera;
  camera.row(0) = right.normalized();
  camera.row(1) = camera.row(0).cross(eye);
  camera.row(2) = eye;
  return camera;
}

template <class Visit>
void for_each_corner(const std::vector<PictureLayer>& layers, const Visit& visit) {
  for (const PictureLayer& layer : layers)
    for (const Triangle& t : layer.triangles)
      for (const Index v : t) visit(layer, v);
}

Interval value_range(const std::vector<PictureLayer>& layers) {
  Interval range;
  for_each_corner(layers, [&](const PictureLayer& layer, Index v) {
    if (!layer.values.empty()) range.include(layer.values[v]);
  });
  return range;
}

/// A part of the picture [pixel].
struct Area {
  Place low, high;
};

/// Texts of the ticks: as many digits as tell them apart.
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

/// What surrounds the drawing: title above, scale bar and axes below, colour bar at the right.
class Legend {
 public:
  Legend(const PictureOptions& options, const Interval& values, const Mat3& camera)
      : options_(options), values_(values), camera_(camera) {}

  /// The part of the picture that is left to the drawing.
  [[nodiscard]] Area area() const {
    if (!shown_) return {{0, 0}, {double(options_.width), double(options_.height)}};
    const double top = (options_.title.empty() ? margin : title_height) * cell_;
    const double right = margin * cell_ + (has_values() ? color_bar_space() : 0);
    return {{margin * cell_, top}, {options_.width - right, options_.height - footer_height * cell_}};
  }

  /// Size of a cell of the font [pixel].
  [[nodiscard]] double cell() const { return cell_; }

  void draw(double pixels_per_mm, RgbImage& image) const {
    if (!shown_) return;
    Canvas canvas(image);
    if (!options_.title.empty()) {
      const double size = title_cell * cell_;
      const std::string title = Canvas::fitted(options_.title, size, options_.width - 2 * margin * cell_);
      canvas.text({options_.width / 2.0, 14 * cell_}, title, size, ink, Canvas::Anchor::middle);
    }
    if (has_values()) draw_color_bar(canvas);
    draw_scale_bar(pixels_per_mm, canvas);
    draw_axes(canvas);
  }

 private:
  [[nodiscard]] bool has_values() const { return values_.low <= values_.high; }

  /// One where all values are equal.
  [[nodiscard]] std::vector<std::string> tick_texts() const {
    const auto& [low, high] = values_;
    std::vector<std::string> texts;
    for (int i = 0; i < (low < high ? bar_ticks : 1); ++i) {
      const double share = double(i) / (bar_ticks - 1);
      texts.push_back(tick_text((1 - share) * low + share * high, low, high));
    }
    return texts;
  }

  /// What the colour bar with its texts takes at the right [pixel].
  [[nodiscard]] double color_bar_space() const {
    double longest = 0;
    for (const std::string& text : tick_texts()) longest = std::max(longest, Canvas::text_width(text, cell_));
    const double cells = bar_width + tick_gap + margin + (options_.value_label.empty() ? 0 : label_gap + cap);
    return cells * cell_ + longest;
  }

  void draw_color_bar(Canvas& canvas) const {
    const auto [low_end, high_end] = area();
    const double left = std::round(high_end.x() + margin * cell_), right = left + std::round(bar_width * cell_);
    const double top = std::round(low_end.y() + margin * cell_), bottom = std::round(high_end.y() - margin * cell_);
    for (double y = top; y < bottom; ++y)
      canvas.fill({left, y}, {right, y + 1}, mapped_color((bottom - 1 - y) / (bottom - 1 - top)));
    const double thin = 0.5 * cell_;  // the frame stands just outside
    const Place low(left - thin / 2, top - thin / 2), high(right + thin / 2, bottom + thin / 2);
    const Place corner(high.x(), low.y()), opposite(low.x(), high.y());
    canvas.strokes({{low, corner}, {corner, high}, {high, opposite}, {opposite, low}}, thin, ink);
    double y = bottom;
    for (const std::string& text : tick_texts()) {
      canvas.strokes({{{right, y}, {right + tick_length * cell_, y}}}, thin, ink);
      canvas.text({right + tick_gap * cell_, y}, text, cell_, ink);
      y -= (bottom - top) / (bar_ticks - 1);
    }
    const std::string label = Canvas::fitted(options_.value_label, cell_, bottom - top);
    canvas.text({options_.width - (margin + cap / 2) * cell_, (top + bottom) / 2}, label, cell_, ink,
                Canvas::Anchor::middle, true);
  }

  void draw_scale_bar(double pixels_per_mm, Canvas& canvas) const {
    const auto [low, high] = area();
    const double length = round_length(0.22 * (high.x() - low.x()) / pixels_per_mm);
    const double half = length * pixels_per_mm / 2, tick = 2.5 * cell_;
    const Place middle((low.x() + high.x()) / 2, options_.height - (margin + 3) * cell_);
    const Place left = middle - Place(half, 0), right = middle + Place(half, 0), up(0, tick);
    canvas.strokes({{left, right}, {left - up, left + up}, {right - up, right + up}}, 0.8 * cell_, ink);
    canvas.text(middle - Place(0, 8 * cell_), number(length) + " mm", cell_, ink, Canvas::Anchor::middle);
  }

  void draw_axes(Canvas& canvas) const {
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

  const PictureOptions& options_;
  const Interval& values_;
  const Mat3& camera_;
  const bool shown_ = options_.width >= legend_width && options_.height >= legend_height;
  const double cell_ = std::max(1.0, std::min(options_.width / 640.0, options_.height / 400.0));
};

/// Where a point of the scene falls on the screen: pixel = scale * (seen - center) + middle.
struct Screen {
  Mat3 camera;
  double scale = 1;  // [pixel / mm]
  double size = 1;   // diagonal of what is drawn [pixel]
  Vec3 center, middle;

  [[nodiscard]] Vec3 at(const Vec3& point) const { return scale * (camera * point - center) + middle; }
};

Screen fit(const std::vector<PictureLayer>& layers, const std::vector<PictureMark>& marks, const Mat3& camera,
           const Area& area, const Checker& checker) {
  std::array<Interval, 3> extent;
  const auto include = [&](const Vec3& point) {
    const Vec3 seen = camera * point;
    for (int k = 0; k < 3; ++k) extent[k].include(seen[k]);
  };
  for_each_corner(layers, [&](const PictureLayer& layer, Index v) { include(layer.points.row(v)); });
  for (const PictureMark& mark : marks)
    for (const auto& point : mark.points.rowwise()) include(point);
  const Place space = filled / 2 * (area.high - area.low);
  const Vec3 half(extent[0].half_length(), extent[1].half_length(), extent[2].half_length());
  Screen screen;
  screen.camera = camera;
  screen.scale = std::min(space.x() / half.x(), space.y() / half.y());
  screen.size = 2 * screen.scale * half.stableNorm();
  screen.center = {extent[0].middle(), extent[1].middle(), extent[2].middle()};
  screen.middle.setZero();
  screen.middle.head<2>() = (area.low + area.high) / 2;
  const double depth = screen.scale * half.z();
  if (!(screen.scale > 0) || !std::isfinite(screen.scale) || !(depth < deepest))
    checker.refuse("the picture's layers have no extent in this view, or one too large to draw");
  return screen;
}

/// Share of white (> 0) or black (< 0) for a normal on the screen; a surface that faces the eye keeps its colour.
double light_on(const Vec3& normal) {
  const Vec3 light = Vec3(-1, -1, 1.8).normalized();  // from the upper left of the eye
  const double gain = (normal.z() < 0 ? -normal : normal).dot(light) - light.z();
  return gain > 0 ? highlight * gain / (1 - light.z()) : shadow * gain;
}

Vec3 normal_of(const ScreenTriangle& triangle) {
  const auto& [a, b, c] = triangle.corners;
  return (b - a).cross(c - a).stableNormalized();
}

std::vector<ScreenTriangle> on_screen(const PictureLayer& layer, const Screen& screen, const Interval& values) {
  std::vector<ScreenTriangle> triangles;
  triangles.reserve(layer.triangles.size());
  for (const Triangle& t : layer.triangles) {
    ScreenTriangle drawn;
    for (int k = 0; k < 3; ++k) drawn.corners[k] = screen.at(layer.points.row(t[k]));
    drawn.light = light_on(normal_of(drawn));
    drawn.color = layer.color;
    drawn.edges = layer.edges;
    if (!layer.values.empty()) {
      drawn.shares.emplace();
      const double half = values.half_length();
      for (int k = 0; k < 3; ++k) (*drawn.shares)[k] = half > 0 ? (layer.values[t[k]] / 2 - values.low / 2) / half : 0;
    }
    triangles.push_back(drawn);
  }
  return triangles;
}

/// A mark with a white rim, so that it shows on any colour.
void draw_mark(const PictureMark& mark, const Screen& screen, double cell, Canvas& canvas) {
  std::vector<Place> places;
  for (const auto& point : mark.points.rowwise()) places.push_back(screen.at(point).head<2>());
  std::vector<Canvas::Stroke> strokes;
  const double arm = 3.5 * cell, width = 1.4 * cell, rim = 1.2 * cell;
  for (std::size_t i = 1; i < places.size(); ++i) strokes.push_back({places[i - 1], places[i]});
  const Place& last = places.back();
  double thickness = width;
  if (strokes.empty() && mark.sign == PictureMark::Sign::cross) {
    for (const Place& way : {Place(arm, arm), Place(arm, -arm)}) strokes.push_back({last - way, last + way});
  } else if (strokes.empty()) {
    strokes.push_back({last, last});
    thickness = 4 * cell;
  }
  canvas.strokes(strokes, thickness + rim, {1, 1, 1});
  canvas.strokes(strokes, thickness, mark.color);
  const Place beside = last + Place(6 * cell, -5 * cell);
  for (const auto& [line, color] : {std::pair(3.0, Rgb{1, 1, 1}), std::pair(1.0, Rgb(mark.color))})
    canvas.text(beside, mark.label, cell, color, Canvas::Anchor::start, false, line);
}

void refuse_edge_on(const std::vector<ScreenLayer>& layers, const Checker& checker) {
  for (const ScreenLayer& layer : layers)
    for (const ScreenTriangle& t : layer.triangles)
      if (std::abs(normal_of(t).z()) > 1e-9) return;
  checker.refuse("every triangle of the picture is seen edge-on or has no area: choose another view");
}

}  // namespace

void write_picture(const std::filesystem::path& path, const std::vector<PictureLayer>& layers,
                   const PictureOptions& options, const std::vector<PictureMark>& marks) {
  write_file(path, picture_png(path, layers, options, marks));
}

std::string picture_png(const std::filesystem::path& path, const std::vector<PictureLayer>& layers,
                        const PictureOptions& options, const std::vector<PictureMark>& marks) {
  const Checker checker(path);
  checker.check(options);
  checker.check(layers);
  checker.check(marks);
  const Mat3 camera = make_camera(options, checker);
  const Interval values = value_range(layers);
  const Legend legend(options, values, camera);
  const Screen screen = fit(layers, marks, camera, legend.area(), checker);
  std::vector<ScreenLayer> drawn;
  for (const PictureLayer& layer : layers)
    drawn.push_back({on_screen(layer, screen, values), layer.opacity, layer.behind});
  refuse_edge_on(drawn, checker);
  RgbImage image = rasterize(drawn, no_distance * screen.size, options.width, options.height);
  Canvas canvas(image);
  for (const PictureMark& mark : marks) draw_mark(mark, screen, legend.cell(), canvas);
  legend.draw(screen.scale, image);
  return encode_png(image);
}

}  // namespace softkin
