#pragma once

#include <opencv2/core.hpp>
#include <softkin/io/picture/rgb_image.hpp>

namespace softkin {

/// Brightness of a picture, 8 bits. For sources of this room only: it includes OpenCV.
[[nodiscard]] cv::Mat gray_of(const RgbImage& picture);

}  // namespace softkin
