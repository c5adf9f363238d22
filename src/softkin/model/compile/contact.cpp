#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/primitive_surfaces.hpp>

namespace softkin {

namespace {

constexpr double default_distance = 5e-4, most_distance = 0.05;  // over the robot's diagonal
constexpr double least_area = 0.01;          // of a vertex, over the mean of the robot's: nothing slips past small ones
constexpr double finest_sagitta = 0.1;       // over the distance
constexpr double halfspace_diagonals = 100;  // that its triangle reaches to every side
constexpr double most_diagonals = 1e6;       // from the origin
constexpr const char* robot_name = "robot";

std::string obstacle_label(const ObstacleSpec& spec) {
  return "obstacle '" + spec.name + "'";
}

[[noreturn]] void refuse_obstacle(const ObstacleSpec& spec, const std::string& what) {
  throw InvalidInput(spec.origin, obstacle_label(spec) + ": " + what);
}

struct ShapeName {
  const char* operator()(const Box&) const { return "box"; }
  const char* operator()(const Sphere&) const { return "sphere"; }
  const char* operator()(const Cylinder&) const { return "cylinder"; }
  const char* operator()(const Capsule&) const { return "capsule"; }
  const char* operator()(const Halfspace&) const { return "halfspace"; }
  const char* operator()(const TriangleSurface&) const { return "surface"; }
};

/// Of the surface of an obstacle, which need not be closed.
void check_obstacle_surface(const ObstacleSpec& spec, const TriangleSurface& surface) {
  if (surface.triangles.empty()) refuse_obstacle(spec, "the surface has no triangle");
  if (!surface.vertices.allFinite()) refuse_obstacle(spec, "the surface has a vertex that is not finite");
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const std::string triangle = "triangle " + std::to_string(t) + " (from 0) of the surface ";
    Vec3 p[3];
    for (int i = 0; i < 3; ++i) {
      const Index v = surface.triangles[t][i];
      if (v < 0 || v >= surface.vertices.rows()) refuse_obstacle(spec, triangle + "names a vertex that is not there");
      p[i] = vertex_at(surface.vertices, v);
    }
    const double longest2 =
        std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
    if (!((p[1] - p[0]).cross(p[2] - p[0]).norm() > 1e-12 * longest2)) refuse_obstacle(spec, triangle + "has no area");
  }
}

void check_obstacle_shape(const ObstacleSpec& spec) {
  if (const auto* surface = std::get_if<TriangleSurface>(&spec.shape)) return check_obstacle_surface(spec, *surface);
  const char* complaint = std::visit(
      [](const auto& shape) -> const char* {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, TriangleSurface>)
          return nullptr;
        else
          return complaint_about(shape);
      },
      spec.shape);
  if (complaint) refuse_obstacle(spec, std::string("the ") + std::visit(ShapeName{}, spec.shape) + " " + complaint);
  if (const auto* box = std::get_if<Box>(&spec.shape); box && !((box->high - box->low).minCoeff() > 0))
    refuse_obstacle(spec, "the box has no volume");
}

void check_coefficient(double friction, const std::string& owner, const Origin& origin) {
  if (!(friction >= 0) || !std::isfinite(friction))
    throw InvalidInput(origin, owner + ": friction must be 0 or more, not " + number(friction));
}

void check_obstacles(const Compilation& c, const ContactSpec& contact) {
  std::set<std::string> regions{"all"}, names;
  for (const Region& region : c.regions.regions()) regions.insert(region.name);
  for (const ObstacleSpec& spec : contact.obstacles) {
    if (spec.name.empty()) throw InvalidInput(spec.origin, "an obstacle needs a name");
    if (spec.name == robot_name)
      throw InvalidInput(spec.origin, "an obstacle cannot be named 'robot', which stands for the robot");
    if (regions.count(spec.name) > 0)
      throw InvalidInput(spec.origin,
                         obstacle_label(spec) + " has the name of a region of the robot: give it another one");
    if (!names.insert(spec.name).second) throw InvalidInput(spec.origin, "there are two obstacles '" + spec.name + "'");
    check_obstacle_shape(spec);
    if (spec.friction) check_coefficient(*spec.friction, obstacle_label(spec), spec.origin);
  }
}

bool is_obstacle(const ContactSpec& contact, const std::string& name) {
  return std::any_of(contact.obstacles.begin(), contact.obstacles.end(),
                     [&](const ObstacleSpec& spec) { return spec.name == name; });
}

