#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/model/compile/layers.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

namespace {

void add_faces(const Compilation& c, const ActuatorSpec& spec, const std::vector<Triangle>& triangles,
               ChamberDrive& chamber) {
  const EdgeTable& edges = c.regions.edges();
  for (const Triangle& corners : triangles) {
    const CavityFace face = face_of(c, corners);
    if (!edges.empty() && *std::min_element(face.edges.begin(), face.edges.end()) < 0)
      refuse(spec, "has a wall with a face that is none of an element of order 2: vertices " +
                       std::to_string(corners[0]) + ", " + std::to_string(corners[1]) + " and " +
                       std::to_string(corners[2]) + " (from 0)");
    chamber.cavity.push_back(face);
  }
}

// Parts of a cavity's boundary that do not belong to the body cannot move.
void check_contact(Compilation& c, const ActuatorSpec& spec, const ChamberDrive& chamber) {
  std::set<Index> vertices;
  for (const CavityFace& face : chamber.cavity)
    for (const Index v : nodes_of(face)) vertices.insert(v);
  const std::size_t loose =
      std::count_if(vertices.begin(), vertices.end(), [&](Index v) { return !c.model.elements.used[v]; });
  if (loose == vertices.size()) refuse(spec, "has a chamber that does not touch the body");
  if (loose > 0)
    c.model.notes.push_back(counted(loose, "vertex", "vertices") + " on the boundary of the chamber of actuator '" +
                            spec.name + "' " + (loose == 1 ? "belongs" : "belong") +
                            " to no element of the body and stay" + (loose == 1 ? "s" : "") + " in place.");
}

std::vector<Triangle> boundary_of_chamber(const Compilation& c, const std::vector<Index>& elements) {
  std::vector<Tetrahedron> tetrahedra;
  tetrahedra.reserve(elements.size());
  for (const Index i : elements) tetrahedra.push_back(c.chamber_tetrahedra[i]);
  return boundary_of(tetrahedra, {}).triangles;
}

/// Is a space bounded by elements of these vertices alone?
bool lies_in(const EmptySpace& space, const std::pair<Index, Index>& vertices) {
  return std::all_of(space.triangles.begin(), space.triangles.end(), [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](Index v) { return v >= vertices.first && v < vertices.second; });
  });
}

void take_only_space(Compilation& c, const ActuatorSpec& spec, Actuator& actuator) {
  constexpr std::size_t max_named = 5;
  const std::vector<EmptySpace>& all = empty_spaces(c);
  std::vector<EmptySpace> spaces;
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!lies_in(all[i], vertices_of(c, spec.robot))) continue;
    spaces.push_back(all[i]);
    numbers.push_back(i);
  }
  const std::string body = spec.robot.empty() ? "the body" : "the body of robot '" + spec.robot + "'";
  const std::string cure = ": name its elements (`region`), its wall (`surface: {region: WALL}`) or an STL (`surface`)";
  if (spaces.empty()) refuse(spec, "needs a region or a surface, since " + body + " encloses no empty space" + cure);
  if (spaces.size() > 1) {
    std::string text;
    for (std::size_t i = 0; i < std::min(spaces.size(), max_named); ++i)
      text += (i == 0 ? "" : ", ") + text_of(spaces[i]);
    if (spaces.size() > max_named) text += " and " + std::to_string(spaces.size() - max_named) + " more";
    refuse(spec, "needs a region or a surface, since " + body + " encloses " + std::to_string(spaces.size()) +
                     " empty spaces, " + text + cure);
  }
  take_empty_space(c, spec, numbers[0], actuator);
  c.model.notes.push_back("Actuator '" + spec.name + "' is the only empty space in " + body + ", " +
                          text_of(spaces[0]) + ".");
}

/// "No empty space of the body", or how far the nearest one is.
std::string spaces_text(const Compilation& c, const std::vector<EmptySpace>& spaces, const Vec3& point) {
  if (spaces.empty()) return "the body encloses no empty space";
  std::size_t nearest = 0;
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < spaces.size(); ++i)
    if (const double away = SurfaceTree(c.model.rest, spaces[i].triangles).distance(point); away < least) {
      least = away;
      nearest = i;
    }
  return "of " + counted(spaces.size(), "empty space") + " the nearest, " + text_of(spaces[nearest]) + ", begins " +
         number(least, 3) + " mm from there";
}

