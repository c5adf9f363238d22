#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/core/dense.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/primitive_surfaces.hpp>
#include <softkin/model/mesh/shells.hpp>

namespace softkin {

namespace {

constexpr double finest_sagitta = 0.1;       // over the distance
constexpr double halfspace_diagonals = 100;  // that its triangle reaches to every side
constexpr double max_diagonals = 1e6;        // from the origin
constexpr double kilograms = 1e-9;           // of a mm^3 at 1 kg/m^3
// of commands: so far that only numbers in a wrong unit are farther
constexpr double max_path = 10;   // over the robot's diagonal
constexpr double max_force = 10;  // over the softest modulus times the diagonal's square
constexpr const char* axis_names = "xyz";

std::string label(const ObstacleSpec& spec) {
  return "obstacle '" + spec.name + "'";
}

std::string label(const BodySpec& spec) {
  return "body '" + spec.name + "'";
}

template <class Spec>
[[noreturn]] void refuse_solid(const Spec& spec, const std::string& what) {
  throw InvalidInput(spec.origin, label(spec) + ": " + what);
}

struct ShapeName {
  const char* operator()(const Box&) const { return "box"; }
  const char* operator()(const Sphere&) const { return "sphere"; }
  const char* operator()(const Cylinder&) const { return "cylinder"; }
  const char* operator()(const Capsule&) const { return "capsule"; }
  const char* operator()(const Halfspace&) const { return "halfspace"; }
  const char* operator()(const TriangleSurface&) const { return "surface"; }
};

/// Of the surface of an obstacle or body; the first complaint, or "".
std::string complaint_about_surface(const TriangleSurface& surface) {
  if (surface.triangles.empty()) return "the surface has no triangle";
  if (!surface.vertices.allFinite()) return "the surface has a vertex that is not finite";
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const std::string triangle = "triangle " + std::to_string(t) + " (from 0) of the surface ";
    Vec3 p[3];
    for (int i = 0; i < 3; ++i) {
      const Index v = surface.triangles[t][i];
      if (v < 0 || v >= surface.vertices.rows()) return triangle + "names a vertex that is not there";
      p[i] = vertex_at(surface.vertices, v);
    }
    const double longest2 =
        std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
    if (!((p[1] - p[0]).cross(p[2] - p[0]).norm() > 1e-12 * longest2)) return triangle + "has no area";
  }
  return "";
}

std::string complaint_about_solid(const ObstacleShape& solid) {
  if (const auto* surface = std::get_if<TriangleSurface>(&solid)) return complaint_about_surface(*surface);
  const char* complaint = std::visit(
      [](const auto& shape) -> const char* {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, TriangleSurface>)
          return nullptr;
        else
          return complaint_about(shape);
      },
      solid);
  if (complaint) return std::string("the ") + std::visit(ShapeName{}, solid) + " " + complaint;
  if (const auto* box = std::get_if<Box>(&solid); box && !((box->high - box->low).minCoeff() > 0))
    return "the box has no volume";
  return "";
}

/// Checks the settings that obstacles and bodies have in common.
template <class Spec>
void check_solid(const Spec& spec, const std::set<std::string>& regions, std::set<std::string>& names) {
  const std::string kind = label(spec).substr(0, label(spec).find(' '));
  const std::string article = kind == "obstacle" ? "an " : "a ";
  if (spec.name.empty()) throw InvalidInput(spec.origin, article + kind + " needs a name");
  if (spec.name == robot_part_name)
    throw InvalidInput(spec.origin, article + kind + " cannot be named 'robot', which stands for the robot");
  if (regions.count(spec.name) > 0) refuse_solid(spec, "a region of the robot has that name, too: give it another one");
  if (!names.insert(spec.name).second)
    throw InvalidInput(spec.origin, "there are two obstacles or bodies '" + spec.name + "'");
  if (const std::string complaint = complaint_about_solid(spec.shape); !complaint.empty())
    refuse_solid(spec, complaint);
  if (spec.friction) check_coefficient(*spec.friction, label(spec), spec.origin);
}

