#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <softkin/model/compile/layers.hpp>
#include <softkin/model/compile/parts.hpp>

namespace softkin {

namespace {

constexpr double default_distance = 5e-4, max_distance = 0.05;  // over the robot's diagonal
constexpr double min_area = 0.01;  // of a vertex, over the mean of the robot's: nothing slips past small ones
constexpr const char* robot_name = robot_part_name;

bool is_obstacle(const ContactSpec& contact, const std::string& name) {
  return std::any_of(contact.obstacles.begin(), contact.obstacles.end(),
                     [&](const ObstacleSpec& spec) { return spec.name == name; });
}

bool is_body(const ContactSpec& contact, const std::string& name) {
  return std::any_of(contact.bodies.begin(), contact.bodies.end(),
                     [&](const BodySpec& spec) { return spec.name == name; });
}

bool is_beside(const ContactSpec& contact, const std::string& name) {
  return is_obstacle(contact, name) || is_body(contact, name);
}

/// Whose a region is, of one robot or several.
Index robot_of_region(const Compilation& c, const std::string& region, const Origin& origin) {
  const std::vector<Index>& vertices = c.regions.find(region, origin).vertices;
  if (vertices.empty()) return 0;
  const auto of = [&](Index v) { return robot_of(c.spec, &RobotPart::vertices, v); };
  const Index first = of(vertices.front()), last = of(vertices.back());
  if (first != last)
    throw InvalidInput(origin, "region '" + region + "' is of robot '" + c.spec.robots[first].name +
                                   "' and of robot '" + c.spec.robots[last].name +
                                   "': contacts are of one of them; name a region of each");
  return first;
}

/// An obstacle's or a body's name, a region's or "robot".
void check_name(const Compilation& c, const ContactSpec& contact, const std::string& name, const Origin& origin) {
  if (name == robot_name || is_beside(contact, name)) return;
  std::vector<std::string> known{robot_name};
  for (const ObstacleSpec& spec : contact.obstacles) known.push_back(spec.name);
  for (const BodySpec& spec : contact.bodies) known.push_back(spec.name);
  for (const Region& region : c.regions.regions()) known.push_back(region.name);
  if (name == "all" || std::find(known.begin(), known.end(), name) == known.end())
    throw InvalidInput(origin, "there is no obstacle, body or region '" + name + "'" +
                                   (name == "all" ? "; the whole robot is 'robot'" : suggest_name(name, known)));
  (void)robot_of_region(c, name, origin);
}

/// May surfaces of two names touch, by all that is said but friction?
bool may_touch(const Compilation& c, const ContactSpec& contact, const ContactPairSpec& pair) {
  if (contact.self || is_beside(contact, pair.a) || is_beside(contact, pair.b)) return true;
  const bool any = pair.a == robot_name || pair.b == robot_name;
  return any ? c.spec.robots.size() > 1
             : robot_of_region(c, pair.a, pair.origin) != robot_of_region(c, pair.b, pair.origin);
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
    if (is_obstacle(contact, a) && is_obstacle(contact, b))
      throw InvalidInput(spec.origin, owner + " never touches: both are obstacles");
    if (a == b && is_body(contact, a)) throw InvalidInput(spec.origin, owner + " never touches: a body is rigid");
    if (!may_touch(c, contact, spec))
      throw InvalidInput(spec.origin, owner + " never touches: both are of the robot, and 'self' is false");
  }
}

double distance_of(const ContactSpec& spec, double diagonal) {
  const double distance = spec.distance_mm.value_or(default_distance * diagonal);
  if (!(distance < max_distance * diagonal))
    throw InvalidInput(spec.origin, "contact distance " + number(distance) +
                                        " mm is too large: it must be below a twentieth of the robot's diagonal, " +
                                        number(max_distance * diagonal) + " mm");
  return distance;
}

/// Returns the smallest modulus at rest of the materials of the body [MPa]; for sheets, their stiffness in the plane
/// divided by the robot's diagonal.
double softest(const Compilation& c) {
  const Model& model = c.model;
  double least = std::numeric_limits<double>::infinity();
  for (const auto* roles : {&model.elements.tetrahedron_roles, &model.elements.prism_roles})
    for (const ElementRole& role : *roles)
      least = std::min(least, stiffness_at_rest(model.elements.materials[role.material].elastic).youngs_modulus_MPa);
  if (c.sheets.empty()) return least;
  for (const auto& layer : c.spec.layers)
    least = std::min(least, std::min(layer->e1, layer->e2) * layer->thickness_mm / model.diagonal_mm);
  return least;
}

/// Of a region of the robot that a pair names: which faces are its.
class FaceRegion {
 public:
  FaceRegion(const Compilation& c, const Region& region) : c_(c), region_(region), held_(c.mesh.vertices.rows()) {
    for (const Index v : region.vertices) held_[v] = true;
  }

  /// owner  its element; -1: none
  [[nodiscard]] bool has(const Triangle& face, Index owner) const {
    if (owner < 0) return all_held(face);
    const Index tetrahedra = c_.tetrahedron_of.size();
    const bool inside = owner < tetrahedra ? is_in(region_.tetrahedra, c_.tetrahedron_of[owner])
                                           : is_in(region_.prisms, c_.prism_of[owner - tetrahedra]);
    return inside || all_held(face);
  }

 private:
  [[nodiscard]] bool all_held(const Triangle& face) const {
    return std::all_of(face.begin(), face.end(), [this](Index v) { return held_[v]; });
  }
  static bool is_in(const std::vector<Index>& ascending, Index i) {
    return std::binary_search(ascending.begin(), ascending.end(), i);
  }

