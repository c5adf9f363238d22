#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/io/picture/rasterizer.hpp>

namespace softkin {

namespace {

constexpr int samples_per_axis = 2;  // per pixel and axis
constexpr int band_rows = 32;        // pixels; bounds the memory of the samples
constexpr double grid = 256;         // corners lie on 1 / grid of a sample: edge functions are then exact, seams closed
constexpr double edge_half_width = 0.55;  // samples
constexpr double edge_strength = 0.5;     // fraction of black
constexpr double dense = 5, sparse = 16;  // heights of a triangle [samples] between which its edges fade in

using Color = std::array<float, 3>;

struct Sample {
  double depth = -std::numeric_limits<double>::infinity();
  Color color{1, 1, 1};
};

/// Samples of the pixel rows [first_row, first_row + rows).
struct Band {
  int columns, first_row = 0, rows = 0;  // in samples
  std::vector<Sample> samples;

  explicit Band(int width) : columns(samples_per_axis * width) {}

  void clear(int first_pixel_row, int pixel_rows) {
    first_row = samples_per_axis * first_pixel_row;
    rows = samples_per_axis * pixel_rows;
    samples.assign(std::size_t(columns) * rows, Sample{});
  }
};

struct ClearBand {
  Band band;
  double opacity;
  bool behind;
};

/// The distance to a side of a triangle, positive inside [sample], as a linear function of the place.
struct Side {
  double dx = 0, dy = 0, constant = 0, length = 0;

  Side(const Vec3& a, const Vec3& b)
      : dx(a.y() - b.y()), dy(b.x() - a.x()), constant(a.x() * b.y() - a.y() * b.x()), length(std::hypot(dx, dy)) {}

  [[nodiscard]] double at(double x, double y) const { return dx * x + dy * y + constant; }
};

double snapped(double pixel) {
  return std::round(pixel * samples_per_axis * grid) / grid;
}

class TrianglePainter {
 public:
  TrianglePainter(const ScreenTriangle& triangle, Band& band) : triangle_(triangle), band_(band) {}

  void paint() {
    Vec3 a = corner(0), b = corner(1), c = corner(2);
    const double area = Side(a, b).at(c.x(), c.y());
    if (area == 0) return;
    swapped_ = area < 0;
    if (swapped_) std::swap(b, c);
    const Side sides[3] = {Side(b, c), Side(c, a), Side(a, b)};
    const double inverse = 1 / std::abs(area);
    fade_in_edges(sides, std::abs(area));
    const int left = std::max(0, first(std::min({a.x(), b.x(), c.x()})));
    const int right = std::min(band_.columns - 1, last(std::max({a.x(), b.x(), c.x()})));
    const int top = std::max(band_.first_row, first(std::min({a.y(), b.y(), c.y()})));
    const int bottom = std::min(band_.first_row + band_.rows - 1, last(std::max({a.y(), b.y(), c.y()})));
    for (int y = top; y <= bottom; ++y) {
      Sample* row = band_.samples.data() + std::size_t(y - band_.first_row) * band_.columns;
      for (int x = left; x <= right; ++x) {
        const double w[3] = {sides[0].at(x + 0.5, y + 0.5), sides[1].at(x + 0.5, y + 0.5),
                             sides[2].at(x + 0.5, y + 0.5)};
        if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
        const double depth = (w[0] * a.z() + w[1] * b.z() + w[2] * c.z()) * inverse;
        if (depth <= row[x].depth) continue;
        const double nearest = std::min({w[0] / sides[0].length, w[1] / sides[1].length, w[2] / sides[2].length});
        row[x] = {depth, color(w, inverse, nearest)};
      }
    }
  }

 private:
  // the first and the last sample whose centre lies in an interval
  static int first(double low) { return static_cast<int>(std::ceil(low - 0.5)); }
  static int last(double high) { return static_cast<int>(std::floor(high - 0.5)); }

  [[nodiscard]] Vec3 corner(int i) const {
    const Vec3& p = triangle_.corners[i];
    return {snapped(p.x()), snapped(p.y()), samples_per_axis * p.z()};
  }

  // small triangles would be nothing but edge
  void fade_in_edges(const Side* sides, double area) {
    if (!triangle_.edges) return;
    const double height = area / std::max({sides[0].length, sides[1].length, sides[2].length});
    edge_fraction_ = edge_strength * std::clamp((height - dense) / (sparse - dense), 0.0, 1.0);
  }

