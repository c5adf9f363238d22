#pragma once

#include <array>
#include <softkin/io/picture/rgb_image.hpp>
#include <string>
#include <vector>

namespace softkin::vision {

/// A colour that a pixel has or has not: red, orange, yellow, green, cyan, blue, magenta by hue; black, white; or the
/// hue of "#rrggbb".
struct Colour {
  std::string name;
  // hue [degrees], from low to high around the circle; saturation [-]; value, of 255
  std::array<double, 3> low, high;

  /// throws  InvalidInput: no such colour, or a "#rrggbb" without hue
  explicit Colour(const std::string& name);
};

/// Share of pixels at full white in all channels, where nothing can be measured any more [-].
[[nodiscard]] double clipped_share(const RgbImage& picture);

}  // namespace softkin::vision
