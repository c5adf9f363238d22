#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/picture/picture.hpp>
#include <softkin/io/picture/picture_legend.hpp>
#include <softkin/io/picture/png.hpp>
#include <softkin/io/picture/rasterizer.hpp>

namespace softkin {

namespace {

constexpr int smallest = 64, largest = 8192;            // width and height [pixel]
constexpr int legend_width = 320, legend_height = 240;  // the smallest picture with a legend [pixel]
constexpr double filled = 0.9;                          // share of the drawing area that the layers fill
constexpr double coincident = 0.005;                    // share of the layers' size that is as good as no distance
constexpr double deepest = 1e12;                        // [pixel]
constexpr double shadow = 0.42, highlight = 0.18;       // how much the light darkens and brightens

struct Camera {
  Mat3 axes;  // rows: right, down, towards the eye

  [[nodiscard]] Vec3 seen(const Vec3& point) const { return axes * point; }
};

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
      if (pixels >= smallest && pixels <= largest) continue;
      refuse("picture " + std::string(name) + " " + std::to_string(pixels) + " is outside [" +
             std::to_string(smallest) + ", " + std::to_string(largest) + "] pixels");
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

 private:
  void check(const PictureLayer& layer, const std::string& where) const {
    for (Eigen::Index i = 0; i < layer.points.rows(); ++i) {
      if (!layer.points.row(i).allFinite()) refuse(where + "point " + std::to_string(i) + " is not finite");
    }
    const auto points = static_cast<std::size_t>(layer.points.rows());
    if (!layer.values.empty() && layer.values.size() != points) {
      refuse(where + std::to_string(layer.values.size()) + " values for " + std::to_string(points) + " points");
    }
    for (std::size_t i = 0; i < layer.values.size(); ++i) {
      if (!std::isfinite(layer.values[i])) refuse(where + "value " + std::to_string(i) + " is not finite");
    }
    for (std::size_t i = 0; i < layer.triangles.size(); ++i) {
      for (const Index v : layer.triangles[i]) {
        if (v >= 0 && v < layer.points.rows()) continue;
        refuse(where + "triangle " + std::to_string(i) + " names point " + std::to_string(v) + " of " +
               std::to_string(points));
      }
    }
    for (const double channel : layer.color) {
      if (!(channel >= 0 && channel <= 1)) refuse(where + "a colour is outside [0, 1]");
    }
    if (!(layer.opacity > 0 && layer.opacity <= 1)) refuse(where + "opacity is outside (0, 1]");
  }

  Origin origin_;
};

Camera make_camera(const PictureOptions& options, const Checker& checker) {
  if (!options.view.allFinite() || !options.up.allFinite()) checker.refuse("picture view or up is not finite");
  const Vec3 eye = options.view.stableNormalized(), up = options.up.stableNormalized();
  const Vec3 right = up.cross(eye);
  if (right.norm() < 1e-6) checker.refuse("picture view and up must be neither zero nor parallel");
  Camera camera;
  camera.axes.row(0) = right.normalized();
  camera.axes.row(1) = camera.axes.row(0).cross(eye);
  camera.axes.row(2) = eye;
  return camera;
}

template <class Visit>
void for_each_corner(const std::vector<PictureLayer>& layers, const Visit& visit) {
  for (const PictureLayer& layer : layers) {
    for (const Triangle& t : layer.triangles) {
      for (const Index v : t) visit(layer, v);
    }
  }
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
  Camera camera;
  double scale = 1;  // [pixel / mm]
  double size = 1;   // diagonal of what is drawn [pixel]
  Vec3 center, middle;

  [[nodiscard]] Vec3 at(const Vec3& point) const { return scale * (camera.seen(point) - center) + middle; }
};

Screen fit(const std::vector<PictureLayer>& layers, const Camera& camera, const PictureArea& area,
           const Checker& checker) {
  std::array<Interval, 3> extent;
  for_each_corner(layers, [&](const PictureLayer& layer, Index v) {
    const Vec3 seen = camera.seen(layer.points.row(v));
    for (int k = 0; k < 3; ++k) extent[k].include(seen[k]);
  });
  const Canvas::Place space = filled / 2 * (area.high - area.low);
  const Vec3 half(extent[0].half_length(), extent[1].half_length(), extent[2].half_length());
  Screen screen;
  screen.camera = camera;
  screen.scale = std::min(space.x() / half.x(), space.y() / half.y());
  screen.size = 2 * screen.scale * half.stableNorm();
  screen.center = {extent[0].middle(), extent[1].middle(), extent[2].middle()};
  screen.middle.setZero();
  screen.middle.head<2>() = (area.low + area.high) / 2;
  const double depth = screen.scale * half.z();
  if (!(screen.scale > 0) || !std::isfinite(screen.scale) || !(depth < deepest)) {
    checker.refuse("the picture's layers have no extent in this view, or one too large to draw");
  }
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
      for (int k = 0; k < 3; ++k) {
        (*drawn.shares)[k] = half > 0 ? (layer.values[t[k]] / 2 - values.low / 2) / half : 0;
      }
    }
    triangles.push_back(drawn);
  }
  return triangles;
}

void refuse_edge_on(const std::vector<ScreenLayer>& layers, const Checker& checker) {
  for (const ScreenLayer& layer : layers) {
    for (const ScreenTriangle& t : layer.triangles) {
      if (std::abs(normal_of(t).z()) > 1e-9) return;
    }
  }
  checker.refuse("every triangle of the picture is seen edge-on or has no area: choose another view");
}

}  // namespace

void write_picture(const std::filesystem::path& path, const std::vector<PictureLayer>& layers,
                   const PictureOptions& options) {
  const Checker checker(path);
  checker.check(options);
  checker.check(layers);
  const Camera camera = make_camera(options, checker);
  const Interval values = value_range(layers);

  PictureLegend legend;
  legend.shown = options.width >= legend_width && options.height >= legend_height;
  legend.title = options.title;
  legend.label = options.value_label;
  legend.values = values.low <= values.high;
  legend.low = values.low;
  legend.high = values.high;
  for (int k = 0; k < 3; ++k) legend.axes[k] = camera.seen(Vec3::Unit(k));

  const Screen screen = fit(layers, camera, drawing_area(legend, options.width, options.height), checker);
  legend.pixels_per_mm = screen.scale;
  std::vector<ScreenLayer> drawn;
  for (const PictureLayer& layer : layers) drawn.push_back({on_screen(layer, screen, values), layer.opacity});
  refuse_edge_on(drawn, checker);
  RgbImage image = rasterize(drawn, coincident * screen.size, options.width, options.height);
  draw_legend(legend, image);
  write_file(path, encode_png(image));
}

}  // namespace softkin
