#pragma once

#include <Eigen/Core>
#include <filesystem>
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
/// throws         InvalidInput: fewer than 4 pictures, or angles too much alike to tell the focal length
[[nodiscard]] Camera fit_camera(const std::vector<BoardSight>& sights, int width, int height,
                                std::vector<double>& errors);

}  // namespace softkin::vision
