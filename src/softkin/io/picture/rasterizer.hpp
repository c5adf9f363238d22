#pragma once

#include <Eigen/Core>
#include <optional>
#include <softkin/core/types.hpp>
#include <softkin/io/picture/rgb_image.hpp>
#include <vector>

namespace softkin {

/// A triangle on the screen.
struct ScreenTriangle {
  std::array<Vec3, 3> corners;                     // x to the right, y down, z towards the eye [pixel]
  std::optional<std::array<double, 3>> fractions;  // places on the colour map at the corners [0, 1]; none: color
  Rgb color{};
  double light = 0;  // > 0: fraction of white mixed in, < 0: fraction of black
  bool edges = false;
};

struct ScreenLayer {
  std::vector<ScreenTriangle> triangles;
  double opacity = 1;
  bool behind = false;  // of opacity < 1: only where nothing solid shows
};

/// Draws with hidden surfaces removed and 2 x 2 samples a pixel, on white. Of a layer with opacity < 1 only the nearest
/// surface shows; such layers are blended from far to near over what is solid, and only where they are nearer than it
/// by more than `coincident` [pixel].
[[nodiscard]] RgbImage rasterize(const std::vector<ScreenLayer>& layers, double coincident, int width, int height);

}  // namespace softkin
