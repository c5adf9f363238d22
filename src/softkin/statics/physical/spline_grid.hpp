#pragma once

#include <softkin/model/magnetic_field.hpp>

namespace softkin::physical {

/// A flux density at a place and its derivatives there.
struct Flux {
  Vec3 value = Vec3::Zero();                                             // [mT]
  Mat3 slope = Mat3::Zero();                                             // (i, j): of b_i along x_j [mT/mm]
  std::array<Mat3, 3> second{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};  // of each b_i [mT/mm^2]
};

/// A field between the points of a regular grid: the tricubic spline through them, with two continuous derivatives, so
/// that Newton's method converges; its third derivatives do not jump at the second and last but one planes.
///
/// source  de Boor 1978, "A practical guide to splines": not-a-knot, in B-splines
class SplineGrid {
 public:
  explicit SplineGrid(const GridField& grid);

  /// Adds scale times the field. False outside the grid.
  bool add(const Vec3& place, double scale, Flux& out) const;

 private:
  Vec3 low_, step_;
  std::array<Index, 3> counts_;
  std::vector<Vec3> coefficients_;  // counts + 2 along each axis, x fastest
};

}  // namespace softkin::physical
