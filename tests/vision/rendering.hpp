#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
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

/// Straight from above: so many pixels in a mm, the origin at this pixel, y up.
inline Eigen::Matrix3d straight(double pixels, const Vec2& origin) {
  Eigen::Matrix3d map;
  map << pixels, 0, origin.x(), 0, -pixels, origin.y(), 0, 0, 1;
  return map;
}

/// A pinhole that looks at a plane: turned about x, y and then z [rad], the plane's origin at a distance [mm] along the
/// axis, shifted by so many mm.
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

inline Vec2 ideal_pixel(const Photograph& photo, const Vec2& place) {
  return (photo.to_picture * place.homogeneous()).hnormalized();
}

/// The distortion written out once more, and inverted by repetition.
inline Vec2 bent(const Camera& k, const Vec2& ideal) {
  const double x = (ideal.x() - k.cx) / k.fx, y = (ideal.y() - k.cy) / k.fy, r = x * x + y * y;
  const double radial = 1 + k.k1 * r + k.k2 * r * r + k.k3 * r * r * r;
  return {k.fx * (x * radial + 2 * k.p1 * x * y + k.p2 * (r + 2 * x * x)) + k.cx,
          k.fy * (y * radial + k.p1 * (r + 2 * y * y) + 2 * k.p2 * x * y) + k.cy};
}

inline Vec2 seen_pixel(const Photograph& photo, const Vec2& place) {
  const Vec2 ideal = ideal_pixel(photo, place);
  return photo.camera ? bent(*photo.camera, ideal) : ideal;
}

inline Vec2 place_at(const Photograph& photo, const Eigen::Matrix3d& to_plane, const Vec2& pixel) {
  Vec2 ideal = pixel;
  if (photo.camera)
    for (int i = 0; i < 50; ++i) {
      const Vec2 miss = pixel - bent(*photo.camera, ideal);
      ideal += miss;
      if (miss.squaredNorm() < 1e-14) break;
    }
  return (to_plane * ideal.homogeneous()).hnormalized();
}

using Channels = std::vector<Eigen::Vector3d>;

/// Every pixel the mean of 8 x 8 points where its corners differ in colour.
inline Channels exposed(const Photograph& photo, const Paint& paint) {
  const Eigen::Matrix3d to_plane = photo.to_picture.inverse();
  const auto at = [&](double x, double y) { return paint(place_at(photo, to_plane, Vec2(x, y))); };
  const int columns = photo.width + 1;
  Channels corners, light;
  for (int y = 0; y <= photo.height; ++y)
    for (int x = 0; x < columns; ++x) corners.push_back(at(x - 0.5, y - 0.5));
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      const auto corner = [&](int i, int j) { return corners[std::size_t((y + j) * columns + x + i)]; };
      Eigen::Vector3d sum = corner(0, 0);
      if ((corner(0, 0) - corner(1, 0)).norm() + (corner(0, 0) - corner(0, 1)).norm() +
              (corner(0, 0) - corner(1, 1)).norm() >
          1) {
        sum.setZero();
        for (int j = 0; j < 8; ++j)
          for (int i = 0; i < 8; ++i) sum += at(x + (i + 0.5) / 8 - 0.5, y + (j + 0.5) / 8 - 0.5) / 64;
      }
      light.push_back(photo.exposure * sum);
    }
  return light;
}

inline Channels blurred(const Channels& light, int width, int height, double deviation) {
  const int reach = static_cast<int>(std::ceil(4 * deviation));
  std::vector<double> weights;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) weights.push_back(std::exp(-i * i / (2 * deviation * deviation)));
  for (const double weight : weights) sum += weight;
  const auto pass = [&](const Channels& from, int dx, int dy) {
    Channels to(from.size(), Eigen::Vector3d::Zero());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int i = -reach; i <= reach; ++i)
          to[std::size_t(y * width + x)] +=
              weights[std::size_t(i + reach)] / sum *
              from[std::size_t(std::clamp(y + i * dy, 0, height - 1) * width + std::clamp(x + i * dx, 0, width - 1))];
    return to;
  };
  return pass(pass(light, 1, 0), 0, 1);
}

/// The paint as this photograph shows it.
inline RgbImage render(const Photograph& photo, const Paint& paint) {
  Channels light = exposed(photo, paint);
  if (photo.blur > 0) light = blurred(light, photo.width, photo.height, photo.blur);
  std::mt19937 random(photo.seed);
  std::normal_distribution<double> noise(0, 1);
  RgbImage picture(photo.width, photo.height);
  for (std::size_t i = 0; i < light.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double value = light[i][c] + (photo.noise > 0 ? photo.noise * noise(random) : 0);
      picture.bytes[3 * i + std::size_t(c)] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    }
  return picture;
}

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
