#include <array>
#include <cmath>
#include <softkin/model/compile/selectors.hpp>

namespace softkin {

namespace {

struct HoldsPoint {
  const Vec3& point;
  double tolerance;

  bool operator()(const Box& box) const {
    return ((point - box.low).array() >= -tolerance).all() && ((box.high - point).array() >= -tolerance).all();
  }
  bool operator()(const Sphere& sphere) const { return (point - sphere.center).norm() <= sphere.radius + tolerance; }
  bool operator()(const Cylinder& cylinder) const {
    const Vec3 offset = point - cylinder.start;
    const double length = (cylinder.end - cylinder.start).norm();
    const Vec3 axis = (cylinder.end - cylinder.start) / length;
    const double along = offset.dot(axis);
    return along >= -tolerance && along <= length + tolerance &&
           (offset - along * axis).norm() <= cylinder.radius + tolerance;
  }
  bool operator()(const Halfspace& halfspace) const {
    return (point - halfspace.point).dot(halfspace.normal.normalized()) >= -tolerance;
  }
  bool operator()(const VertexList&) const { return false; }
  bool operator()(const ElementList&) const { return false; }
};

// The complaint about a shape, or nothing.
struct Complaint {
  const char* operator()(const Box& box) const {
    if (!box.low.allFinite() || !box.high.allFinite()) return "has a corner that is not finite";
    return (box.low.array() <= box.high.array()).all() ? nullptr : "has a low corner above its high corner";
  }
  const char* operator()(const Sphere& sphere) const {
    if (!sphere.center.allFinite()) return "has a center that is not finite";
    return positive(sphere.radius) ? nullptr : "needs a radius above 0";
  }
  const char* operator()(const Cylinder& cylinder) const {
    if (!cylinder.start.allFinite() || !cylinder.end.allFinite()) return "has an end that is not finite";
    if (!positive(cylinder.radius)) return "needs a radius above 0";
    return positive((cylinder.end - cylinder.start).norm()) ? nullptr : "starts where it ends";
  }
  const char* operator()(const Halfspace& halfspace) const {
    if (!halfspace.point.allFinite()) return "has a point that is not finite";
    return positive(halfspace.normal.norm()) ? nullptr : "needs a normal other than 0";
  }
  const char* operator()(const VertexList&) const { return nullptr; }
  const char* operator()(const ElementList&) const { return nullptr; }

  static bool positive(double x) { return x > 0 && std::isfinite(x); }
};

}  // namespace

std::string kind_of(const Selector& selector) {
  static const std::array<const char*, std::variant_size_v<Selector>> kinds{
      "box", "sphere", "cylinder", "halfspace", "list of vertices", "list of elements"};
  return kinds[selector.index()];
}

void check_shape(const Selector& selector, const Origin& origin) {
  if (const char* complaint = std::visit(Complaint{}, selector))
    throw InvalidInput(origin, "the " + kind_of(selector) + " " + complaint);
}

bool holds(const Selector& selector, const Vec3& point, double tolerance) {
  return std::visit(HoldsPoint{point, tolerance}, selector);
}

}  // namespace softkin