/// An obstacle's name, a region's or "robot".
void check_name(const Compilation& c, const ContactSpec& contact, const std::string& name, const Origin& origin) {
  if (name == robot_name || is_obstacle(contact, name)) return;
  std::vector<std::string> known{robot_name};
  for (const ObstacleSpec& spec : contact.obstacles) known.push_back(spec.name);
  for (const Region& region : c.regions.regions()) known.push_back(region.name);
  if (name == "all" || std::find(known.begin(), known.end(), name) == known.end())
    throw InvalidInput(origin, "there is no obstacle or region '" + name + "'" +
                                   (name == "all" ? "; the whole robot is 'robot'" : suggest_name(name, known)));
  (void)c.regions.find(name, origin);
}

void check_pairs(const Compilation& c, const ContactSpec& contact) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const ContactPairSpec& spec : contact.pairs) {
    const auto [a, b] = std::minmax(spec.a, spec.b);
    const std::string owner = "the pair of '" + spec.a + "' and '" + spec.b + "'";
    check_name(c, contact, spec.a, spec.origin);
    check_name(c, contact, spec.b, spec.origin);
    check_coefficient(spec.friction, owner, spec.origin);
    if (!seen.insert({a, b}).second) throw InvalidInput(spec.origin, owner + " is given twice");
    const int obstacles = (is_obstacle(contact, a) ? 1 : 0) + (is_obstacle(contact, b) ? 1 : 0);
    if (obstacles == 2) throw InvalidInput(spec.origin, owner + " never touches: both are obstacles");
    if (obstacles == 0 && !contact.self)
      throw InvalidInput(spec.origin, owner + " never touches: both are of the robot, and 'self' is false");
  }
}

double distance_of(const ContactSpec& spec, double diagonal) {
  const double distance = spec.distance_mm.value_or(default_distance * diagonal);
  if (!(distance < most_distance * diagonal))
    throw InvalidInput(spec.origin, "contact distance " + number(distance) +
                                        " mm is too large: it must be below a twentieth of the robot's diagonal, " +
                                        number(most_distance * diagonal) + " mm");
  return distance;
}

/// Smallest at rest, of what the body is made of [MPa].
double softest(const Model& model) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto* roles : {&model.tetrahedron_roles, &model.prism_roles})
    for (const ElementRole& role : *roles)
      least = std::min(least, stiffness_at_rest(model.materials[role.material].elastic).youngs_modulus_MPa);
  return least;
}

/// Of a region of the robot that a pair names: which faces are its.
class FaceRegion {
 public:
  FaceRegion(const Compilation& c, const Region& region)
      : c_(c), region_(region), held_(static_cast<std::size_t>(c.mesh.vertices.rows())) {
    for (const Index v : region.vertices) held_[static_cast<std::size_t>(v)] = true;
  }

  [[nodiscard]] bool has(const Triangle& face, Index owner) const {
    const auto tetrahedra = static_cast<Index>(c_.tetrahedron_of.size());
    const bool inside = owner < tetrahedra ? is_in(region_.tetrahedra, c_.tetrahedron_of[owner])
                                           : is_in(region_.prisms, c_.prism_of[owner - tetrahedra]);
    return inside || std::all_of(face.begin(), face.end(), [this](Index v) { return held_[v]; });
  }

 private:
  static bool is_in(const std::vector<Index>& ascending, Index i) {
    return std::binary_search(ascending.begin(), ascending.end(), i);
  }

  const Compilation& c_;
  const Region& region_;
  std::vector<bool> held_;
};

/// The robot, then the regions that pairs name, as they come.
void add_robot_parts(Compilation& c, const ContactSpec& contact) {
  ContactModel& model = c.model.contact;
  std::vector<FaceRegion> regions;
  model.parts.push_back({.name = robot_name, .origin = contact.origin});
  for (const ContactPairSpec& spec : contact.pairs)
    for (const std::string& name : {spec.a, spec.b}) {
      if (is_obstacle(contact, name) ||
          std::any_of(model.parts.begin(), model.parts.end(), [&](const auto& part) { return part.name == name; }))
        continue;
      model.parts.push_back({.name = name, .origin = spec.origin});
      regions.emplace_back(c, c.regions.find(name, spec.origin));
    }
  std::vector<Index> owners;
  model.triangles = boundary_triangles(c.model.tetrahedra, c.model.edge_nodes, c.model.prisms, &owners);
  std::vector<bool> any(model.parts.size());
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    std::size_t part = 1;
    while (part <= regions.size() && !regions[part - 1].has(model.triangles[t], owners[t])) ++part;
    if (part > regions.size()) part = 0;
    model.part_of.push_back(static_cast<Index>(part));
    any[part] = true;
  }
  for (std::size_t part = 1; part < any.size(); ++part)
    if (!any[part])
      throw InvalidInput(model.parts[part].origin, "region '" + model.parts[part].name +
                                                       "' has no face of the robot's surface" +
                                                       " that is in no region which a pair names before it");
}

