#pragma once

#include <array>
#include <optional>
#include <softkin/calibration/camera.hpp>
#include <softkin/io/picture/rgb_image.hpp>

namespace softkin {

/// Corners of a dark square on light ground, to a few hundredths of a pixel: lines through the places where the picture
/// is half way between dark and light, which blur does not move, and where these lines cross.
///
/// corners  as found roughly, in order around the square [px]
/// module   width of the dark border by that of the square [-]
/// camera   its distortion is taken out, so that edges are straight
/// returns  the corners as a camera without distortion would see them [px]; none where an edge is not to be seen
[[nodiscard]] std::optional<std::array<Vec2, 4>> refine_quad(const RgbImage& picture, std::array<Vec2, 4> corners,
                                                             double module, const std::optional<Camera>& camera);

/// Brightness between the pixels, 0 to 255; beyond the frame that of the nearest pixel.
[[nodiscard]] double brightness(const RgbImage& picture, const Vec2& pixel);

/// Where the lines a b and c d cross.
[[nodiscard]] Vec2 crossing(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

}  // namespace softkin
