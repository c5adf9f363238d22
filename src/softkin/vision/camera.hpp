#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace softkin::vision {

/// A place in a picture [px] or in the measured plane [mm]. Pixels: x to the right, y down, (0, 0) is the centre of the
/// first pixel. mm: x to the right, y up.
using Vec2 = Eigen::Vector2d;

/// A pinhole with the lens distortion of Brown and Conrady (radial k, tangential p), as OpenCV has it.
struct Camera {
  int width = 0, height = 0;                      // of its pictures [px]
  double fx = 0, fy = 0, cx = 0, cy = 0;          // [px]
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;  // [-]
  double focal_error = 0;                         // standard error of fx and fy [px]
  double reprojection_error = 0;                  // root of the mean square [px]
  int pictures = 0;                               // that it was found from
};

/// Where a camera without distortion would see what this one sees at a pixel [px]; the matrix stays the same.
[[nodiscard]] Vec2 undistorted(const Camera& camera, const Vec2& seen);
[[nodiscard]] Vec2 distorted(const Camera& camera, const Vec2& ideal);

/// The text of a camera file (YAML).
[[nodiscard]] std::string camera_text(const Camera& camera);

/// throws  InvalidInput naming file and line: unknown or missing keys, values out of range, a distortion that folds the
///         picture over itself
[[nodiscard]] Camera read_camera(const std::filesystem::path& path);

/// A point of a plane and where a picture shows it.
struct PlanePoint {
  Vec2 pixel;  // [px]
  Vec2 place;  // [mm]
};

/// A flat board in one picture, distortion not taken out.
struct BoardSight {
  std::string file;  // for messages
  std::vector<PlanePoint> points;
};

/// Camera matrix and distortion (k1, k2, p1, p2) from pictures of a flat board under different angles.
///
/// width, height  of the pictures [px]
/// errors         receives the root mean square distance of the corners in each picture [px]
/// source         Zhang, A flexible new technique for camera calibration, IEEE PAMI 22(11), 2000; by OpenCV
/// throws         InvalidInput: fewer than 4 pictures, or angles too much alike to determine the focal length
[[nodiscard]] Camera fit_camera(const std::vector<BoardSight>& sights, int width, int height,
                                std::vector<double>& errors);

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
