#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/parts.hpp>
#include <softkin/model/mesh/shells.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin::scene {

namespace {

/// Indices below count, ascending, without repetition.
std::vector<Index> read_indices(const Node& node, std::int64_t count, const std::string& what) {
  std::vector<Index> indices;
  for (const auto& item : list(node)) {
    const std::int64_t index = integer(*item);
    if (index < 0) fail(*item, item->name + " must not be negative: " + item->text);
    if (index >= count)
      fail(*item, item->name + " is " + item->text + ", but the mesh has " + std::to_string(count) + " " + what +
                      ", numbered from 0");
    indices.push_back(index);
  }
  if (indices.empty()) fail(node, node.name + " is an empty list");
  sort_unique(indices);
  return indices;
}

/// Does a sidecar refer to elements? Decided by its number of rows, or by the key 'of' where that is ambiguous.
bool is_of_elements(const Context& context, const Map& map, std::int64_t rows) {
  const std::string mesh = "the mesh has " + std::to_string(context.vertices) + " vertices and " +
                           std::to_string(context.tetrahedra) + " tetrahedra";
  const bool vertices = rows == context.vertices, elements = rows == context.tetrahedra;
  const Node* of = map.find("of");
  const bool requested = of && choice(*of, {"vertices", "elements"}) == 1;
  if (of ? !(requested ? elements : vertices) : !(vertices || elements))
    fail(map.node(), "the sidecar has " + std::to_string(rows) + " rows, but " + mesh);
  if (!of && vertices && elements)
    fail(map.node(), mesh + ": say 'of: vertices' or 'of: elements' in " + map.node().name);
  return of ? requested : elements;
}

Selector read_sidecar_column(const Context& context, const Node& node) {
  const Map map(node, {"file", "column", "of"});
  const Sidecar sidecar = load_file(context, map.at("file"), context.files.sidecar);
  const Node* column = map.find("column");
  const std::int64_t number = column ? integer(*column) : 1;
  const auto columns = static_cast<std::int64_t>(sidecar.columns.size());
  if (number < 1 || number > columns)
    fail(column ? *column : node, "column " + std::to_string(number) + " is requested, but the sidecar has " +
                                      std::to_string(columns) + ", numbered from 1");
  const std::vector<Index>& chosen = sidecar.columns[number - 1];
  if (is_of_elements(context, map, sidecar.rows)) return ElementList{chosen};
  return VertexList{chosen};
}

/// Reads a closed surface.
InsideSurface read_inside(const Context& context, const Node& node) {
  TriangleSurface surface = read_surface(context, node);
  try {
    surface.triangles = turned_outwards(surface.vertices, std::move(surface.triangles));
  } catch (const InvalidInput& error) {
    fail(node, node.name + " needs a closed surface: " + error.what());
  }
  return {std::make_shared<const SurfaceTree>(surface.vertices, surface.triangles)};
}

Selector read_selector(const Context& context, const std::string& key, const Node& node) {
  if (key == "box") return read_box(context, node);
  if (key == "sphere") return read_sphere(context, node);
  if (key == "cylinder") return read_cylinder(context, node);
  if (key == "halfspace") return read_halfspace(context, node);
  if (key == "inside") return read_inside(context, node);
  if (key == "vertices") return VertexList{read_indices(node, context.vertices, "vertices")};
  if (key == "elements") return ElementList{read_indices(node, context.tetrahedra, "tetrahedra")};
  return read_sidecar_column(context, node);
}

}  // namespace

double read_length(const Context& context, const Node& node) {
  const double value = number(node) * context.to_mm;
  if (!std::isfinite(value)) fail(node, node.name + " is too large: " + node.text);
  return value;
}

double read_positive_length(const Context& context, const Node& node) {
  const double length = read_length(context, node);
  if (length <= 0) fail(node, node.name + " must be greater than 0, not " + node.text);
  return length;
}

Box read_box(const Context& context, const Node& node) {
  const auto& corners = list_of(2, node);
  const Box box{read_position(context, *corners[0]), read_position(context, *corners[1])};
  for (int axis = 0; axis < 3; ++axis)
    if (box.low[axis] > box.high[axis])
      fail(node, node.name + " has its low corner above its high corner in " + "xyz"[axis]);
  return box;
}

Sphere read_sphere(const Context& context, const Node& node) {
  const Map map(node, {"center", "radius"});
  return Sphere{read_position(context, map.at("center")), read_positive_length(context, map.at("radius"))};
}

Cylinder read_cylinder(const Context& context, const Node& node) {
  const Map map(node, {"start", "end", "radius"});
  const Cylinder cylinder{read_position(context, map.at("start")), read_position(context, map.at("end")),
                          read_positive_length(context, map.at("radius"))};
  if (cylinder.start == cylinder.end) fail(node, node.name + " has its start at its end");
  return cylinder;
}

Halfspace read_halfspace(const Context& context, const Node& node) {
  const Map map(node, {"point", "normal"});
  const Node& direction = map.at("normal");
  const Vec3 normal = read_vector(direction);
  const double largest = normal.cwiseAbs().maxCoeff();
  if (largest == 0) fail(direction, direction.name + " must not be zero");
  return Halfspace{read_position(context, map.at("point")), (normal / largest).normalized()};
}

const std::string& Names::add(const Node& node) {
  const auto [found, fresh] = origins_.emplace(text(node), node.origin);
  if (!fresh) {
    const Origin& first = found->second;
    fail(node, "the name " + excerpt(node.text) + " is taken; it is given in " +
                   (first.line > 0 ? "line " + std::to_string(first.line) : first.file));
  }
  return node.text;
}

const std::string& Names::add_label(const Node& node) {
  const std::string& name = text(node);
  if (name.find_first_of(",=\"#") != std::string::npos || name.front() == ' ' || name.back() == ' ')
    fail(node, "the name " + excerpt(name) + " must not hold , = \" # or begin or end with a blank");
  return add(node);
}

Vec3 read_position(const Context& context, const Node& node) {
  const auto& items = list_of(3, node);
  return {read_length(context, *items[0]), read_length(context, *items[1]), read_length(context, *items[2])};
}

PointRef read_point(const Context& context, const Node& node) {
  if (node.kind == Node::Kind::map) return {text(Map(node, {"region"}).at("region")), node.origin};
  return {read_position(context, node), node.origin};
}

const Keys& place_keys() {
  static const Keys keys{"region", "box", "sphere", "cylinder", "halfspace", "vertices"};
  return keys;
}

RegionRef read_region_name(const Node& node) {
  return {text(node), node.origin};
}

RegionRef read_place(const Context& context, const Map& map) {
  const Node::Entry& found = map.one_of(place_keys());
  if (found.key == "region") return read_region_name(*found.value);
  return {read_selector(context, found.key, *found.value), found.origin};
}

std::vector<RegionSpec> read_regions(const Context& context, const Node& node) {
  const Keys shapes{"box", "sphere", "cylinder", "halfspace", "inside", "vertices", "elements", "sidecar"};
  Keys known = shapes;
  known.insert(known.begin(), "name");
  std::vector<RegionSpec> regions;
  Names names;
  for (const auto& item : list(node)) {
    const Map map(*item, known);
    const std::string& name = names.add(map.at("name"));
    if (name == "all") fail(map.at("name"), "the name 'all' is reserved: it stands for every element");
    const Node::Entry& shape = map.one_of(shapes);
    regions.push_back({name, read_selector(context, shape.key, *shape.value), item->origin});
  }
  return regions;
}

}  // namespace softkin::scene
