#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/io/picture/rgb_image.hpp>
#include <softkin/vision/camera.hpp>
#include <string>
#include <vector>

namespace softkin::testing {

using namespace vision;

/// What an action is refused with.
inline std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

/// Colour of the plane at a place [mm], 0 to 255.
using Paint = std::function<Eigen::Vector3d(const Vec2& place)>;

inline const Eigen::Vector3d paper{225, 223, 218}, red{200, 40, 35}, blue{35, 70, 190}, green{40, 150, 60},
    ink{25, 25, 28};

/// A photograph of a plane.
struct Photograph {
  int width = 640, height = 480;
  Eigen::Matrix3d to_picture = Eigen::Matrix3d::Identity();  // mm to pixels without distortion, homogeneous
  std::optional<Camera> camera = std::nullopt;               // its distortion
  double blur = 0;                                           // standard deviation [px]
  double noise = 0;                                          // standard deviation, of 255
  double exposure = 1;                                       // factor; above 255 is white
  unsigned seed = 1;
};

/// Views a plane straight from above, with a resolution [pixels per mm] and the origin at a given pixel, y up.
inline Eigen::Matrix3d straight(double pixels, const Vec2& origin) {
  Eigen::Matrix3d map;
  map << pixels, 0, origin.x(), 0, -pixels, origin.y(), 0, 0, 1;
  return map;
}

/// Views a plane through a pinhole: rotated about x, y and then z [rad], with the plane's origin at a distance [mm]
/// along the axis, shifted [mm].
inline Eigen::Matrix3d tilted(double focal, const Vec2& middle, const Eigen::Vector3d& turns,
                              const Eigen::Vector3d& shift) {
  const auto c = [](double a) { return std::cos(a); };
  const auto s = [](double a) { return std::sin(a); };
  Eigen::Matrix3d x, y, z, pinhole, plane;
  x << 1, 0, 0, 0, c(turns[0]), -s(turns[0]), 0, s(turns[0]), c(turns[0]);
  y << c(turns[1]), 0, s(turns[1]), 0, 1, 0, -s(turns[1]), 0, c(turns[1]);
  z << c(turns[2]), -s(turns[2]), 0, s(turns[2]), c(turns[2]), 0, 0, 0, 1;
  const Eigen::Matrix3d turn = x * y * z * Eigen::Vector3d(1, -1, -1).asDiagonal();  // y up, towards the camera
  pinhole << focal, 0, middle.x(), 0, focal, middle.y(), 0, 0, 1;
  plane << turn.col(0), turn.col(1), shift;
  return pinhole * plane;
}

/// The distortion written out once more, and inverted by repetition.
Vec2 bent(const Camera& k, const Vec2& ideal);

/// Where a place is seen.
Vec2 ideal_pixel(const Photograph& photo, const Vec2& place);
Vec2 seen_pixel(const Photograph& photo, const Vec2& place);

/// The paint as this photograph shows it.
RgbImage render(const Photograph& photo, const Paint& paint);

struct Disc {
  Vec2 centre;
  double radius;
  Eigen::Vector3d colour;
};

/// Discs on paper, or on other paint.
inline Paint discs_on(
    std::vector<Disc> discs, Paint ground = [](const Vec2&) { return paper; }) {
  return [discs = std::move(discs), ground = std::move(ground)](const Vec2& place) {
    for (const Disc& disc : discs)
      if ((place - disc.centre).norm() < disc.radius) return disc.colour;
    return ground(place);
  };
}

/// A bar of two colours: its fixed end, interface and free end along an axis through a point, the interface slanted.
struct BarPaint {
  Vec2 start = Vec2::Zero();           // middle of the fixed end [mm]
  double direction = 0;                // of the axis [rad]
  double interface = 20, length = 50;  // L_1, L [mm]
  double width = 10;                   // [mm]
  double slant = 0;                    // [rad]

  [[nodiscard]] Eigen::Vector3d operator()(const Vec2& place) const {
    const Vec2 along(std::cos(direction), std::sin(direction)), arm = place - start;
    const double s = arm.dot(along), t = arm.dot(Vec2(-along.y(), along.x()));
    if (s < 0 || s > length || std::abs(t) > width / 2) return paper;
    return s < interface - std::tan(slant) * t ? red : blue;
  }
};

}  // namespace softkin::testing