  const Compilation& c_;
  const Region& region_;
  std::vector<bool> held_;
};

/// Faces of layers beside the body, once each.
void add_sheets(Compilation& c, std::vector<Index>& owners) {
  ContactModel& contact = c.model.contact;
  contact.sheets[0] = contact.triangles.size();
  std::set<Triangle> known;
  for (const Triangle& t : c.sheets) {
    Triangle key = t;
    std::sort(key.begin(), key.end());
    if (!known.insert(key).second) continue;
    const std::vector<Triangle> flat = flat_triangles(face_of(c, t));
    contact.triangles.insert(contact.triangles.end(), flat.begin(), flat.end());
  }
  contact.sheets[1] = contact.triangles.size();
  owners.resize(contact.triangles.size(), -1);
}

/// The robots, then the regions that pairs name, as they come.
void add_robot_parts(Compilation& c, const ContactSpec& contact) {
  ContactModel& model = c.model.contact;
  std::vector<FaceRegion> regions;
  for (const RobotPart& robot : c.spec.robots)
    model.parts.push_back(
        {robot.name, ContactRank::robot, static_cast<Index>(model.parts.size()), false, contact.origin});
  if (model.parts.empty()) model.parts.push_back({.name = robot_name, .robot = 0, .origin = contact.origin});
  const std::size_t robots = model.parts.size();
  for (const ContactPairSpec& spec : contact.pairs)
    for (const std::string& name : {spec.a, spec.b}) {
      if (name == robot_name || is_beside(contact, name) ||
          std::any_of(model.parts.begin(), model.parts.end(), [&](const auto& part) { return part.name == name; }))
        continue;
      model.parts.push_back({.name = name, .robot = robot_of_region(c, name, spec.origin), .origin = spec.origin});
      regions.emplace_back(c, c.regions.find(name, spec.origin));
    }
  std::vector<Index> owners;
  model.triangles =
      boundary_triangles(c.model.elements.tetrahedra, c.model.elements.edge_nodes, c.model.elements.prisms, &owners);
  add_sheets(c, owners);
  std::vector<bool> any(model.parts.size());
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    std::size_t part = robots;
    while (part < model.parts.size() && !regions[part - robots].has(model.triangles[t], owners[t])) ++part;
    if (part == model.parts.size()) part = robot_of(c.spec, &RobotPart::vertices, model.triangles[t][0]);
    model.part_of.push_back(part);
    any[part] = true;
  }
  for (std::size_t part = robots; part < any.size(); ++part)
    if (!any[part])
      throw InvalidInput(model.parts[part].origin, "region '" + model.parts[part].name +
                                                       "' has no face of the robot's surface" +
                                                       " that is in no region which a pair names before it");
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

/// Computes the area for which each vertex of the robot carries a uniform pressure on the triangles; returns the mean.
double spread_area(Model& model) {
  ContactModel& contact = model.contact;
  contact.area.assign(model.rest.rows(), 0);
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
  for (const Index v : vertices) contact.area[v] = std::max(contact.area[v], min_area * mean);
  return mean;
}

bool by_rank(const ContactPart* a, const ContactPart* b) {
  return a->rank < b->rank;
}

void set_pairs(ContactModel& model, const ContactSpec& contact) {
  const std::size_t count = model.parts.size();
  std::map<std::string, std::optional<double>> own;
  for (const ObstacleSpec& spec : contact.obstacles) own[spec.name] = spec.friction;
  for (const BodySpec& spec : contact.bodies) own[spec.name] = spec.friction;
  std::map<std::string, std::vector<std::size_t>> at;
  for (std::size_t a = 0; a < count; ++a) {
    const bool whole = model.parts[a].robot == static_cast<Index>(a);
    at[model.parts[a].name].push_back(a);
    if (whole && model.parts[a].name != robot_name) at[robot_name].push_back(a);
    for (std::size_t b = 0; b < count; ++b) {
      const ContactPart &one = model.parts[a], &two = model.parts[b];
      ContactPair pair{true, contact.friction};
      if (one.rank == two.rank && one.rank == ContactRank::robot) pair.touch = contact.self || one.robot != two.robot;
      if (one.rank == two.rank && one.rank == ContactRank::obstacle) pair.touch = false;
      if (a == b && one.rank == ContactRank::body) pair.touch = false;
      // a body's own goes before an obstacle's
      for (const ContactPart* part : {std::max(&one, &two, by_rank), std::min(&one, &two, by_rank)})
        if (part->rank != ContactRank::robot) pair.friction = own[part->name].value_or(pair.friction);
      model.pairs.push_back(pair);
    }
  }
  for (const ContactPairSpec& spec : contact.pairs) {
    for (const std::size_t a : at.at(spec.a))
      for (const std::size_t b : at.at(spec.b))
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
  check_surroundings(c, contact);
  check_pairs(c, contact);
}

void compile_contact(Compilation& c) {
  if (!c.spec.contact) return;
  const ContactSpec& spec = *c.spec.contact;
  ContactModel& contact = c.model.contact;
  contact.distance_mm = distance_of(spec, c.model.diagonal_mm);
  contact.modulus_MPa = softest(c);
  add_robot_parts(c, spec);
  if (!c.regions.edges().empty()) contact.edges = edges_of_faces(contact.triangles);
  const double mean = spread_area(c.model);
  add_surroundings(c, spec, min_area * mean);
  set_pairs(contact, spec);
}

}  // namespace softkin
