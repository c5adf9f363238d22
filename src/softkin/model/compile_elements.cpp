#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/model/compile_parts.hpp>
#include <softkin/model/triangle_geometry.hpp>

namespace softkin {

namespace {

// Flatter than this (volume over the cube of the longest edge) an element counts as one without volume.
constexpr double flat = 1e-9;

void reverse(Tetrahedron& t) {
  std::swap(t[2], t[3]);
}

void reverse(Prism& p) {
  for (int i = 0; i < 3; ++i) std::swap(p[i], p[i + 3]);
}

template <class Element>
double longest_edge(const Points& vertices, const Element& element) {
  double longest2 = 0;
  for (std::size_t i = 0; i < element.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      longest2 = std::max(longest2, (vertices.row(element[i]) - vertices.row(element[j])).squaredNorm());
  return std::sqrt(longest2);
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

template <class Element>
void refuse(const Compilation& c, const Kind<Element>& kind, const Refused& refused, const std::string& what) {
  if (refused.count == 0) return;
  throw InvalidInput(c.origin, count_text(refused.count, kind.one, kind.many) + " " + what + "; the first is " +
                                   kind.one + " " + std::to_string(refused.first) + " (from 0)");
}

/// Fills in the elements of a kind and returns how many it reversed.
template <class Element>
std::size_t orient(Compilation& c, const std::vector<bool>& is_void, const Kind<Element>& kind, double least_volume) {
  std::size_t reversed = 0;
  Refused empty, folded;
  kind.at.assign(kind.mesh_elements.size(), -1);
  for (std::size_t i = 0; i < kind.mesh_elements.size(); ++i) {
    if (is_void[i]) continue;
    Element element = kind.mesh_elements[i];
    double volume = signed_volume(c.spec.mesh.vertices, element);
    const double edge = longest_edge(c.spec.mesh.vertices, element);
    if (!(std::abs(volume) > std::max(least_volume, flat * edge * edge * edge))) {
      empty.add(static_cast<Index>(i));
      continue;
    }
    if (volume < 0) {
      reverse(element);
      volume = -volume;
      ++reversed;
    }
    if (folds_over(c.spec.mesh.vertices, element)) folded.add(static_cast<Index>(i));
    kind.at[i] = static_cast<Index>(kind.elements.size());
    kind.of.push_back(static_cast<Index>(i));
    kind.elements.push_back(element);
    kind.volumes.push_back(volume);
  }
  refuse(c, kind, empty, empty.count == 1 ? "has no volume" : "have no volume");
  refuse(c, kind, folded, folded.count == 1 ? "folds over at a corner" : "fold over at a corner");
  return reversed;
}

void find_used_vertices(Compilation& c) {
  Model& model = c.model;
  model.used.assign(static_cast<std::size_t>(model.rest.rows()), false);
  for (const Tetrahedron& t : model.tetrahedra)
    for (const Index v : t) model.used[v] = true;
  for (const Prism& p : model.prisms)
    for (const Index v : p) model.used[v] = true;
  Bounds bounds;
  model.fixed.assign(model.used.size(), {false, false, false});
  std::size_t unused = 0;
  for (std::size_t v = 0; v < model.used.size(); ++v) {
    if (model.used[v]) {
      bounds.extend(vertex_at(model.rest, static_cast<Index>(v)));
      continue;
    }
    model.fixed[v] = {true, true, true};
    ++unused;
  }
  model.diagonal_mm = bounds.diagonal().norm();
  if (unused > 0)
    model.notes.push_back(count_text(unused, "vertex belongs", "vertices belong") + " to no element and stay" +
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
    const auto index = static_cast<Index>(model.region_names.size());
    model.region_names.push_back(region.name);
    name(region.tetrahedra, c.tetrahedron_at, index, model.tetrahedron_roles);
    name(region.prisms, c.prism_at, index, model.prism_roles);
  }
}

}  // namespace

void compile_elements(Compilation& c) {
  Model& model = c.model;
  const Mesh& mesh = c.spec.mesh;
  if (mesh.tetrahedra.empty() && mesh.prisms.empty()) throw InvalidInput(c.origin, "the mesh has no element");
  const std::vector<bool> void_tetrahedra = void_elements(c, &Region::tetrahedra, mesh.tetrahedra.size());
  const std::vector<bool> void_prisms = void_elements(c, &Region::prisms, mesh.prisms.size());
  model.rest = mesh.vertices;
  model.held = mesh.vertices;
  // below this a volume is the rounding of the coordinates
  const double diagonal = (model.rest.colwise().maxCoeff() - model.rest.colwise().minCoeff()).norm();
  const double least_volume = 1e-15 * diagonal * diagonal * diagonal;
  const std::size_t reversed =
      orient(c, void_tetrahedra,
             Kind<Tetrahedron>{"tetrahedron", "tetrahedra", mesh.tetrahedra, model.tetrahedra,
                               model.tetrahedron_volumes, c.tetrahedron_at, c.tetrahedron_of},
             least_volume) +
      orient(c, void_prisms,
             Kind<Prism>{"prism", "prisms", mesh.prisms, model.prisms, model.prism_volumes, c.prism_at, c.prism_of},
             least_volume);
  if (model.tetrahedra.empty() && model.prisms.empty())
    throw InvalidInput(c.origin, "every element of the mesh is void");
  if (reversed > 0)
    model.notes.push_back(count_text(reversed, "element was", "elements were") +
                          " reordered, because the order of the vertices made the volume negative.");
  model.tetrahedron_roles.resize(model.tetrahedra.size());
  model.prism_roles.resize(model.prisms.size());
  find_used_vertices(c);
  name_regions(c);
}

namespace {

Material checked_material(const MaterialSpec& spec) {
  const std::string owner = "the material of region '" + spec.region + "'";
  if (!spec.shape_ratio) throw InvalidInput(spec.origin, owner + " needs shape_ratio, R_omega of the target shapes");
  if (!(*spec.shape_ratio >= 0 && *spec.shape_ratio <= 1))
    throw InvalidInput(spec.origin,
                       owner + ": shape_ratio must lie in [0, 1], not be " + number_text(*spec.shape_ratio));
  if (!(spec.weight > 0 && std::isfinite(spec.weight)))
    throw InvalidInput(spec.origin, owner + ": weight must be above 0, not " + number_text(spec.weight));
  if (spec.linear_range && !(*spec.linear_range > 0 && std::isfinite(*spec.linear_range)))
    throw InvalidInput(spec.origin, owner + ": linear_range must be above 0, not " + number_text(*spec.linear_range));
  Material material;
  material.region = spec.region;
  material.shape_ratio = *spec.shape_ratio;
  material.weight = spec.weight;
  material.linear_range = spec.linear_range;
  return material;
}

std::size_t assign(const std::vector<Index>& elements, const std::vector<Index>& at, Index material,
                   std::vector<ElementRole>& roles) {
  std::size_t count = 0;
  for (const Index i : elements) {
    if (at[i] < 0 || roles[at[i]].actuator >= 0) continue;
    roles[at[i]].material = material;
    ++count;
  }
  return count;
}

void refuse_bare_elements(const Compilation& c) {
  const Model& model = c.model;
  std::map<Index, std::size_t> bare;  // by region
  for (const auto* roles : {&model.tetrahedron_roles, &model.prism_roles})
    for (const ElementRole& role : *roles)
      if (role.material < 0 && role.actuator < 0) ++bare[role.region];
  if (bare.empty()) return;
  std::string text;
  for (const auto& [region, count] : bare) {
    const std::string where = region < 0 ? "of no region" : "of region '" + model.region_names[region] + "'";
    text += (text.empty() ? "" : " and ") + count_text(count, "element") + " " + where;
  }
  const bool single = bare.size() == 1 && bare.begin()->second == 1;
  throw InvalidInput(c.origin, text + (single ? " has" : " have") + " no material: give one, or make the region void");
}

}  // namespace

void compile_materials(Compilation& c) {
  Model& model = c.model;
  for (const MaterialSpec& spec : c.spec.materials) {
    const auto index = static_cast<Index>(model.materials.size());
    model.materials.push_back(checked_material(spec));
    const Region& region = c.regions.find(spec.region, spec.origin);
    if (assign(region.tetrahedra, c.tetrahedron_at, index, model.tetrahedron_roles) +
            assign(region.prisms, c.prism_at, index, model.prism_roles) ==
        0)
      throw InvalidInput(spec.origin, "region '" + spec.region +
                                          "' has a material but no element of the body: its elements are void, belong "
                                          "to actuators, or it is not a volume");
  }
  refuse_bare_elements(c);
  for (std::size_t i = 0; i < model.tetrahedra.size(); ++i)
    if (model.tetrahedron_roles[i].actuator < 0) c.solid_tetrahedra.push_back(model.tetrahedra[i]);
  c.solid_prisms = model.prisms;
  c.embedder.emplace(model.rest, c.solid_tetrahedra, c.solid_prisms);
}

}  // namespace softkin
