#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <softkin/model/compile/regions.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

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
  bool operator()(const InsideSurface& inside) const {
    return inside.surface->contains(point) || inside.surface->distance(point) <= tolerance;
  }
  bool operator()(const VertexList&) const { return false; }
  bool operator()(const ElementList&) const { return false; }
  bool operator()(const Chosen&) const { return false; }
};

// The complaint about a shape, or nothing.
struct Complaint {
  template <class Shape>
  const char* operator()(const Shape& shape) const {
    return complaint_about(shape);
  }
  const char* operator()(const InsideSurface&) const { return nullptr; }
  const char* operator()(const VertexList&) const { return nullptr; }
  const char* operator()(const ElementList&) const { return nullptr; }
  const char* operator()(const Chosen&) const { return nullptr; }
};

/// "box", "sphere", ...
std::string kind_of(const Selector& selector) {
  if (const auto* chosen = std::get_if<Chosen>(&selector)) return chosen->kind;
  static const std::array<const char*, std::variant_size_v<Selector> - 1> kinds{
      "box", "sphere", "cylinder", "halfspace", "inside of a surface", "list of vertices", "list of elements"};
  return kinds[selector.index()];
}

/// Refuses a shape without extent or with numbers that are not finite.
void check_shape(const Selector& selector, const Origin& origin) {
  if (const char* complaint = std::visit(Complaint{}, selector))
    throw InvalidInput(origin, "the " + kind_of(selector) + " " + complaint);
}

/// Whether a shape holds the point, or its boundary is within tolerance of it [mm]. Lists hold no point.
bool holds(const Selector& selector, const Vec3& point, double tolerance) {
  return std::visit(HoldsPoint{point, tolerance}, selector);
}

template <class Cell>
void add_vertices(const std::vector<Cell>& cells, const std::vector<Index>& which, std::vector<Index>& vertices) {
  for (const Index i : which) vertices.insert(vertices.end(), cells[i].begin(), cells[i].end());
}

void add_element_vertices(const Mesh& mesh, Region& region) {
  add_vertices(mesh.tetrahedra, region.tetrahedra, region.vertices);
  if (!mesh.edge_nodes.empty()) add_vertices(mesh.edge_nodes, region.tetrahedra, region.vertices);
  add_vertices(mesh.prisms, region.prisms, region.vertices);
}

void check_indices(const std::vector<Index>& indices, std::size_t count, const std::string& owner,
                   const std::string& what, const Origin& origin) {
  for (const Index i : indices)
    if (i < 0 || static_cast<std::size_t>(i) >= count)
      throw InvalidInput(origin, owner + " names " + what + " " + std::to_string(i) + ", but the mesh has " +
                                     std::to_string(count) + " (counted from 0)");
}

void check_region_indices(const Region& region, const Mesh& mesh, const std::string& owner, const Origin& origin) {
  check_indices(region.tetrahedra, mesh.tetrahedra.size(), owner, "tetrahedron", origin);
  check_indices(region.prisms, mesh.prisms.size(), owner, "prism", origin);
  check_indices(region.triangles, mesh.triangles.size(), owner, "triangle", origin);
  check_indices(region.quads, mesh.quads.size(), owner, "quad", origin);
  check_indices(region.vertices, mesh.vertices.rows(), owner, "vertex", origin);
}

Region complete(Region region, const Mesh& mesh, const EdgeTable& edges, const Origin& origin) {
  check_region_indices(region, mesh, "region '" + region.name + "' of the mesh", origin);
  add_element_vertices(mesh, region);
  add_vertices(mesh.triangles, region.triangles, region.vertices);
  add_vertices(mesh.quads, region.quads, region.vertices);
  if (!edges.empty())
    for (const Index i : region.triangles)
      for (const Index node : edges.of(mesh.triangles[i]))
        if (node >= 0) region.vertices.push_back(node);
  for (auto* list : {&region.tetrahedra, &region.prisms, &region.triangles, &region.quads, &region.vertices})
    sort_unique(*list);
  return region;
}

template <class Cell, class Accept>
std::vector<Index> cells_where(const std::vector<Cell>& cells, const Accept& accept) {
  std::vector<Index> found;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (accept(cells[i])) found.push_back(i);
  return found;
}

