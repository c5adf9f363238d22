#include <algorithm>
#include <cmath>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/sensor.hpp>

namespace softkin {

namespace {

// Of the robot's diagonal. Real parts of a robot are seldom smaller than a hundredth of it, and coordinates in metres
// beside a mesh in mm are a thousandth: what is between is left alone.
constexpr double tiny_part = 0.01;
// A point that is meant in metres is not a node beside the origin: a thousand times its coordinates lead away from it.
constexpr double clear_of_origin = 0.05;
// A box may reach beyond the robot to choose its surface.
constexpr double reach_around = 0.5;
// An obstacle that is farther is never reached.
constexpr double out_of_reach = 100;

constexpr const char* unit_of_coordinates =
    " Coordinates are in the scene's unit of lengths, 'units: {length: U}', mm where none is given.";

struct Extent {
  Bounds bounds;

  void add_ball(const Vec3& center, double radius) {
    bounds.extend(center - Vec3::Constant(radius)).extend(center + Vec3::Constant(radius));
  }
  void operator()(const Box& of) { bounds.extend(of.low).extend(of.high); }
  void operator()(const Sphere& of) { add_ball(of.center, of.radius); }
  void operator()(const Cylinder& of) { add_balls(of.start, of.end, of.radius); }
  void operator()(const Capsule& of) { add_balls(of.start, of.end, of.radius); }
  void operator()(const TriangleSurface& of) {
    for (Index v = 0; v < of.vertices.rows(); ++v) bounds.extend(vertex_at(of.vertices, v));
  }
  template <class Unbounded>
  void operator()(const Unbounded&) {}

 private:
  void add_balls(const Vec3& a, const Vec3& b, double radius) {
    add_ball(a, radius);
    add_ball(b, radius);
  }
};

template <class Shape>
Bounds bounds_of_shape(const Shape& shape) {
  Extent extent;
  std::visit([&](const auto& of) { extent(of); }, shape);
  return extent.bounds;
}

/// Warns of coordinates that a thousand times larger would be plausible, and of sizes that no robot's parts have.
class MisplacedParts {
 public:
  explicit MisplacedParts(Compilation& c) : c_(c), diagonal_(c.model.diagonal_mm) {
    const Model& model = c.model;
    for (Index v = 0; v < model.rest.rows(); ++v)
      if (model.elements.used[v]) robot_.extend(vertex_at(model.rest, v));
  }

  void doubt_all() {
    const RobotSpec& spec = c_.spec;
    for (const ActuatorSpec& actuator : spec.actuators)
      if (const auto* cable = actuator.as<CableSpec>())
        if (const auto points = coordinates(cable->points)) doubt_path("cable '" + actuator.name + "'", *points);
    for (const FibreSpec& fibre : spec.fibres)
      if (const auto* points = std::get_if<std::vector<Vec3>>(&fibre.path))
        doubt_path("fibre '" + fibre.name + "'", *points);
    for (const auto& sensor : spec.sensors)
      if (sensor->kind == SensorKind::length) doubt_path("sensor '" + sensor->name + "'", sensor->points);
    for (const MarkerSpec& marker : spec.markers) doubt_point("Marker '" + marker.name + "'", marker.at);
    for (const ForceSpec& force : spec.loads.forces) doubt_point("The point of force '" + force.name + "'", force.at);
    doubt_regions();
    if (!spec.contact) return;
    for (const ObstacleSpec& obstacle : spec.contact->obstacles)
      doubt_solid("Obstacle '" + obstacle.name + "'", obstacle);
    for (const BodySpec& body : spec.contact->bodies) doubt_solid("Body '" + body.name + "'", body);
  }

 private:
  /// None where one of the points is a region.
  [[nodiscard]] static std::optional<std::vector<Vec3>> coordinates(const std::vector<PointRef>& points) {
    std::vector<Vec3> all;
    for (const PointRef& point : points) {
      if (!std::holds_alternative<Vec3>(point.point)) return std::nullopt;
      all.push_back(std::get<Vec3>(point.point));
    }
    return all;
  }

  void warn(const std::string& what, double now_mm) {
    std::string text = what + ", where the robot is " + number(diagonal_, 4) + " mm across";
    const double as_metres = 1000 * now_mm;
    const bool plausible = as_metres >= tiny_part * diagonal_ && as_metres <= 2 * diagonal_;
    text += plausible ? "; a thousand times that (m taken for mm) would be " + number(as_metres, 4) + " mm: is it that?"
                      : ".";
    c_.model.warnings.push_back(text + unit_of_coordinates);
  }

