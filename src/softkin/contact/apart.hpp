#pragma once

#include <array>
#include <softkin/contact/distance.hpp>

namespace softkin::contact {

/// Points of one feature and of the other. A vector between two features is a mean of vectors between such points.
using PointPair = std::array<int, 2>;
inline constexpr std::array<PointPair, 3> of_triangle{{{0, 1}, {0, 2}, {0, 3}}};
inline constexpr std::array<PointPair, 4> of_edges{{{0, 2}, {0, 3}, {1, 2}, {1, 3}}};

/// From the middle of the other feature to that of the one.
template <std::size_t N>
Vec3 between_middles(const FourPoints& x, const std::array<PointPair, N>& pairs) {
  Vec3 sum = Vec3::Zero();
  for (const auto& [i, j] : pairs) sum += x.col(i) - x.col(j);
  return sum / static_cast<double>(N);
}

/// Do all points of the one lie farther along than those of the other?
///
/// apart  by which, times the length of the direction [mm^2]
template <std::size_t N>
bool apart_along(const Vec3& direction, const FourPoints& x, const std::array<PointPair, N>& pairs, double apart) {
  bool all = true;
  for (const auto& [i, j] : pairs) all &= direction.dot(x.col(i) - x.col(j)) > apart;
  return all;
}

/// Do they certainly stay farther apart than this distance, all along a linear motion? Tests the direction between
/// their centroids alone, which is cheap and decides most cases; false: undecided.
template <std::size_t N>
bool clearly_apart(const FourPoints& from, const FourPoints& to, const std::array<PointPair, N>& pairs,
                   double distance) {
  const Vec3 along = between_middles(from, pairs) + between_middles(to, pairs);
  const double apart = distance * along.norm();
  return apart_along(along, from, pairs, apart) && apart_along(along, to, pairs, apart);
}

}  // namespace softkin::contact