template <class Cell>
Vec3 centroid(const Points& vertices, const Cell& cell) {
  Vec3 sum = Vec3::Zero();
  for (const Index i : cell) sum += vertex_at(vertices, i);
  return sum / static_cast<double>(cell.size());
}

Region every_element(const Mesh& mesh) {
  Region all;
  all.name = "all";
  all.tetrahedra.resize(mesh.tetrahedra.size());
  all.prisms.resize(mesh.prisms.size());
  std::iota(all.tetrahedra.begin(), all.tetrahedra.end(), 0);
  std::iota(all.prisms.begin(), all.prisms.end(), 0);
  if (mesh.tetrahedra.empty() && mesh.prisms.empty()) {
    all.dimension = 2;
    all.triangles.resize(mesh.triangles.size());
    std::iota(all.triangles.begin(), all.triangles.end(), 0);
  }
  return all;
}

}  // namespace

void check_cells(const Mesh& mesh, const Origin& origin) {
  const auto check = [&](const auto& cells, const std::string& what) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (const Index v : cells[i])
        if (v < 0 || v >= mesh.vertices.rows())
          throw InvalidInput(origin, what + " " + std::to_string(i) + " names vertex " + std::to_string(v) +
                                         ", but the mesh has " + std::to_string(mesh.vertices.rows()) +
                                         " (counted from 0)");
  };
  check(mesh.tetrahedra, "tetrahedron");
  check(mesh.prisms, "prism");
  check(mesh.triangles, "triangle");
  check(mesh.quads, "quad");
  check(mesh.sheet_edges, "the edge of a triangle, edge");
  if (!mesh.edge_nodes.empty()) {
    if (mesh.edge_nodes.size() != mesh.tetrahedra.size() || !mesh.prisms.empty())
      throw InvalidInput(origin, "a mesh of order 2 needs edge nodes for every element, and prisms have none");
    check(mesh.edge_nodes, "the edges of tetrahedron");
  }
  for (Index i = 0; i < mesh.vertices.rows(); ++i)
    if (!mesh.vertices.row(i).allFinite())
      throw InvalidInput(origin, "vertex " + std::to_string(i) + " (from 0) is not finite");
}

namespace {

EdgeTable checked_edges(const Mesh& mesh, const Origin& origin) {
  check_cells(mesh, origin);
  try {
    return EdgeTable(mesh);
  } catch (const InvalidInput& error) {
    throw InvalidInput(origin, error.what());
  }
}

}  // namespace

RegionTable::RegionTable(const RobotSpec& spec, const Mesh& mesh)
    : mesh_(mesh), edges_(checked_edges(mesh, {.file = spec.name})) {
  const Origin origin{.file = spec.name};
  if (mesh_.vertices.rows() > 0)
    tolerance_ = 1e-9 * (mesh_.vertices.colwise().maxCoeff() - mesh_.vertices.colwise().minCoeff()).norm();
  all_ = complete(every_element(mesh_), mesh_, edges_, origin);
  if (order_of(mesh_) == 1)
    for (const EdgeWithNode& edge : edges_with_nodes(spec.mesh)) lost_.push_back(edge[2]);
  sort_unique(lost_);
  std::set<std::string> names{"all"};
  for (const Region& region : mesh_.regions) {
    regions_.push_back(complete(region, mesh_, edges_, origin));
    const Region& added = regions_.back();
    if (region.name == "all" && (added.tetrahedra != all_.tetrahedra || added.prisms != all_.prisms))
      throw InvalidInput(origin, "the mesh has a region 'all' that is not every element: rename it");
    names.insert(region.name);
  }
  for (const RegionSpec& region : spec.regions) {
    if (!names.insert(region.name).second)
      throw InvalidInput(region.origin, "there is already a region '" + region.name + "'");
    regions_.push_back(select(region.selector, region.name, region.origin));
  }
}