double triangle_area(const Points& vertices, const Triangle& t) {
  const Vec3 a = vertex_at(vertices, t[0]);
  return (vertex_at(vertices, t[1]) - a).cross(vertex_at(vertices, t[2]) - a).norm() / 2;
}

/// Edges of faces whose triangles come by fours, corners with the nodes beside them before the nodes.
std::vector<EdgeWithNode> edges_of_faces(const std::vector<Triangle>& triangles) {
  std::vector<EdgeWithNode> edges;
  for (std::size_t t = 0; t < triangles.size(); t += 4) {
    const auto& [a, ab, ca] = triangles[t];
    const Index b = triangles[t + 1][1], bc = triangles[t + 1][2], c = triangles[t + 2][2];
    for (const auto& [one, other, node] : {EdgeWithNode{a, b, ab}, EdgeWithNode{b, c, bc}, EdgeWithNode{c, a, ca}})
      edges.push_back({std::min(one, other), std::max(one, other), node});
  }
  std::ranges::sort(edges, {}, [](const EdgeWithNode& edge) { return edge[2]; });
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// What a uniform pressure on the triangles gives to each vertex of the robot, over the pressure; returns the mean.
double spread_area(Model& model) {
  ContactModel& contact = model.contact;
  contact.area.assign(static_cast<std::size_t>(model.rest.rows()), 0);
  double total = 0;
  std::vector<Index> vertices;
  for (const Triangle& t : contact.triangles) {
    const double area = triangle_area(model.rest, t);
    for (const Index v : t) contact.area[v] += area / 3;
    vertices.insert(vertices.end(), t.begin(), t.end());
    total += area;
  }
  sort_unique(vertices);
  const double mean = total / static_cast<double>(vertices.size());
  for (const Index v : vertices) contact.area[v] = std::max(contact.area[v], least_area * mean);
  return mean;
}

FacetedSurface facets_of(const Compilation& c, const ObstacleSpec& spec) {
  const double sagitta = finest_sagitta * c.model.contact.distance_mm;
  if (const auto* surface = std::get_if<TriangleSurface>(&spec.shape)) return {*surface, 0};
  if (const auto* box = std::get_if<Box>(&spec.shape)) return faceted(*box);
  if (const auto* sphere = std::get_if<Sphere>(&spec.shape)) return faceted(*sphere, sagitta);
  if (const auto* cylinder = std::get_if<Cylinder>(&spec.shape)) return faceted(*cylinder, sagitta);
  if (const auto* capsule = std::get_if<Capsule>(&spec.shape)) return faceted(*capsule, sagitta);
  Bounds bounds;
  for (std::size_t v = 0; v < c.model.used.size(); ++v)
    if (c.model.used[v]) bounds.extend(vertex_at(c.model.rest, static_cast<Index>(v)));
  return faceted(std::get<Halfspace>(spec.shape), bounds.center(), halfspace_diagonals * c.model.diagonal_mm);
}

/// Coordinates so far away that their rounding would show beside the robot, or that are no numbers.
void check_reach(const Compilation& c, const ObstacleSpec& spec, const Points& vertices) {
  const double most = most_diagonals * c.model.diagonal_mm;
  if (!(vertices.array().abs() <= most).all())
    refuse_obstacle(spec, "it reaches farther from the origin than a million of the robot's diagonals, " +
                              number(most, 3) + " mm: check its numbers and their unit");
}

/// Vertices of no element, which stay where they are.
void append_vertices(Model& model, const Points& vertices, double area) {
  const Index first = static_cast<Index>(model.rest.rows()), rows = first + static_cast<Index>(vertices.rows());
  for (Points* points : {&model.rest, &model.held, &model.dead_load}) points->conservativeResize(rows, 3);
  model.rest.bottomRows(vertices.rows()) = vertices;
  model.held.bottomRows(vertices.rows()) = vertices;
  model.dead_load.bottomRows(vertices.rows()).setZero();
  const auto count = static_cast<std::size_t>(rows);
  model.fixed.resize(count, {true, true, true});
  model.support_of.resize(count, {-1, -1, -1});
  model.used.resize(count, false);
  model.contact.area.resize(count, area);
  model.contact.obstacle_vertices += static_cast<Index>(vertices.rows());
}

void add_obstacle(Compilation& c, const ObstacleSpec& spec, double area) {
  ContactModel& contact = c.model.contact;
  const FacetedSurface made = facets_of(c, spec);
  check_reach(c, spec, made.surface.vertices);
  const auto part = static_cast<Index>(contact.parts.size()), first = static_cast<Index>(c.model.rest.rows());
  contact.parts.push_back({.name = spec.name,
                           .rank = ContactRank::obstacle,
                           .halfspace = std::holds_alternative<Halfspace>(spec.shape),
                           .origin = spec.origin});
  for (Triangle triangle : made.surface.triangles) {
    for (Index& v : triangle) v += first;
    contact.triangles.push_back(triangle);
    contact.part_of.push_back(part);
  }
  append_vertices(c.model, made.surface.vertices, area);
  if (made.sagitta_mm > finest_sagitta * contact.distance_mm)
    c.model.notes.push_back("The " + counted(made.surface.triangles.size(), "facet") + " of " + obstacle_label(spec) +
                            " lie up to " + number(made.sagitta_mm, 3) + " mm inside its " +
                            std::visit(ShapeName{}, spec.shape) + ".");
}

void set_pairs(ContactModel& model, const ContactSpec& contact) {
  const std::size_t count = model.parts.size();
  std::map<std::string, std::optional<double>> of_obstacle;
  std::map<std::string, std::size_t> at;
  for (const ObstacleSpec& spec : contact.obstacles) of_obstacle[spec.name] = spec.friction;
  for (std::size_t a = 0; a < count; ++a) {
    at[model.parts[a].name] = a;
    for (std::size_t b = 0; b < count; ++b) {
      ContactPair pair{true, contact.friction};
      const auto is_solid = [&](std::size_t part) { return model.parts[part].rank == ContactRank::obstacle; };
      if (is_solid(a) == is_solid(b)) pair.touch = !is_solid(a) && contact.self;
      for (const std::size_t part : {a, b})
        if (is_solid(part)) pair.friction = of_obstacle[model.parts[part].name].value_or(contact.friction);
      model.pairs.push_back(pair);
    }
  }
  for (const ContactPairSpec& spec : contact.pairs) {
    const std::size_t a = at.at(spec.a), b = at.at(spec.b);
    model.pairs[a * count + b].friction = model.pairs[b * count + a].friction = spec.friction;
  }
}

}  // namespace

