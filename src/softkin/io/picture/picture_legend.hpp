#pragma once

#include <softkin/core/types.hpp>
#include <softkin/io/picture/canvas.hpp>
#include <string>

namespace softkin {

/// What surrounds the drawing: title above, scale bar and axes below, colour bar at the right.
struct PictureLegend {
  bool shown = true;    // false: nothing of all this, the drawing has the whole picture
  std::string title;    // empty: none
  bool values = false;  // a colour bar
  std::string label;
  double low = 0, high = 0;  // of the colour bar
  double pixels_per_mm = 1;
  std::array<Eigen::Vector3d, 3> axes;  // x, y, z unit vectors on the screen: right, down, towards the eye
};

/// The part of a picture that is left to the drawing [pixel].
struct PictureArea {
  Canvas::Place low, high;
};

[[nodiscard]] PictureArea drawing_area(const PictureLegend& legend, int width, int height);
void draw_legend(const PictureLegend& legend, RgbImage& image);

/// 1, 2 or 5 times a power of ten: the largest that does not exceed `limit` > 0.
[[nodiscard]] double round_length(double limit);

}  // namespace softkin
