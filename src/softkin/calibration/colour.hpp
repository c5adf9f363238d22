#pragma once

#include <softkin/io/picture/rgb_image.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A colour that a pixel has or has not: red, orange, yellow, green, cyan, blue, magenta by hue; black, white; or the
/// hue of "#rrggbb".
class Colour {
 public:
  /// throws  InvalidInput: no such colour, or a "#rrggbb" without hue
  explicit Colour(const std::string& name);

  /// channels: red, green, blue in [0, 255]
  [[nodiscard]] bool has(const std::array<double, 3>& channels) const;
  [[nodiscard]] const std::string& name() const { return name_; }

  [[nodiscard]] static const std::vector<std::string>& names();

 private:
  std::string name_;
  double hue_from_ = 0, hue_to_ = 0;  // [degrees]; from > to passes through 0
  bool black_ = false, white_ = false;
};

/// Pixels of a colour, 1 each, row by row. Each is judged by the mean of its 3 x 3 neighbourhood, so that noise makes
/// no specks.
[[nodiscard]] std::vector<std::uint8_t> pixels_of(const Colour& colour, const RgbImage& picture);

/// Share of pixels at full white in all channels, where nothing can be measured any more [-].
[[nodiscard]] double clipped_share(const RgbImage& picture);

}  // namespace softkin
