#include "rendering.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

namespace softkin::testing {

Vec2 ideal_pixel(const Photograph& photo, const Vec2& place) {
  return (photo.to_picture * place.homogeneous()).hnormalized();
}

Vec2 bent(const Camera& k, const Vec2& ideal) {
  const double x = (ideal.x() - k.cx) / k.fx, y = (ideal.y() - k.cy) / k.fy, r = x * x + y * y;
  const double radial = 1 + k.k1 * r + k.k2 * r * r + k.k3 * r * r * r;
  return {k.fx * (x * radial + 2 * k.p1 * x * y + k.p2 * (r + 2 * x * x)) + k.cx,
          k.fy * (y * radial + k.p1 * (r + 2 * y * y) + 2 * k.p2 * x * y) + k.cy};
}

Vec2 seen_pixel(const Photograph& photo, const Vec2& place) {
  const Vec2 ideal = ideal_pixel(photo, place);
  return photo.camera ? bent(*photo.camera, ideal) : ideal;
}

namespace {

Vec2 place_at(const Photograph& photo, const Eigen::Matrix3d& to_plane, const Vec2& pixel) {
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
Channels exposed(const Photograph& photo, const Paint& paint) {
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

Channels blurred(const Channels& light, int width, int height, double deviation) {
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

}  // namespace

RgbImage render(const Photograph& photo, const Paint& paint) {
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

}  // namespace softkin::testing
