#pragma once

#include <limits>
#include <softkin/core/types.hpp>
#include <softkin/io/picture/canvas.hpp>
#include <softkin/io/picture/label_places.hpp>
#include <softkin/io/picture/picture.hpp>

namespace softkin {

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

/// What surrounds the drawing: title above, scale bar and axes below, colour bar at the right.
class PictureLegend {
 public:
  /// values: of the colours. All must outlive the object.
  PictureLegend(const PictureOptions& options, const Interval& values, const Mat3& camera);

  /// The part of the picture that is left to the drawing.
  [[nodiscard]] Area area() const;

  /// Size of a cell of the font [pixel].
  [[nodiscard]] double cell() const { return cell_; }

  /// Draws all of it; a picture of pixels_per_mm.
  void draw(double pixels_per_mm, RgbImage& image) const;

 private:
  /// A text at the colour bar; fraction: of its height, from below.
  struct Tick {
    double fraction;
    std::string text;
  };

  [[nodiscard]] bool has_values() const { return values_.low <= values_.high; }
  [[nodiscard]] std::vector<std::string> title_lines() const;
  [[nodiscard]] std::vector<Tick> ticks() const;
  [[nodiscard]] double color_bar_space() const;
  void draw_title(Canvas& canvas) const;
  void draw_color_bar(Canvas& canvas) const;
  void draw_scale_bar(double pixels_per_mm, Canvas& canvas) const;
  void draw_axes(Canvas& canvas) const;

  const PictureOptions& options_;
  const Interval& values_;
  const Mat3& camera_;
  bool shown_;
  double cell_;
};

}  // namespace softkin
