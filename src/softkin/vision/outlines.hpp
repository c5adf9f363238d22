#pragma once

#include <softkin/vision/pixels.hpp>
#include <vector>

namespace softkin::vision {

/// The pixels of a blob's outer border one after the other, corners counting as contact, from the first of the topmost
/// ones on; a part one pixel wide is passed there and back. Holes have no part in it.
/// source  Suzuki and Abe, Topological structural analysis of digitized binary images by border following, CVGIP 30,
///         1985
[[nodiscard]] std::vector<Vec2> outline_of(const Blob& blob);

/// Of the area that a polygon encloses; the second moments are about the origin and by its area.
struct AreaMoments {
  double area = 0;
  Vec2 centre = Vec2::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
};

/// By Green's theorem; either sense of rotation. Of no area it is the mean of the corners.
[[nodiscard]] AreaMoments moments_of(const std::vector<Vec2>& polygon);

}  // namespace softkin::vision