  void doubt_path(const std::string& what, const std::vector<Vec3>& points) {
    Bounds bounds;
    for (const Vec3& point : points) bounds.extend(point);
    const double span = points.size() < 2 ? diagonal_ : bounds.diagonal().norm();
    if (span < tiny_part * diagonal_) warn("The points of " + what + " span " + number(span, 4) + " mm", span);
  }

  /// Is it next to the origin, and a thousand times that a place of the robot?
  [[nodiscard]] bool is_in_metres(const Bounds& bounds) const {
    if (bounds.min().cwiseAbs().maxCoeff() >= tiny_part * diagonal_) return false;
    if (bounds.max().cwiseAbs().maxCoeff() >= tiny_part * diagonal_) return false;
    Bounds near = robot_;
    near.extend(robot_.min() - Vec3::Constant(reach_around * diagonal_));
    near.extend(robot_.max() + Vec3::Constant(reach_around * diagonal_));
    const Vec3 center = 1000 * bounds.center();
    return near.contains(1000 * bounds.min()) && near.contains(1000 * bounds.max()) &&
           center.norm() > clear_of_origin * diagonal_ && center.norm() > 0.25 * 1000 * bounds.diagonal().norm();
  }

  void doubt_point(const std::string& what, const PointRef& at) {
    const auto* point = std::get_if<Vec3>(&at.point);
    if (point == nullptr || !point->allFinite()) return;
    const Bounds bounds(*point);
    if (is_in_metres(bounds) && robot_.exteriorDistance(1000 * *point) < tiny_part * diagonal_)
      warn(what + " is " + number(point->norm(), 4) + " mm from the origin", point->norm());
  }

  void doubt_region(const std::string& what, const Selector& selector) {
    const Bounds bounds = bounds_of_shape(selector);
    if (!bounds.isEmpty() && is_in_metres(bounds))
      warn(what + " measures " + number(bounds.diagonal().norm(), 4) + " mm from corner to corner",
           bounds.diagonal().norm());
  }

  void doubt_place(const RegionRef& place) {
    if (const auto* selector = std::get_if<Selector>(&place.region))
      doubt_region("The" + label(place).substr(3) + " at " + place.origin.text(), *selector);
  }

  void doubt_regions() {
    const RobotSpec& spec = c_.spec;
    for (const RegionSpec& region : spec.regions) doubt_region("Region '" + region.name + "'", region.selector);
    for (const FixedSpec& fixed : spec.fixed) doubt_place(fixed.where);
    for (const RigidSpec& rigid : spec.rigid) doubt_place(rigid.where);
    for (const RegionRef& place : spec.voids) doubt_place(place);
    for (const TractionSpec& traction : spec.loads.tractions) doubt_place(traction.where);
    for (const auto& layer : spec.layers)
      if (const auto* place = std::get_if<RegionRef>(&layer->where)) doubt_place(*place);
  }

  template <class Spec>
  void doubt_solid(const std::string& what, const Spec& spec) {
    const Bounds bounds = bounds_of_shape(spec.shape);
    if (bounds.isEmpty()) {
      doubt_halfspace(what, spec.shape);
      return;
    }
    const double size = bounds.diagonal().norm();
    if (size < tiny_part * diagonal_)
      warn(what + " measures " + number(size, 4) + " mm from corner to corner", size);
    else if (const double distance = robot_.exteriorDistance(bounds.center()) - size / 2;
             distance > out_of_reach * diagonal_)
      warn(what + " is " + number(distance, 4) + " mm from the robot", distance);
  }

  void doubt_halfspace(const std::string& what, const ObstacleShape& shape) {
    const auto* plane = std::get_if<Halfspace>(&shape);
    if (plane == nullptr) return;
    const double distance = plane->normal.stableNormalized().dot(robot_.center() - plane->point);
    if (distance > out_of_reach * diagonal_) warn(what + " is " + number(distance, 4) + " mm from the robot", distance);
  }

  Compilation& c_;
  double diagonal_;
  Bounds robot_;
};

}  // namespace

void doubt_places(Compilation& c) {
  MisplacedParts(c).doubt_all();
  const Model& model = c.model;
  bool any = false;
  for (std::size_t v = 0; v < model.held.support_of.size(); ++v) {
    if (!model.elements.used[v]) continue;
    any = true;
    const auto& axes = model.held.support_of[v];
    if (std::any_of(axes.begin(), axes.end(), [](Index support) { return support < 0; })) return;
  }
  if (any)
    c.model.warnings.emplace_back(
        "Every vertex of the robot is held by an entry of 'fixed', so that nothing can move: hold a part of it, such "
        "as "
        "one end; a shape in 'fixed' is in the scene's unit of lengths.");
}

}  // namespace softkin
