#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <softkin/vision/camera.hpp>
#include <softkin/vision/pictures.hpp>
#include <vector>

// What pictures are looked at with.
namespace softkin::vision {

/// One byte a pixel, row by row from the top left.
struct GrayImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes{};

  [[nodiscard]] std::uint8_t at(int x, int y) const {
    return bytes[std::size_t(y) * std::size_t(width) + std::size_t(x)];
  }
};

/// A rectangle of pixels.
struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;

  friend bool operator==(const PixelBox&, const PixelBox&) = default;
};

/// The intersection of two rectangles; empty where there is none.
[[nodiscard]] PixelBox shared_part(const PixelBox& a, const PixelBox& b);

/// Brightness (ITU-R BT.601), 8 bits.
[[nodiscard]] GrayImage gray_of(const RgbImage& picture);

/// Hue [degrees, 0 to 360], saturation [-] and value, of a colour of any scale.
[[nodiscard]] std::array<float, 3> hsv_of(const std::array<float, 3>& rgb);

/// Red, green and blue, or brightness, between the pixels: bilinear, beyond the frame that of the nearest pixel.
[[nodiscard]] Eigen::Vector3d between(const RgbImage& picture, const Vec2& pixel);
[[nodiscard]] double between(const GrayImage& picture, const Vec2& pixel);

/// Pixels of a colour that hang together, corners counting as contact.
struct Blob {
  PixelBox box{};
  GrayImage mask{};                                  // of the box: its pixels are not 0
  double area = 0;                                   // [px]
  Vec2 centre = Vec2::Zero();                        // of mass [px]
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // covariance of its pixels [px^2]

  /// Its area by that of the ellipse of the same covariance: 1 for an ellipse, 0.95 for a rectangle, less where it is
  /// hollow or ragged.
  [[nodiscard]] double fullness() const;
  /// Longest by shortest axis, >= 1.
  [[nodiscard]] double elongation() const;
  /// Does it come nearer than so many pixels to the frame?
  [[nodiscard]] bool touches_frame(const RgbImage& picture, int margin) const;
};

/// Blobs of a colour, of at least so many pixels, the largest first. Each pixel is judged by the mean of its 3 x 3
/// neighbourhood, so that noise makes no specks.
[[nodiscard]] std::vector<Blob> find_blobs(const RgbImage& picture, const Colour& colour, int least);
/// The same of the pixels of a mask that are not 0.
[[nodiscard]] std::vector<Blob> find_blobs(GrayImage mask, int least);

}  // namespace softkin::vision