  [[nodiscard]] Color color(const double* w, double inverse, double distance) const {
    Rgb color = triangle_.color;
    if (triangle_.fractions) {
      const auto& s = *triangle_.fractions;
      color = mapped_color((w[0] * s[0] + w[1] * s[swapped_ ? 2 : 1] + w[2] * s[swapped_ ? 1 : 2]) * inverse);
    }
    const double light = triangle_.light;
    const double edge = edge_fraction_ * std::clamp(edge_half_width + 0.5 - distance, 0.0, 1.0);
    for (double& channel : color) {
      channel += light > 0 ? light * (1 - channel) : light * channel;
      channel *= 1 - edge;
    }
    return {float(color[0]), float(color[1]), float(color[2])};
  }

  const ScreenTriangle& triangle_;
  Band& band_;
  bool swapped_ = false;
  double edge_fraction_ = 0;
};

void paint_layer(const ScreenLayer& layer, Band& band) {
  const double top = double(band.first_row) / samples_per_axis - 1,
               bottom = double(band.first_row + band.rows) / samples_per_axis + 1;
  for (const ScreenTriangle& t : layer.triangles) {
    const auto [low, high] = std::minmax({t.corners[0].y(), t.corners[1].y(), t.corners[2].y()});
    if (high >= top && low <= bottom) TrianglePainter(t, band).paint();
  }
}

struct Fragment {
  Sample sample;
  float opacity;
};

/// Colour of sample i of the solid band with the see-through ones in front of it, nearer by more than `coincident`.
Color blended(const Band& solid, const std::vector<ClearBand>& clear, double coincident, std::size_t i,
              std::vector<Fragment>& fragments) {
  fragments.clear();
  for (const auto& [band, opacity, behind] : clear) {
    const Sample& sample = band.samples[i];
    if (behind && std::isfinite(solid.samples[i].depth)) continue;
    if (sample.depth > solid.samples[i].depth + coincident) fragments.push_back({sample, float(opacity)});
  }
  std::stable_sort(fragments.begin(), fragments.end(),
                   [](const Fragment& a, const Fragment& b) { return a.sample.depth < b.sample.depth; });
  Color color = solid.samples[i].color;
  for (const Fragment& f : fragments)
    for (int k = 0; k < 3; ++k) color[k] += f.opacity * (f.sample.color[k] - color[k]);
  return color;
}

void resolve(const Band& solid, const std::vector<ClearBand>& clear, double coincident, RgbImage& image) {
  std::vector<Fragment> fragments;
  for (int row = 0; row < solid.rows / samples_per_axis; ++row) {
    for (int x = 0; x < image.width; ++x) {
      Color sum{0, 0, 0};
      for (int k = 0; k < samples_per_axis * samples_per_axis; ++k) {
        const std::size_t i = std::size_t(samples_per_axis * row + k / samples_per_axis) * solid.columns +
                              std::size_t(samples_per_axis * x + k % samples_per_axis);
        const Color color = blended(solid, clear, coincident, i, fragments);
        for (int channel = 0; channel < 3; ++channel) sum[channel] += color[channel];
      }
      std::uint8_t* pixel = image.pixel(x, solid.first_row / samples_per_axis + row);
      for (int k = 0; k < 3; ++k) pixel[k] = to_byte(sum[k] / (samples_per_axis * samples_per_axis));
    }
  }
}

}  // namespace

RgbImage rasterize(const std::vector<ScreenLayer>& layers, double coincident, int width, int height) {
  RgbImage image(width, height);
  Band solid(width);
  std::vector<ClearBand> clear;
  for (const ScreenLayer& layer : layers)
    if (layer.opacity < 1) clear.push_back({Band(width), layer.opacity, layer.behind});
  for (int row = 0; row < height; row += band_rows) {
    const int rows = std::min(band_rows, height - row);
    solid.clear(row, rows);
    for (ClearBand& c : clear) c.band.clear(row, rows);
    auto next = clear.begin();
    for (const ScreenLayer& layer : layers) paint_layer(layer, layer.opacity < 1 ? (next++)->band : solid);
    resolve(solid, clear, samples_per_axis * coincident, image);
  }
  return image;
}

}  // namespace softkin
