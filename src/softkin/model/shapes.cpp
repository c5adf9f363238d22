#include <cmath>
#include <softkin/model/shapes.hpp>

namespace softkin {

namespace {

bool positive_and_finite(double x) {
  return x > 0 && std::isfinite(x);
}

template <class Rod>
const char* complaint_about_rod(const Rod& rod) {
  if (!rod.start.allFinite() || !rod.end.allFinite()) return "has an end that is not finite";
  if (!positive_and_finite(rod.radius)) return "needs a radius above 0";
  return positive_and_finite((rod.end - rod.start).norm()) ? nullptr : "starts where it ends";
}

}  // namespace

const char* complaint_about(const Box& box) {
  if (!box.low.allFinite() || !box.high.allFinite()) return "has a corner that is not finite";
  return (box.low.array() <= box.high.array()).all() ? nullptr : "has a low corner above its high corner";
}

const char* complaint_about(const Sphere& sphere) {
  if (!sphere.center.allFinite()) return "has a center that is not finite";
  return positive_and_finite(sphere.radius) ? nullptr : "needs a radius above 0";
}

const char* complaint_about(const Cylinder& cylinder) {
  return complaint_about_rod(cylinder);
}

const char* complaint_about(const Capsule& capsule) {
  return complaint_about_rod(capsule);
}

const char* complaint_about(const Halfspace& halfspace) {
  if (!halfspace.point.allFinite()) return "has a point that is not finite";
  return positive_and_finite(halfspace.normal.norm()) ? nullptr : "needs a normal other than 0";
}

}  // namespace softkin
