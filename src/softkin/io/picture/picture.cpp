#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/picture/canvas.hpp>
#include <softkin/io/picture/label_places.hpp>
#include <softkin/io/picture/picture.hpp>
#include <softkin/io/picture/picture_legend.hpp>
#include <softkin/io/picture/rasterizer.hpp>

namespace softkin {

namespace {

constexpr int fewest_pixels = 64, max_pixels = 8192;  // width and height [pixel]
constexpr double filled = 0.9;                        // fraction of the drawing area that the layers fill
constexpr double no_distance = 0.005;                 // fraction of the layers' size that counts as no distance
constexpr double deepest = 1e12;                      // [pixel]
constexpr double shadow = 0.42, highlight = 0.18;     // how much the light darkens and brightens

using Place = Canvas::Place;

class Checker {
 public:
  explicit Checker(const std::filesystem::path& path) : origin_{path.string()} {}

  [[noreturn]] void refuse(const std::string& message) const { throw InvalidInput(origin_, message); }

  void check(const PictureOptions& options) const {
    for (const auto& [name, pixels] : {std::pair("width", options.width), std::pair("height", options.height)}) {
      if (pixels >= fewest_pixels && pixels <= max_pixels) continue;
      refuse("picture " + std::string(name) + " " + std::to_string(pixels) + " is outside [" +
             std::to_string(fewest_pixels) + ", " + std::to_string(max_pixels) + "] pixels");
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
      drawn.fractions.emplace();
      const double half = values.half_length();
      for (int k = 0; k < 3; ++k)
        (*drawn.fractions)[k] = half > 0 ? (layer.values[t[k]] / 2 - values.low / 2) / half : 0;
    }
    triangles.push_back(drawn);
  }
  return triangles;
}

std::vector<Place> on_screen(const PictureMark& mark, const Screen& screen) {
  std::vector<Place> places;
  for (const auto& point : mark.points.rowwise()) places.push_back(screen.at(point).head<2>());
  return places;
}

constexpr double mark_arm = 3.5, mark_width = 1.4, mark_rim = 1.2;  // in cells of the font

/// A mark with a white rim, so that it shows on any colour; without its label.
void draw_mark(const PictureMark& mark, const Screen& screen, double cell, Canvas& canvas) {
  const std::vector<Place> places = on_screen(mark, screen);
  std::vector<Canvas::Stroke> strokes;
  const double arm = mark_arm * cell;
  for (std::size_t i = 1; i < places.size(); ++i) strokes.push_back({places[i - 1], places[i]});
  const Place& last = places.back();
  double thickness = mark_width * cell;
  if (strokes.empty() && mark.sign == PictureMark::Sign::cross) {
    for (const Place& diagonal : {Place(arm, arm), Place(arm, -arm)})
      strokes.push_back({last - diagonal, last + diagonal});
  } else if (strokes.empty()) {
    strokes.push_back({last, last});
    thickness = 4 * cell;
  }
  canvas.strokes(strokes, thickness + mark_rim * cell, {1, 1, 1});
  canvas.strokes(strokes, thickness, mark.color);
}

/// Labels next to the marks, so that none covers another one, a mark, or leaves the picture, where there is room.
void draw_labels(const std::vector<PictureMark>& marks, const Screen& screen, const Area& picture, double cell,
                 Canvas& canvas) {
  const double half = mark_arm * cell, height = (glyph_rows + 2) * cell;
  std::vector<Area> taken;
  std::vector<LabelWish> wishes;
  for (const PictureMark& mark : marks) {
    const Place last = on_screen(mark, screen).back();
    taken.push_back({last - Place(half, half), last + Place(half, half)});
    wishes.push_back({last, mark.label.empty() ? 0 : Canvas::text_width(mark.label, cell) + 2 * cell, height});
  }
  const std::vector<Place> corners = label_places(wishes, taken, picture, cell);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i].label.empty()) continue;
    const Area label{corners[i], corners[i] + Place(wishes[i].width, height)};
    const Place end = nearest_in(label, wishes[i].at);
    constexpr double far = 12;  // in cells of the font: from there on a line connects the label with its mark
    if ((end - wishes[i].at).norm() > far * cell) canvas.strokes({{wishes[i].at, end}}, 0.5 * cell, marks[i].color);
    const Place text = label.low + Place(cell, 4.5 * cell);  // the middle of its first capital
    for (const auto& [line, color] : {std::pair(3.0, Rgb{1, 1, 1}), std::pair(1.0, Rgb(marks[i].color))})
      canvas.text(text, marks[i].label, cell, color, Canvas::Anchor::start, false, line);
  }
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
  const PictureLegend legend(options, values, camera);
  const Screen screen = fit(layers, marks, camera, legend.area(), checker);
  std::vector<ScreenLayer> drawn;
  for (const PictureLayer& layer : layers)
    drawn.push_back({on_screen(layer, screen, values), layer.opacity, layer.behind});
  refuse_edge_on(drawn, checker);
  RgbImage image = rasterize(drawn, no_distance * screen.size, options.width, options.height);
  Canvas canvas(image);
  for (const PictureMark& mark : marks) draw_mark(mark, screen, legend.cell(), canvas);
  draw_labels(marks, screen, {{0, 0}, {double(options.width), double(options.height)}}, legend.cell(), canvas);
  legend.draw(screen.scale, image);
  return encode_png(image);
}

}  // namespace softkin
