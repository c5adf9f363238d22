#pragma once

#include <softkin/core/types.hpp>
#include <string>

namespace softkin {

/// A direction at every place of the robot at rest, of fibres or of a growth. Its sign does not matter.
struct DirectionSpec {
  /// How it changes from place to place.
  enum class Kind {
    uniform,          // the same everywhere
    radial,           // away from a line
    circumferential,  // around it, or turned from there towards the line
    samples           // of every element the one nearest to its centroid
  };
  Kind kind = Kind::uniform;   // which of the following members define it
  Vec3 uniform{1, 0, 0};       // not 0
  Vec3 center{0, 0, 0};        // a point of the line [mm]
  Vec3 axis{0, 0, 1};          // its direction, not 0
  double degrees = 0;          // circumferential: from the circumference towards the axis
  Points places{}, samples{};  // #samples by 3 [mm], [-]
  std::string file{};          // of the samples, for messages
};

}  // namespace softkin
