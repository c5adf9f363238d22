#pragma once

#include <softkin/io/picture/rgb_image.hpp>
#include <string>

namespace softkin {

/// The image as the content of a PNG file (8 bits a channel, sRGB).
[[nodiscard]] std::string encode_png(const RgbImage& image);

}  // namespace softkin
