#include <Eigen/LU>
#include <softkin/calibration/camera.hpp>

namespace softkin {

namespace {

Vec2 normalized(const Camera& camera, const Vec2& pixel) {
  return {(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy};
}

Vec2 pixel_of(const Camera& camera, const Vec2& point) {
  return {camera.fx * point.x() + camera.cx, camera.fy * point.y() + camera.cy};
}

/// The distorted point and its derivative by the ideal one.
Vec2 distort(const Camera& camera, const Vec2& point, Eigen::Matrix2d& derivative) {
  const double x = point.x(), y = point.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3));
  const double slope = 2 * (camera.k1 + r2 * (2 * camera.k2 + r2 * 3 * camera.k3));  // of radial by r2, twice
  const double p1 = camera.p1, p2 = camera.p2;
  derivative << radial + x * x * slope + 2 * p1 * y + 6 * p2 * x, x * y * slope + 2 * p1 * x + 2 * p2 * y,
      x * y * slope + 2 * p1 * x + 2 * p2 * y, radial + y * y * slope + 6 * p1 * y + 2 * p2 * x;
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

}  // namespace

Vec2 distorted(const Camera& camera, const Vec2& ideal) {
  Eigen::Matrix2d derivative;
  return pixel_of(camera, distort(camera, normalized(camera, ideal), derivative));
}

Vec2 undistorted(const Camera& camera, const Vec2& seen) {
  const Vec2 target = normalized(camera, seen);
  Vec2 point = target;
  for (int i = 0; i < 30; ++i) {
    Eigen::Matrix2d derivative;
    const Vec2 error = distort(camera, point, derivative) - target;
    const double determinant = derivative.determinant();
    if (!(determinant > 1e-3)) break;  // beyond the fold, where nothing is seen
    const Vec2 step = derivative.inverse() * error;
    point -= step;
    if (step.norm() < 1e-13) break;
  }
  return pixel_of(camera, point);
}

}  // namespace softkin