void take_space_at(Compilation& c, const ActuatorSpec& spec, const Vec3& point, Actuator& actuator) {
  const std::vector<EmptySpace>& spaces = empty_spaces(c);
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    if (!spaces[i].bounds.contains(point) || !SurfaceTree(c.model.rest, spaces[i].triangles).contains(point)) continue;
    take_empty_space(c, spec, i, actuator);
    c.model.notes.push_back("Actuator '" + spec.name + "' is the empty space of " + text_of(spaces[i]) + ".");
    return;
  }
  refuse(spec, "has a point `void_at`, " + point_text(point) + " mm, that lies in no empty space of the body: " +
                   spaces_text(c, spaces, point) + "; give a point inside the cavity");
}

std::array<Index, 3> sorted(Triangle corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// The faces of layers that are groups of faces of the mesh.
std::vector<Triangle> faces_of_layers(const Compilation& c) {
  std::vector<Triangle> faces;
  for (const auto& spec : c.spec.layers) {
    const auto* where = std::get_if<RegionRef>(&spec->where);
    if (where == nullptr) continue;
    const Region region = c.regions.resolve(*where);
    if (region.dimension != 2) continue;
    for (const Index i : region.triangles) faces.push_back(c.mesh.triangles[i]);
  }
  return faces;
}

}  // namespace

std::vector<Index> open_faces(const Compilation& c, const std::vector<CavityFace>& cavity) {
  const Model& model = c.model;
  std::vector<bool> marked(model.elements.used.size());
  for (const CavityFace& face : cavity)
    for (const Index v : face.corners) marked[v] = true;
  std::vector<Triangle> shared;
  const auto add = [&](Index a, Index b, Index c) {
    if (marked[a] && marked[b] && marked[c]) shared.push_back(sorted({a, b, c}));
  };
  for (const Tetrahedron& t : model.elements.tetrahedra) {
    if (marked[t[0]] + marked[t[1]] + marked[t[2]] + marked[t[3]] < 3) continue;
    for (const auto& [a, b, c] : tetrahedron_faces) add(t[a], t[b], t[c]);
  }
  for (const Prism& p : model.elements.prisms) {
    for (const auto& [a, b, c] : prism_triangles) add(p[a], p[b], p[c]);
    for (const auto& q : prism_quads)  // either diagonal may have split it
      for (int i = 0; i < 4; ++i) add(p[q[i]], p[q[(i + 1) % 4]], p[q[(i + 2) % 4]]);
  }
  for (const Triangle& t : faces_of_layers(c)) shared.push_back(sorted(t));
  sort_unique(shared);
  std::vector<Index> open;
  for (std::size_t f = 0; f < cavity.size(); ++f)
    if (!std::binary_search(shared.begin(), shared.end(), sorted(cavity[f].corners))) open.push_back(f);
  return open;
}

bool is_plate(const Model& model, const std::vector<Index>& vertices, bool at_rest) {
  const auto held = [&](Index v, int axis) {
    return model.held.fixed[v][axis] &&
           (!at_rest || (model.held.at(v, axis) == model.rest(v, axis) && turn_of(model, v) == nullptr));
  };
  const auto all_held = [&](int axis) {
    return std::all_of(vertices.begin(), vertices.end(), [&](Index v) { return held(v, axis); });
  };
  const auto normal_to = [&](int axis) {
    return std::all_of(vertices.begin(), vertices.end(), [&](Index v) {
      return std::abs(model.rest(v, axis) - model.rest(vertices[0], axis)) <= plane_tolerance * model.diagonal_mm;
    });
  };
  if (all_held(0) && all_held(1) && all_held(2)) return true;
  for (int axis = 0; axis < 3; ++axis)
    if (normal_to(axis) && all_held(axis)) return true;
  return false;
}

