#include <algorithm>
#include <cmath>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/mesh/mesh_review.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

namespace {

// Flatter than this (volume over the cube of the longest edge) an element counts as one without volume.
constexpr double flat_volume = 1e-9;

void reverse(Tetrahedron& t) {
  std::swap(t[2], t[3]);
}

void reverse(Prism& p) {
  for (int i = 0; i < 3; ++i) std::swap(p[i], p[i + 3]);
}

bool folds_over(const Points&, const Tetrahedron&) {
  return false;
}

bool folds_over(const Points& vertices, const Prism& p) {
  for (int i = 0; i < 6; ++i) {
    const int base = i < 3 ? 0 : 3, j = base + (i + 1) % 3, k = base + (i + 2) % 3, across = (i + 3) % 6;
    const Vec3 corner = vertex_at(vertices, p[i]);
    const Vec3 up = i < 3 ? vertex_at(vertices, p[across]) - corner : corner - vertex_at(vertices, p[across]);
    if (!((vertex_at(vertices, p[j]) - corner).cross(vertex_at(vertices, p[k]) - corner).dot(up) > 0)) return true;
  }
  return false;
}

std::vector<bool> void_elements(const Compilation& c, std::vector<Index> Region::*list, std::size_t count) {
  std::vector<bool> inside(count);
  for (const RegionRef& reference : c.spec.voids) {
    const Region region = c.regions.resolve(reference);
    if (region.tetrahedra.empty() && region.prisms.empty())
      throw InvalidInput(reference.origin, label(reference) + " cannot be void: it holds no element");
    for (const Index i : region.*list) inside[i] = true;
  }
  return inside;
}

/// Physical: tetrahedra of pneumatic chambers, which are no elements of the model.
std::vector<bool> chamber_elements(const Compilation& c) {
  std::vector<bool> inside(c.mesh.tetrahedra.size());
  if (c.spec.formulation != Formulation::physical) return inside;
  for (const ActuatorSpec& spec : c.spec.actuators) {
    const auto* chamber = spec.as<PneumaticSpec>();
    if (chamber == nullptr) continue;
    std::vector<std::string> regions = chamber->connected;
    if (chamber->region) regions.push_back(*chamber->region);
    for (const std::string& name : regions) {
      const Region& region = c.regions.find(name, spec.origin);
      if (region.dimension != 2)
        for (const Index i : region.tetrahedra) inside[i] = true;
    }
  }
  return inside;
}

template <class Element>
struct Kind {
  const char *one, *many;
  const std::vector<Element>& mesh_elements;
  std::vector<Element>& elements;
  std::vector<double>& volumes;
  std::vector<Index>&at, &of;
};

// First element of a kind that is refused, and how many are.
struct Refused {
  std::size_t count = 0;
  Index first = 0;

