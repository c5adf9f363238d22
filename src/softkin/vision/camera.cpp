#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <softkin/core/error.hpp>
#include <softkin/vision/camera.hpp>

namespace softkin::vision {

namespace {

constexpr std::size_t least_pictures = 4;
constexpr double most_focal_error = 0.03;  // of the focal length
constexpr double least_tilt = 0.2;         // between two boards [rad]: seen straight, near and small is far and large

using Points = std::vector<cv::Point2d>;

cv::Matx33d matrix_of(const Camera& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

cv::Vec<double, 5> lens_of(const Camera& camera) {
  return {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
}

/// Largest angle between the planes of two of the boards [rad].
double tilt_between(const cv::Mat& turns) {
  std::vector<cv::Vec3d> normals;
  for (int i = 0; i < turns.rows; ++i) {
    cv::Matx33d frame;
    cv::Rodrigues(turns.at<cv::Vec3d>(i), frame);
    normals.emplace_back(frame(0, 2), frame(1, 2), frame(2, 2));
  }
  double least = 1;
  for (const cv::Vec3d& a : normals)
    for (const cv::Vec3d& b : normals) least = std::min(least, a.dot(b));
  return std::acos(std::max(-1.0, least));
}

}  // namespace

Vec2 distorted(const Camera& camera, const Vec2& ideal) {
  const std::vector<cv::Point3d> ray{{(ideal.x() - camera.cx) / camera.fx, (ideal.y() - camera.cy) / camera.fy, 1}};
  Points seen;
  cv::projectPoints(ray, cv::Vec3d(), cv::Vec3d(), matrix_of(camera), lens_of(camera), seen);
  return {seen[0].x, seen[0].y};
}

Vec2 undistorted(const Camera& camera, const Vec2& seen) {
  Points ideal;
  cv::undistortPoints(Points{{seen.x(), seen.y()}}, ideal, matrix_of(camera), lens_of(camera), cv::noArray(),
                      matrix_of(camera), cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-11));
  return {ideal[0].x, ideal[0].y};
}

Camera fit_camera(const std::vector<BoardSight>& sights, int width, int height, std::vector<double>& errors) {
  if (sights.size() < least_pictures)
    throw InvalidInput("a camera is found from " + std::to_string(least_pictures) +
                       " pictures of the board or more, better 10 to 20 under different angles");
  std::vector<std::vector<cv::Point3f>> places(sights.size());
  std::vector<std::vector<cv::Point2f>> pixels(sights.size());
  for (std::size_t i = 0; i < sights.size(); ++i)
    for (const PlanePoint& point : sights[i].points) {
      places[i].emplace_back(cv::Point3d(point.place.x(), point.place.y(), 0));
      pixels[i].emplace_back(cv::Point2d(point.pixel.x(), point.pixel.y()));
    }
  cv::Matx33d matrix;
  cv::Vec<double, 5> lens;
  cv::Mat turns, shifts, spread, spread_outside;
  Camera camera{.width = width, .height = height, .pictures = static_cast<int>(sights.size())};
  try {
    camera.reprojection_error = cv::calibrateCamera(places, pixels, cv::Size(width, height), matrix, lens, turns,
                                                    shifts, spread, spread_outside, errors, cv::CALIB_FIX_K3);
  } catch (const cv::Exception&) {
    throw InvalidInput("no camera fits these pictures; is the board flat, and are they all from one camera?");
  }
  camera.fx = matrix(0, 0), camera.fy = matrix(1, 1), camera.cx = matrix(0, 2), camera.cy = matrix(1, 2);
  camera.k1 = lens[0], camera.k2 = lens[1], camera.p1 = lens[2], camera.p2 = lens[3];
  camera.focal_error = std::max(spread.at<double>(0), spread.at<double>(1));
  if (!std::isfinite(camera.reprojection_error) || !(camera.focal_error < most_focal_error * camera.fx) ||
      !(tilt_between(turns) > least_tilt))
    throw InvalidInput(
        "these pictures do not tell the focal length: take the board under different angles, tilted by "
        "20 to 45 degrees to different sides");
  return camera;
}

}  // namespace softkin::vision