namespace {

void check_openings(const Compilation& c, const ActuatorSpec& spec, const ChamberDrive& chamber) {
  const Model& model = c.model;
  std::vector<CavityFace> open;
  for (const Index face : open_faces(c, chamber.cavity)) open.push_back(chamber.cavity[face]);
  const bool loose = std::any_of(open.begin(), open.end(), [&](const CavityFace& face) {
    return std::any_of(face.corners.begin(), face.corners.end(), [&](Index v) { return !model.elements.used[v]; });
  });
  std::vector<Triangle> triangles;
  for (const CavityFace& face : open) triangles.push_back(face.corners);
  std::vector<Shell> openings = shells_of(model.rest, triangles);
  std::erase_if(openings, [&](const Shell& opening) {
    return std::all_of(opening.triangles.begin(), opening.triangles.end(),
                       [&](Index t) { return is_plate(model, nodes_of(open[t]), loose); });
  });
  if (openings.empty()) return;
  std::string text;
  for (const Shell& opening : openings)
    text += (text.empty() ? "" : " and ") + counted(opening.triangles.size(), "face") + " around " +
            point_text(opening.center) + " mm";
  refuse(spec, "has a chamber that is open: " + text + (openings.size() == 1 ? " is" : " are") +
                   " not the body's. Close it with elements of the body, or hold the body's vertices there without "
                   "displacement (`fixed`): along x, y and z as a plate would, or, in a plane of symmetry, along its "
                   "normal");
}

/// A vertex of no element, after those of the mesh.
void add_fixed_vertex(Model& model, const Vec3& place) {
  for (Points* points : {&model.rest, &model.held.at}) {
    points->conservativeResize(points->rows() + 1, 3);
    points->bottomRows(1) = place.transpose();
  }
  model.held.fixed.push_back({true, true, true});
  model.elements.used.push_back(false);
}

/// An empty bag has no volume that others could be compared with.
void take_as_flat(const Compilation& c, const ActuatorSpec& spec, ChamberDrive& chamber, double& rest_measure) {
  constexpr double flat = 1e-9, mm3_of_a_mL = 1000;
  double area = 0;
  for (const CavityFace& face : chamber.cavity) area += triangle_area(c.model.rest, face.corners);
  if (std::abs(rest_measure) > flat * std::pow(area, 1.5)) return;
  if (spec.control == Control::ratio)
    refuse(spec,
           "is flat at rest, so that no volume is a ratio of the one there: command its pressure (control: "
           "pressure) or what is in it (control: gas or liquid)");
  chamber.flat = true;
  rest_measure = mm3_of_a_mL;
}

}  // namespace

const std::vector<EmptySpace>& empty_spaces(Compilation& c) {
  if (!c.empty_spaces) {
    std::vector<Tetrahedron> tetrahedra = c.model.elements.tetrahedra;
    tetrahedra.insert(tetrahedra.end(), c.chamber_tetrahedra.begin(), c.chamber_tetrahedra.end());
    c.empty_spaces = empty_spaces_in(c.model.rest, tetrahedra, c.model.elements.prisms);
    c.space_actuators.assign(c.empty_spaces->size(), -1);
  }
  return *c.empty_spaces;
}

void take_empty_space(Compilation& c, const ActuatorSpec& spec, std::size_t space, Actuator& actuator) {
  const EmptySpace& taken = empty_spaces(c)[space];
  Index& owner = c.space_actuators[space];
  const Index taker = c.model.actuators.size();
  if (owner == taker) refuse(spec, "has two shells around the same empty space, " + text_of(taken) + ": leave one out");
  if (owner >= 0)
    refuse(spec, "and actuator '" + c.model.actuators[owner].name + "' both take the empty space of " + text_of(taken));
  owner = taker;
  auto& chamber = std::get<ChamberDrive>(actuator.drive);
  add_faces(c, spec, taken.triangles, chamber);
  actuator.rest_measure = enclosed_volume(c.model.rest, chamber.cavity);
}

void compile_cavity(Compilation& c, const ActuatorSpec& spec, const PneumaticSpec& given,
                    const std::vector<Index>& elements, Actuator& actuator) {
  if (given.surface) return select_cavity(c, spec, *given.surface, actuator);
  if (given.void_at) return take_space_at(c, spec, *given.void_at, actuator);
  if (!given.region && !given.wall) return take_only_space(c, spec, actuator);
  auto& chamber = std::get<ChamberDrive>(actuator.drive);
  std::vector<CavityFace> closing;
  std::vector<Vec3> corners;
  if (given.region) {
    add_faces(c, spec, boundary_of_chamber(c, elements), chamber);
  } else {
    ChamberWall wall = checked_wall(c, spec, *given.wall);
    check_filling(c, spec, wall.closed);
    add_faces(c, spec, wall.triangles, chamber);
    closing = std::move(wall.closing);
    corners = std::move(wall.corners);
  }
  check_contact(c, spec, chamber);
  chamber.cavity.insert(chamber.cavity.end(), closing.begin(), closing.end());
  for (const Vec3& corner : corners) add_fixed_vertex(c.model, corner);
  actuator.rest_measure = enclosed_volume(c.model.rest, chamber.cavity);
  take_as_flat(c, spec, chamber, actuator.rest_measure);
}

void check_openings(const Compilation& c) {
  for (std::size_t i = 0; i < c.spec.actuators.size(); ++i) {
    const ActuatorSpec& spec = c.spec.actuators[i];
    const auto* given = spec.as<PneumaticSpec>();
    if (given == nullptr || !(given->region || given->wall || !given->connected.empty())) continue;
    const ChamberDrive& chamber = *c.model.actuators[i].as<ChamberDrive>();
    if (!chamber.cavity.empty()) check_openings(c, spec, chamber);
  }
}

}  // namespace softkin