template <class Spec>
FacetedSurface facets_of(const Compilation& c, const Spec& spec) {
  const double sagitta = finest_sagitta * c.model.contact.distance_mm;
  if (const auto* surface = std::get_if<TriangleSurface>(&spec.shape)) return {*surface, 0};
  if (const auto* box = std::get_if<Box>(&spec.shape)) return faceted(*box);
  if (const auto* sphere = std::get_if<Sphere>(&spec.shape)) return faceted(*sphere, sagitta);
  if (const auto* cylinder = std::get_if<Cylinder>(&spec.shape)) return faceted(*cylinder, sagitta);
  if (const auto* capsule = std::get_if<Capsule>(&spec.shape)) return faceted(*capsule, sagitta);
  Bounds bounds;
  for (std::size_t v = 0; v < c.model.elements.used.size(); ++v)
    if (c.model.elements.used[v]) bounds.extend(vertex_at(c.model.rest, v));
  return faceted(std::get<Halfspace>(spec.shape), bounds.center(), halfspace_diagonals * c.model.diagonal_mm);
}

/// Refuses coordinates so far away that their rounding errors would matter at the robot's size, or that are no numbers.
template <class Spec>
void check_reach(const Compilation& c, const Spec& spec, const Points& vertices) {
  const double most = max_diagonals * c.model.diagonal_mm;
  if (!(vertices.array().abs() <= most).all())
    refuse_solid(spec, "it reaches farther from the origin than a million of the robot's diagonals, " +
                           number(most, 3) + " mm: check its numbers and their unit");
}

/// Appends vertices of no element. fixed: they stay in place, apart from commanded motions
void append_vertices(Model& model, const Points& vertices, bool fixed) {
  const Index first = model.rest.rows(), rows = first + vertices.rows();
  for (Points* points : {&model.rest, &model.held.at, &model.loads.dead}) points->conservativeResize(rows, 3);
  model.rest.bottomRows(vertices.rows()) = vertices;
  model.held.at.bottomRows(vertices.rows()) = vertices;
  model.loads.dead.bottomRows(vertices.rows()).setZero();
  const std::size_t count = rows;
  model.held.fixed.resize(count, {fixed, fixed, fixed});
  model.held.support_of.resize(count, {-1, -1, -1});
  model.elements.used.resize(count, false);
  model.contact.other_vertices += vertices.rows();
}

/// Adds the surface as a part, its vertices at the end of the model's; returns the first of them.
template <class Spec>
Index add_part(Compilation& c, const Spec& spec, const FacetedSurface& made, ContactRank rank) {
  ContactModel& contact = c.model.contact;
  check_reach(c, spec, made.surface.vertices);
  const Index part = contact.parts.size(), first = c.model.rest.rows();
  contact.parts.push_back({.name = spec.name,
                           .rank = rank,
                           .halfspace = std::holds_alternative<Halfspace>(spec.shape),
                           .origin = spec.origin});
  for (Triangle triangle : made.surface.triangles) {
    for (Index& v : triangle) v += first;
    contact.triangles.push_back(triangle);
    contact.part_of.push_back(part);
  }
  append_vertices(c.model, made.surface.vertices, rank == ContactRank::obstacle);
  if (made.sagitta_mm > finest_sagitta * contact.distance_mm)
    c.model.notes.push_back("The " + counted(made.surface.triangles.size(), "facet") + " of " + label(spec) +
                            " lie up to " + number(made.sagitta_mm, 3) + " mm inside its " +
                            std::visit(ShapeName{}, spec.shape) + ".");
  return first;
}

/// Adds a command of an obstacle or a body.
void add_command(Compilation& c, const std::string& name, Drive drive, double most, const Origin& origin) {
  Model& model = c.model;
  for (const Actuator& actuator : model.actuators)
    if (actuator.name == name)
      throw InvalidInput(origin,
                         "the command '" + name + "' has the name of an actuator: give one of them another name");
  Actuator command;
  command.name = name;
  command.drive = std::move(drive);
  const bool holds = command.is<HoldCommand>();
  command.control = holds ? Control::ratio : Control::load;
  command.rest = holds ? 1 : 0;
  command.high = most;
  command.low = holds ? 0 : -most;
  model.actuators.push_back(std::move(command));
}

void add_obstacle(Compilation& c, const ObstacleSpec& spec, double area) {
  const Index part = c.model.contact.parts.size();
  (void)add_part(c, spec, facets_of(c, spec), ContactRank::obstacle);
  c.model.contact.area.resize(c.model.rest.rows(), area);
  for (int axis = 0; axis < 3; ++axis)
    if (spec.motion[axis])
      add_command(c, spec.name + "_" + axis_names[axis], MotionCommand{part, axis}, max_path * c.model.diagonal_mm,
                  spec.origin);
}

