#pragma once

#include <softkin/core/types.hpp>
#include <softkin/energy/pack.hpp>

namespace softkin::physical {

// Access to one element of a block.

inline void set_lane(energy::Pack3& vector, int lane, const Vec3& value) {
  vector.x[lane] = value[0];
  vector.y[lane] = value[1];
  vector.z[lane] = value[2];
}

inline Vec3 lane_of(const energy::Pack3& vector, int lane) {
  return {vector.x[lane], vector.y[lane], vector.z[lane]};
}

inline Mat3 lane_of(const energy::Pack33& matrix, int lane) {
  Mat3 one;
  for (int r = 0; r < 3; ++r) one.row(r) = lane_of(matrix.row[r], lane).transpose();
  return one;
}

}  // namespace softkin::physical
