#pragma once

#include <optional>
#include <softkin/calibration/camera.hpp>
#include <vector>

namespace softkin {

/// Standard error that no picture goes below, however little noise it has: pixels differ, light is uneven [px].
inline constexpr double pixel_error = 0.02;

/// A point of the measured plane and where the picture shows it.
struct PlanePoint {
  Vec2 pixel;  // lens distortion taken out [px]
  Vec2 place;  // [mm]
};

/// How a camera sees a plane: pixels to mm and back.
class PlaneView {
 public:
  /// A camera that looks straight at the plane: x along the rows of the picture, y up, the origin at the first pixel.
  /// mm_per_pixel > 0
  PlaneView(std::optional<Camera> camera, double mm_per_pixel);

  /// The projective map that fits the points best: least squares of the distances in the picture [px].
  /// points  four or more, not all but one on a line; throws InvalidInput otherwise
  PlaneView(std::optional<Camera> camera, const std::vector<PlanePoint>& points);

  [[nodiscard]] Vec2 to_mm(const Vec2& seen) const;
  [[nodiscard]] Vec2 to_pixel(const Vec2& place) const;
  /// Pixel as a camera without distortion would see it, to mm.
  [[nodiscard]] Vec2 ideal_to_mm(const Vec2& ideal) const;
  [[nodiscard]] Vec2 without_distortion(const Vec2& seen) const;
  /// Area of the plane that one pixel sees [mm^2].
  [[nodiscard]] double pixel_area(const Vec2& seen) const;
  /// Standard error of to_mm along an axis [mm], from how well the points fitted; 0 for a straight view.
  [[nodiscard]] double error_at(const Vec2& seen) const;
  /// The same view with another origin [mm] and x axis, turned counter-clockwise by angle [rad].
  [[nodiscard]] PlaneView moved(const Vec2& origin, double angle) const;

  /// Root of the mean square distance of the points from where they were expected [px]; 0 for a straight view.
  [[nodiscard]] double residual() const { return residual_; }
  [[nodiscard]] bool perspective() const { return perspective_; }
  [[nodiscard]] const std::optional<Camera>& camera() const { return camera_; }

 private:
  std::optional<Camera> camera_;
  Eigen::Matrix3d to_plane_, to_picture_;  // homogeneous, of ideal pixels
  // the fit, in coordinates of mean 0 and size 1 on both sides
  Eigen::Matrix3d fitted_map_ = Eigen::Matrix3d::Identity(), fitted_to_plane_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 8, 8> covariance_ = Eigen::Matrix<double, 8, 8>::Zero();  // of its first 8 entries
  double fitted_unit_ = 1;                                                        // fitted pixels in one pixel
  double residual_ = 0;
  bool perspective_ = false;
};

}  // namespace softkin