  void add(Index i) {
    if (count++ == 0) first = i;
  }
};

void refuse(const Compilation& c, const std::string& one, const std::string& many, const Refused& refused,
            const std::string& what) {
  const auto first = one == "prism" ? &RobotPart::prisms : &RobotPart::tetrahedra;
  if (refused.count == 0) return;
  throw InvalidInput(c.origin, counted(refused.count, one, many) + " " + what + "; the first is " + one + " " +
                                   std::to_string(refused.first) + " (from 0" +
                                   robot_text(c.spec, first, refused.first) + ")");
}

/// Fills in the elements of a kind and returns how many it reversed.
template <class Element>
std::size_t orient(Compilation& c, const std::vector<bool>& left_out, const Kind<Element>& kind, double min_volume) {
  std::size_t reversed = 0;
  Refused empty, folded;
  kind.at.assign(kind.mesh_elements.size(), -1);
  for (std::size_t i = 0; i < kind.mesh_elements.size(); ++i) {
    if (left_out[i]) continue;
    Element element = kind.mesh_elements[i];
    double volume = signed_volume(c.mesh.vertices, element);
    const double edge = longest_edge(c.mesh.vertices, element);
    if (!(std::abs(volume) > std::max(min_volume, flat_volume * edge * edge * edge))) {
      empty.add(static_cast<Index>(i));
      continue;
    }
    if (volume < 0) {
      reverse(element);
      volume = -volume;
      ++reversed;
    }
    if (folds_over(c.mesh.vertices, element)) folded.add(static_cast<Index>(i));
    kind.at[i] = kind.elements.size();
    kind.of.push_back(i);
    kind.elements.push_back(element);
    kind.volumes.push_back(volume);
  }
  refuse(c, kind.one, kind.many, empty, empty.count == 1 ? "has no volume" : "have no volume");
  refuse(c, kind.one, kind.many, folded, folded.count == 1 ? "folds over at a corner" : "fold over at a corner");
  return reversed;
}

bool has_stray_node(const TetrahedronNodes& nodes) {
  for (int e = 0; e < 6; ++e) {
    const auto start = nodes.row(tetrahedron_edges[e][0]), end = nodes.row(tetrahedron_edges[e][1]);
    if (!((nodes.row(e + 4) - 0.5 * (start + end)).norm() <= 0.25 * (end - start).norm())) return true;
  }
  return false;
}

/// Order 2: gives elements that were oriented the edge nodes that they have in the mesh, checks them and measures the
/// elements with their curved edges.
void take_edge_nodes(const Compilation& c, const std::vector<Tetrahedron>& elements, const std::vector<Index>& of,
                     std::vector<EdgeNodes>& edge_nodes, std::vector<double>& volumes) {
  Refused stray, folded;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    EdgeNodes nodes = c.mesh.edge_nodes[of[e]];
    if (elements[e] != c.mesh.tetrahedra[of[e]]) exchange_corners_2_and_3(nodes);
    edge_nodes.push_back(nodes);
    const TetrahedronNodes positions = nodes_of(c.mesh.vertices, elements[e], nodes);
    volumes[e] = shape_integrals(positions).sum();
    if (has_stray_node(positions))
      stray.add(of[e]);
    else if (!(min_jacobian(positions) > 0))
      folded.add(of[e]);
  }
  refuse(c, "tetrahedron", "tetrahedra", stray,
         std::string(stray.count == 1 ? "has" : "have") +
             " an edge node more than a quarter of its edge's length from the middle");
  refuse(c, "tetrahedron", "tetrahedra", folded,
         std::string(folded.count == 1 ? "folds" : "fold") + " over: the edge nodes make the Jacobian negative");
}

void find_used_vertices(Compilation& c) {
  Model& model = c.model;
  model.elements.used = vertices_of_elements(model);
  use_sheets(c);
  Bounds bounds;
  model.held.fixed.assign(model.elements.used.size(), {false, false, false});
  std::vector<bool> of_chamber(model.elements.used.size());
  for (const Tetrahedron& t : c.chamber_tetrahedra)
    for (const Index v : t) of_chamber[v] = true;
  for (const EdgeNodes& nodes : c.chamber_edge_nodes)
    for (const Index v : nodes) of_chamber[v] = true;
  std::size_t unused = 0;
  for (std::size_t v = 0; v < model.elements.used.size(); ++v) {
    if (model.elements.used[v]) {
      bounds.extend(vertex_at(model.rest, v));
      continue;
    }
    model.held.fixed[v] = {true, true, true};
    if (!of_chamber[v]) ++unused;
  }
  model.diagonal_mm = bounds.diagonal().norm();
  if (unused > 0)
    model.notes.push_back(counted(unused, "vertex belongs", "vertices belong") + " to no element and stay" +
                          (unused == 1 ? "s" : "") + " where they are.");
}

void name_regions(Compilation& c) {
  Model& model = c.model;
  const auto name = [](const std::vector<Index>& elements, const std::vector<Index>& at, Index region,
                       std::vector<ElementRole>& roles) {
    for (const Index i : elements)
      if (at[i] >= 0 && roles[at[i]].region < 0) roles[at[i]].region = region;
  };
  for (const Region& region : c.regions.regions()) {
    if (region.dimension != 3) continue;
    const Index index = model.elements.region_names.size();
    model.elements.region_names.push_back(region.name);
    name(region.tetrahedra, c.tetrahedron_at, index, model.elements.tetrahedron_roles);
    name(region.prisms, c.prism_at, index, model.elements.prism_roles);
  }
}

