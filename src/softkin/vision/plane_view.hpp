#pragma once

#include <optional>
#include <softkin/vision/camera.hpp>
#include <vector>

namespace softkin::vision {

/// Standard error that no picture goes below, however little noise it has: pixels differ, light is uneven [px].
inline constexpr double pixel_error = 0.02;

/// How a camera sees a plane: pixels to mm and back.
class PlaneView {
 public:
  /// A camera that looks straight at the plane: x along the rows of the picture, y up, the origin at the first pixel.
  /// mm_per_pixel > 0
  PlaneView(std::optional<Camera> camera, double mm_per_pixel);

  /// The projective map that fits the points best: least squares of the distances in the picture [px].
  /// points  distortion taken out, four or more, not all but one on a line; throws InvalidInput otherwise
  PlaneView(std::optional<Camera> camera, const std::vector<PlanePoint>& points);

  [[nodiscard]] Vec2 to_mm(const Vec2& seen) const;
  [[nodiscard]] Vec2 to_pixel(const Vec2& place) const;
  /// Pixel as a camera without distortion would see it, to mm.
  [[nodiscard]] Vec2 ideal_to_mm(const Vec2& ideal) const;
  /// Area of the plane that one pixel sees [mm^2].
  [[nodiscard]] double pixel_area(const Vec2& seen) const;
  /// Standard error of to_mm along an axis [mm], from how well the points fitted; 0 for a straight view.
  [[nodiscard]] double error_at(const Vec2& seen) const;
  /// The same view with another origin [mm] and x axis, turned counter-clockwise by angle [rad].
  [[nodiscard]] PlaneView moved(const Vec2& origin, double angle) const;

  /// Root of the mean square distance of the points from where they were expected [px]; 0 for a straight view.
  [[nodiscard]] double residual() const { return residual_; }

 private:
  [[nodiscard]] Vec2 ideal(const Vec2& seen) const;

  std::optional<Camera> camera_;
  Eigen::Matrix3d to_plane_, to_picture_;                                         // homogeneous, of ideal pixels
  Eigen::Matrix3d fitted_;                                                        // to_picture_ before it was moved
  Eigen::Matrix<double, 8, 8> covariance_ = Eigen::Matrix<double, 8, 8>::Zero();  // of the first 8 entries of fitted_
  double residual_ = 0;
};

}  // namespace softkin::vision