void check_contact(const Compilation& c) {
  if (!c.spec.contact) return;
  const ContactSpec& contact = *c.spec.contact;
  if (c.spec.formulation != Formulation::physical)
    throw InvalidInput(contact.origin,
                       "contact and obstacles belong to the physical formulation, and this robot is of target shapes: "
                       "give elastic constants and 'formulation: physical', or leave them out");
  if (contact.distance_mm && !(*contact.distance_mm > 0 && std::isfinite(*contact.distance_mm)))
    throw InvalidInput(contact.origin, "contact distance must be above 0 mm, not " + number(*contact.distance_mm));
  check_coefficient(contact.friction, "contact", contact.origin);
  check_obstacles(c, contact);
  check_pairs(c, contact);
}

void compile_contact(Compilation& c) {
  if (!c.spec.contact) return;
  const ContactSpec& spec = *c.spec.contact;
  ContactModel& contact = c.model.contact;
  contact.distance_mm = distance_of(spec, c.model.diagonal_mm);
  contact.modulus_MPa = softest(c.model);
  add_robot_parts(c, spec);
  if (!c.model.edge_nodes.empty()) contact.edges = edges_of_faces(contact.triangles);
  const double mean = spread_area(c.model);
  for (const ObstacleSpec& obstacle : spec.obstacles) add_obstacle(c, obstacle, least_area * mean);
  set_pairs(contact, spec);
}

}  // namespace softkin
