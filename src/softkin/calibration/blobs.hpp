#pragma once

#include <cstdint>
#include <softkin/calibration/camera.hpp>
#include <vector>

namespace softkin {

/// Pixels that hang together, corners counting as contact.
struct Blob {
  std::vector<int> pixels;                           // y * width + x
  int left = 0, right = 0, top = 0, bottom = 0;      // [px], ends included
  Vec2 centre = Vec2::Zero();                        // of mass [px]
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // covariance of its pixels [px^2]

  [[nodiscard]] double area() const { return static_cast<double>(pixels.size()); }
  /// Its area by that of the ellipse of the same covariance: 1 for an ellipse, 0.95 for a rectangle, less where it is
  /// hollow or ragged.
  [[nodiscard]] double fullness() const;
  /// Longest by shortest axis, >= 1.
  [[nodiscard]] double elongation() const;
  /// Does it come nearer than so many pixels to the frame?
  [[nodiscard]] bool touches_frame(int width, int height, int margin) const;
};

/// Blobs of a mask of so many columns, of at least so many pixels, the largest first.
[[nodiscard]] std::vector<Blob> find_blobs(const std::vector<std::uint8_t>& mask, int width, std::size_t least);

}  // namespace softkin