/// Weights of points whose mean they make, wherever it is: the smallest that do.
EmbeddedPoint mean_at(const Points& points, Index first, const Vec3& mean) {
  const Vec3 middle = points.colwise().mean().transpose();
  const Points arms = points.rowwise() - middle.transpose();
  const Vec3 slope = solve_symmetric(arms.transpose() * arms, mean - middle);
  EmbeddedPoint point;
  for (Index i = 0; i < points.rows(); ++i) {
    point.vertices.push_back(first + i);
    point.weights.push_back(1.0 / static_cast<double>(points.rows()) + arms.row(i).dot(slope));
  }
  return point;
}

void weigh(Compilation& c, const BodySpec& spec, FreeBody& body, double volume) {
  body.mass_kg = spec.density * kilograms * volume;
  if (!c.spec.loads.gravity.isZero(0) && body.mass_kg == 0)
    c.model.notes.push_back("The " + label(spec) + " has no density and so no weight.");
  for (std::size_t i = 0; i < body.center.vertices.size(); ++i)
    c.model.loads.dead.row(body.center.vertices[i]) +=
        body.center.weights[i] * body.mass_kg * c.spec.loads.gravity.transpose();
}

void add_body(Compilation& c, const BodySpec& spec, double min_area) {
  Model& model = c.model;
  FacetedSurface made = facets_of(c, spec);
  try {
    made.surface.triangles = turned_outwards(made.surface.vertices, std::move(made.surface.triangles));
  } catch (const InvalidInput& error) {
    refuse_solid(spec, error.what());
  }
  double volume = 0;
  Vec3 center = Vec3::Zero();
  for (const Shell& shell : shells_of(made.surface.vertices, made.surface.triangles)) {
    volume += shell.volume;
    center += shell.volume * shell.center;
  }
  center /= volume;
  const Index first = add_part(c, spec, made, ContactRank::body);
  const auto& triangles = made.surface.triangles;
  std::vector<double>& area = model.contact.area;
  area.resize(model.rest.rows(), 0);
  for (const Triangle& t : triangles)
    for (const Index v : t) area[first + v] += triangle_area(made.surface.vertices, t) / 3;
  FreeBody body;
  body.name = spec.name;
  body.center = mean_at(made.surface.vertices, first, center);
  for (Index v = first; v < model.rest.rows(); ++v) {
    body.vertices.push_back(v);
    area[v] = std::max(area[v], min_area);
  }
  weigh(c, spec, body, volume);
  for (const Marker& marker : model.markers)
    if (marker.name == spec.name) refuse_solid(spec, "a marker has that name, and its center of mass becomes one, too");
  model.markers.push_back({spec.name, body.center});
  const Index index = model.bodies.size();
  model.rigid.push_back({spec.name, body.vertices});
  model.bodies.push_back(std::move(body));
  add_command(c, spec.name + "_hold", HoldCommand{index}, 1, spec.origin);
  const double max_N = max_force * model.contact.modulus_MPa * model.diagonal_mm * model.diagonal_mm;
  for (int axis = 0; axis < 3; ++axis)
    add_command(c, spec.name + "_f" + axis_names[axis], ForceCommand{.body = index, .axis = axis}, max_N, spec.origin);
}

}  // namespace

void check_coefficient(double friction, const std::string& owner, const Origin& origin) {
  if (!(friction >= 0) || !std::isfinite(friction))
    throw InvalidInput(origin, owner + ": friction must be 0 or more, not " + number(friction));
}

double triangle_area(const Points& vertices, const Triangle& t) {
  const Vec3 a = vertex_at(vertices, t[0]);
  return (vertex_at(vertices, t[1]) - a).cross(vertex_at(vertices, t[2]) - a).norm() / 2;
}

void check_surroundings(const Compilation& c, const ContactSpec& contact) {
  std::set<std::string> regions{"all"}, names;
  for (const Region& region : c.regions.regions()) regions.insert(region.name);
  for (const BodySpec& spec : contact.bodies) {
    check_solid(spec, regions, names);
    if (std::holds_alternative<Halfspace>(spec.shape)) refuse_solid(spec, "a half-space has no end: a body needs one");
    if (!(spec.density >= 0) || !std::isfinite(spec.density))
      refuse_solid(spec, "density must be 0 kg/m^3 or more, not " + number(spec.density));
  }
  for (const ObstacleSpec& spec : contact.obstacles) check_solid(spec, regions, names);
}

void add_surroundings(Compilation& c, const ContactSpec& contact, double min_area) {
  for (const BodySpec& spec : contact.bodies) add_body(c, spec, min_area);
  for (const ObstacleSpec& spec : contact.obstacles) add_obstacle(c, spec, min_area);
}

}  // namespace softkin
