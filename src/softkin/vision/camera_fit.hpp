#pragma once

#include <softkin/calibration/plane_view.hpp>
#include <string>
#include <vector>

namespace softkin {

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

}  // namespace softkin
