#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace softkin {

/// A colour: red, green, blue in [0, 1] (sRGB).
using Rgb = std::array<double, 3>;

[[nodiscard]] inline Rgb mixed(const Rgb& from, const Rgb& to, double fraction) {
  return {from[0] + fraction * (to[0] - from[0]), from[1] + fraction * (to[1] - from[1]),
          from[2] + fraction * (to[2] - from[2])};
}

/// Pixels row by row from the top left, three bytes each (sRGB).
struct RgbImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;

  /// A white image.
  RgbImage(int columns, int rows)
      : width(columns), height(rows), bytes(std::size_t{3} * columns * rows, std::uint8_t{255}) {}

  [[nodiscard]] std::uint8_t* pixel(int x, int y) { return bytes.data() + 3 * (std::size_t(y) * width + x); }
};

[[nodiscard]] inline std::uint8_t to_byte(double channel) {
  return static_cast<std::uint8_t>(255 * channel + 0.5);
}

/// A perceptually uniform colour map that colour-blind readers can read too: dark violet at 0 to yellow at 1.
///
/// fraction  in [0, 1]; clamped
/// source  viridis of N. Smith and S. van der Walt (matplotlib, 2015, CC0): nine of its colours, linear between them
[[nodiscard]] Rgb mapped_color(double fraction);

/// The image as the content of a PNG file (8 bits a channel, sRGB).
[[nodiscard]] std::string encode_png(const RgbImage& image);

}  // namespace softkin