const Region& RegionTable::find(const std::string& name, const Origin& origin) const {
  if (name == all_.name) return all_;
  const Region* found = nullptr;
  for (const Region& region : regions_) {
    if (region.name != name) continue;
    if (found) throw InvalidInput(origin, "the mesh has two regions '" + name + "': rename one");
    found = &region;
  }
  if (found && found->vertices.empty() && found->tetrahedra.empty() && found->prisms.empty())
    throw InvalidInput(origin, "region '" + name + "' is empty");
  if (found) return *found;
  std::vector<std::string> names{all_.name};
  for (const Region& region : regions_) names.push_back(region.name);
  std::string missing;
  for (const std::string& each : mesh_.missing) missing += "; " + each;
  throw InvalidInput(origin, "there is no region '" + name + "'" + suggest_name(name, names) + missing);
}

Region RegionTable::resolve(const RegionRef& reference) const {
  if (const auto* name = std::get_if<std::string>(&reference.region)) return find(*name, reference.origin);
  return select(std::get<Selector>(reference.region), "", reference.origin);
}

Region RegionTable::select(const Selector& selector, const std::string& name, const Origin& origin) const {
  check_shape(selector, origin);
  const std::string owner = name.empty() ? "the " + kind_of(selector) : "region '" + name + "'";
  Region region;
  region.name = name;
  if (const auto* vertices = std::get_if<VertexList>(&selector)) {
    region.vertices = vertices->vertices;
    check_indices(region.vertices, mesh_.vertices.rows(), owner, "vertex", origin);
    sort_unique(region.vertices);
    std::vector<bool> listed(mesh_.vertices.rows());
    for (const Index v : region.vertices) listed[v] = true;
    const auto accept = [&](const auto& cell) {
      return std::all_of(cell.begin(), cell.end(), [&](Index v) { return listed[v]; });
    };
    region.tetrahedra = cells_where(mesh_.tetrahedra, accept);
    region.prisms = cells_where(mesh_.prisms, accept);
    region.dimension = 0;
    const std::vector<Index> nodes = edges_.between(region.vertices);
    region.vertices.insert(region.vertices.end(), nodes.begin(), nodes.end());
    sort_unique(region.vertices);
  } else if (const auto* elements = std::get_if<ElementList>(&selector)) {
    region.tetrahedra = elements->tetrahedra;
    check_indices(region.tetrahedra, mesh_.tetrahedra.size(), owner, "tetrahedron", origin);
    sort_unique(region.tetrahedra);
    add_element_vertices(mesh_, region);
    sort_unique(region.vertices);
  } else if (const auto* chosen = std::get_if<Chosen>(&selector)) {
    region = chosen->region;
    region.name = name;
    check_region_indices(region, mesh_, owner, origin);
    std::erase_if(region.vertices, [&](Index v) { return std::binary_search(lost_.begin(), lost_.end(), v); });
  } else {
    const auto accept = [&](const auto& cell) { return holds(selector, centroid(mesh_.vertices, cell), tolerance_); };
    for (Index i = 0; i < mesh_.vertices.rows(); ++i)
      if (holds(selector, vertex_at(mesh_.vertices, i), tolerance_)) region.vertices.push_back(i);
    region.tetrahedra = cells_where(mesh_.tetrahedra, accept);
    region.prisms = cells_where(mesh_.prisms, accept);
    region.dimension = region.tetrahedra.empty() && region.prisms.empty() ? 0 : 3;
  }
  if (region.vertices.empty() && region.tetrahedra.empty() && region.prisms.empty())
    throw InvalidInput(origin, owner + " holds no vertex and no element");
  return region;
}

std::string label(const RegionRef& reference) {
  if (const auto* name = std::get_if<std::string>(&reference.region)) return "region '" + *name + "'";
  return "the " + kind_of(std::get<Selector>(reference.region));
}

bool span_plane(const Points& points, const std::vector<Index>& vertices) {
  if (vertices.size() < 3) return false;
  const Vec3 first = vertex_at(points, vertices[0]);
  const auto farthest = [&](const auto& distance) {
    double most = 0;
    Vec3 at = first;
    for (const Index i : vertices) {
      const Vec3 p = vertex_at(points, i);
      if (distance(p) <= most) continue;
      most = distance(p);
      at = p;
    }
    return std::pair(most, at);
  };
  const auto [length, second] = farthest([&](const Vec3& p) { return (p - first).norm(); });
  if (length == 0) return false;
  const Vec3 axis = (second - first) / length;
  return farthest([&](const Vec3& p) { return (p - first).cross(axis).norm(); }).first > 1e-6 * length;
}

}  // namespace softkin
