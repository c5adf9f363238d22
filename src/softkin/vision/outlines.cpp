#include <array>
#include <cmath>
#include <softkin/vision/outlines.hpp>
#include <utility>

namespace softkin::vision {

namespace {

constexpr std::array<std::pair<int, int>, 8> around{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};  // clockwise as seen, y being down

struct Walk {
  const GrayImage& mask;
  int x, y;

  [[nodiscard]] bool set(int direction) const {
    const int i = x + around[std::size_t(direction)].first, j = y + around[std::size_t(direction)].second;
    return i >= 0 && j >= 0 && i < mask.width && j < mask.height && mask.at(i, j) != 0;
  }

  /// The first direction with a pixel, looking round from behind one on; none: -1. sense: 1 clockwise, -1 against it
  [[nodiscard]] int next(int from, int sense) const {
    for (int k = 1; k <= 8; ++k)
      if (const int direction = (from + sense * k + 16) % 8; set(direction)) return direction;
    return -1;
  }
};

}  // namespace

std::vector<Vec2> outline_of(const Blob& blob) {
  Walk walk{blob.mask, 0, 0};
  while (blob.mask.at(walk.x, 0) == 0) ++walk.x;  // its box is tight: the topmost row has a pixel
  const int begin_x = walk.x;
  const Vec2 corner(blob.box.x, blob.box.y);
  std::vector<Vec2> outline;
  const int first = walk.next(4, 1);  // from the left, where there is none, round to the last pixel of the outline
  if (first < 0) return {corner + Vec2(begin_x, 0)};
  const std::pair<int, int> last{begin_x + around[std::size_t(first)].first, around[std::size_t(first)].second};
  for (int from = first;;) {
    outline.push_back(corner + Vec2(walk.x, walk.y));
    const std::pair<int, int> here{walk.x, walk.y};
    const int direction = walk.next(from, -1);
    walk.x += around[std::size_t(direction)].first, walk.y += around[std::size_t(direction)].second;
    if (walk.x == begin_x && walk.y == 0 && here == last) return outline;
    from = (direction + 4) % 8;  // back to where it came from
  }
}

AreaMoments moments_of(const std::vector<Vec2>& polygon) {
  AreaMoments sum;
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double cross = a.x() * b.y() - b.x() * a.y();
    sum.area += cross / 2;
    sum.centre += cross / 6 * (a + b);
    second += cross / 12 * (a * a.transpose() + b * b.transpose() + (a * b.transpose() + b * a.transpose()) / 2);
  }
  if (sum.area == 0) {
    sum.centre.setZero();
    for (const Vec2& point : polygon) sum.centre += point / static_cast<double>(polygon.size());
    return {0, sum.centre, sum.centre * sum.centre.transpose()};
  }
  return {std::abs(sum.area), sum.centre / sum.area, second / sum.area};
}

}  // namespace softkin::vision
