#include <algorithm>
#include <limits>
#include <softkin/io/picture/label_places.hpp>

namespace softkin {

namespace {

using Place = Eigen::Vector2d;

double area_of(const Place& size) {
  return std::max(0.0, size.x()) * std::max(0.0, size.y());
}

double shared_area(const Area& a, const Area& b) {
  return area_of(a.high.cwiseMin(b.high) - a.low.cwiseMax(b.low));
}

/// How much of a label is covered or outside the picture [pixel^2].
double overlap(const Area& label, const std::vector<Area>& taken, const Area& picture) {
  double sum = area_of(label.high - label.low) - shared_area(label, picture);
  for (const Area& other : taken) sum += shared_area(label, other);
  return sum;
}

/// Above and below to the right, to the left, and in the middle; then farther away.
std::vector<Place> candidates(const LabelWish& wish, double unit) {
  std::vector<Place> corners;
  for (const double factor : {1.0, 2.0, 3.5, 5.5, 8.0}) {
    const double right = wish.at.x() + 5 * factor * unit, left = wish.at.x() - 5 * factor * unit - wish.width;
    const double above = wish.at.y() - 0.5 * factor * unit - wish.height, below = wish.at.y() + 0.5 * factor * unit;
    const double middle = wish.at.x() - wish.width / 2;
    corners.insert(corners.end(), {{right, above},
                                   {right, below},
                                   {left, above},
                                   {left, below},
                                   {middle, above - 5 * factor * unit},
                                   {middle, below + 5 * factor * unit},
                                   {right, above - 8 * factor * unit},
                                   {right, below + 8 * factor * unit},
                                   {left, above - 8 * factor * unit},
                                   {left, below + 8 * factor * unit}});
  }
  return corners;
}

}  // namespace

Place nearest_in(const Area& area, const Place& place) {
  return place.cwiseMax(area.low).cwiseMin(area.high);
}

std::vector<Place> label_places(const std::vector<LabelWish>& wishes, const std::vector<Area>& taken,
                                const Area& picture, double unit) {
  std::vector<Area> covered = taken;
  std::vector<Place> corners;
  for (const LabelWish& wish : wishes) {
    Place best = wish.at;
    double least = std::numeric_limits<double>::infinity();
    if (wish.width > 0)
      for (const Place& corner : candidates(wish, unit)) {
        const double found = overlap({corner, corner + Place(wish.width, wish.height)}, covered, picture);
        if (!(found < least)) continue;
        least = found;
        best = corner;
        if (least <= 0) break;
      }
    corners.push_back(best);
    if (wish.width > 0) covered.push_back({best, best + Place(wish.width, wish.height)});
  }
  return corners;
}

}  // namespace softkin
