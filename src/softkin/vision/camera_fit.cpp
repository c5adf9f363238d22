#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <softkin/core/error.hpp>
#include <softkin/vision/camera_fit.hpp>

namespace softkin {

namespace {

constexpr std::size_t least_pictures = 4;
constexpr double most_focal_error = 0.03;  // of the focal length
constexpr double least_tilt = 0.2;         // between two boards [rad]: seen straight, near and small is far and large

/// Largest angle between the planes of two of the boards [rad].
double tilt_between(const cv::Mat& turns) {
  std::vector<cv::Matx33d> frames;
  for (int i = 0; i < turns.rows; ++i) {
    frames.emplace_back();
    cv::Rodrigues(turns.at<cv::Vec3d>(i), frames.back());
  }
  double least = 1;
  for (const cv::Matx33d& a : frames)
    for (const cv::Matx33d& b : frames)
      least = std::min(least, a(0, 2) * b(0, 2) + a(1, 2) * b(1, 2) + a(2, 2) * b(2, 2));
  return std::acos(std::max(-1.0, least));
}

}  // namespace

Camera fit_camera(const std::vector<BoardSight>& sights, int width, int height, std::vector<double>& errors) {
  if (sights.size() < least_pictures)
    throw InvalidInput("a camera is found from " + std::to_string(least_pictures) +
                       " pictures of the board or more, better 10 to 20 under different angles");
  std::vector<std::vector<cv::Point3f>> places;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const BoardSight& sight : sights) {
    places.emplace_back();
    pixels.emplace_back();
    for (const PlanePoint& point : sight.points) {
      places.back().emplace_back(static_cast<float>(point.place.x()), static_cast<float>(point.place.y()), 0.0F);
      pixels.back().emplace_back(static_cast<float>(point.pixel.x()), static_cast<float>(point.pixel.y()));
    }
  }
  cv::Mat matrix, distortion, turns, shifts, spread, spread_outside, each;
  Camera camera{.width = width, .height = height, .pictures = static_cast<int>(sights.size())};
  try {
    camera.reprojection_error = cv::calibrateCamera(places, pixels, cv::Size(width, height), matrix, distortion, turns,
                                                    shifts, spread, spread_outside, each, cv::CALIB_FIX_K3);
  } catch (const cv::Exception&) {
    throw InvalidInput("no camera fits these pictures; is the board flat, and are they all from one camera?");
  }
  camera.fx = matrix.at<double>(0, 0);
  camera.fy = matrix.at<double>(1, 1);
  camera.cx = matrix.at<double>(0, 2);
  camera.cy = matrix.at<double>(1, 2);
  distortion = distortion.reshape(1, 1);
  camera.k1 = distortion.at<double>(0, 0);
  camera.k2 = distortion.at<double>(0, 1);
  camera.p1 = distortion.at<double>(0, 2);
  camera.p2 = distortion.at<double>(0, 3);
  camera.focal_error = std::max(spread.at<double>(0), spread.at<double>(1));
  errors.clear();
  for (int i = 0; i < each.rows; ++i) errors.push_back(each.at<double>(i));
  if (!std::isfinite(camera.reprojection_error) || !(camera.focal_error < most_focal_error * camera.fx) ||
      !(tilt_between(turns) > least_tilt))
    throw InvalidInput(
        "these pictures do not tell the focal length: take the board under different angles, tilted by "
        "20 to 45 degrees to different sides");
  return camera;
}

}  // namespace softkin