/// Without volume a robot is of layers, on faces of its mesh.
void refuse_empty(const Compilation& c) {
  const Mesh& mesh = c.mesh;
  if (!mesh.tetrahedra.empty() || !mesh.prisms.empty()) return;
  const bool is_sheet = c.spec.formulation == Formulation::physical && !c.spec.layers.empty();
  if (!mesh.triangles.empty() && is_sheet) return;
  throw InvalidInput(c.origin, missing_volume(mesh));
}

}  // namespace

Index robot_of(const RobotSpec& spec, Index RobotPart::*first, Index number) {
  Index found = 0;
  for (std::size_t r = 1; r < spec.robots.size(); ++r)
    if (spec.robots[r].*first <= number) found = r;
  return found;
}

std::string robot_text(const RobotSpec& spec, Index RobotPart::*first, Index number) {
  if (spec.robots.empty()) return "";
  return ", of robot '" + spec.robots[robot_of(spec, first, number)].name + "'";
}

void compile_elements(Compilation& c) {
  Model& model = c.model;
  const Mesh& mesh = c.mesh;
  refuse_empty(c);
  std::vector<bool> not_body = void_elements(c, &Region::tetrahedra, mesh.tetrahedra.size());
  const std::vector<bool> of_chamber = chamber_elements(c);
  std::vector<bool> not_chamber = not_body;
  for (std::size_t i = 0; i < not_body.size(); ++i) {
    not_chamber[i] = not_chamber[i] || !of_chamber[i];
    not_body[i] = not_body[i] || of_chamber[i];
  }
  const std::vector<bool> void_prisms = void_elements(c, &Region::prisms, mesh.prisms.size());
  model.rest = mesh.vertices;
  model.held.at = mesh.vertices;
  // below this a volume is the rounding of the coordinates
  const double diagonal = (model.rest.colwise().maxCoeff() - model.rest.colwise().minCoeff()).norm();
  const double min_volume = 1e-15 * diagonal * diagonal * diagonal;
  const std::size_t reversed =
      orient(c, not_body,
             Kind<Tetrahedron>{"tetrahedron", "tetrahedra", mesh.tetrahedra, model.elements.tetrahedra,
                               model.elements.tetrahedron_volumes, c.tetrahedron_at, c.tetrahedron_of},
             min_volume) +
      orient(c, not_chamber,
             Kind<Tetrahedron>{"tetrahedron", "tetrahedra", mesh.tetrahedra, c.chamber_tetrahedra, c.chamber_volumes,
                               c.chamber_at, c.chamber_of},
             min_volume) +
      orient(c, void_prisms,
             Kind<Prism>{"prism", "prisms", mesh.prisms, model.elements.prisms, model.elements.prism_volumes,
                         c.prism_at, c.prism_of},
             min_volume);
  if (model.elements.tetrahedra.empty() && model.elements.prisms.empty() &&
      !(mesh.tetrahedra.empty() && mesh.prisms.empty()))
    throw InvalidInput(c.origin, std::string("every element of the mesh is void") +
                                     (c.chamber_tetrahedra.empty() ? "" : " or belongs to a chamber"));
  if (reversed > 0)
    model.notes.push_back(counted(reversed, "element was", "elements were") +
                          " reordered, because the order of the vertices made the volume negative.");
  if (!mesh.edge_nodes.empty()) {
    take_edge_nodes(c, model.elements.tetrahedra, c.tetrahedron_of, model.elements.edge_nodes,
                    model.elements.tetrahedron_volumes);
    take_edge_nodes(c, c.chamber_tetrahedra, c.chamber_of, c.chamber_edge_nodes, c.chamber_volumes);
  }
  model.elements.tetrahedron_roles.resize(model.elements.tetrahedra.size());
  model.elements.prism_roles.resize(model.elements.prisms.size());
  c.chamber_roles.resize(c.chamber_tetrahedra.size());
  find_used_vertices(c);
  name_regions(c);
}

}  // namespace softkin
