#pragma once

#include <softkin/core/types.hpp>

namespace softkin {

// Shapes of regions and of obstacles. Lengths in mm.
struct Box {
  Vec3 low, high;  // corners
};
struct Sphere {       // the whole ball
  Vec3 center;        // its middle
  double radius = 0;  // > 0
};
struct Cylinder {     // finite, flat ends
  Vec3 start, end;    // middles of the ends
  double radius = 0;  // > 0
};
struct Capsule {      // all that is at most `radius` away from the line between the two
  Vec3 start, end;    // ends of the line
  double radius = 0;  // > 0
};
struct Halfspace {     // of a region: the side to which the normal points; of an obstacle: the other one
  Vec3 point, normal;  // of its plane; out of it, of any length > 0
};

/// What is wrong with a shape, "needs a radius above 0", or nothing.
[[nodiscard]] const char* complaint_about(const Box& box);
[[nodiscard]] const char* complaint_about(const Sphere& sphere);
[[nodiscard]] const char* complaint_about(const Cylinder& cylinder);
[[nodiscard]] const char* complaint_about(const Capsule& capsule);
[[nodiscard]] const char* complaint_about(const Halfspace& halfspace);

}  // namespace softkin
