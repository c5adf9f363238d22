#include <softkin/core/error.hpp>
#include <softkin/io/scene/parts.hpp>
#include <softkin/model/mesh/mesh_joining.hpp>

namespace softkin::scene {

namespace {

std::int64_t read_order(const Node& node) {
  const std::int64_t order = integer(node);
  if (order != 1 && order != 2) fail(node, node.name + " must be 1 or 2, not " + node.text);
  return order;
}

/// One file of `mesh` or `meshes`, in mm, where its transform puts it.
struct MeshFile {
  Mesh mesh;
  bool quadratic = false, linear_by_choice = false;
  std::optional<CurveSpec> curve = std::nullopt;
};

void rotate(const Context& context, const Node& node, Points& vertices) {
  const RigidMotion motion = read_rotations(context, node);
  vertices = (vertices * motion.rotation.transpose()).rowwise() + motion.translation.transpose();
}

MeshFile read_file_of(const Context& context, const Map& map) {
  const Node& file = map.at("file");
  const Node* order = map.find("order");
  const int of_order = order ? read_order(*order) : 0;
  MeshFile read{load_file(context, file, context.files.mesh), of_order == 2, of_order == 1};
  Points& vertices = read.mesh.vertices;
  vertices *= context.to_mm;
  if (const Node* scale = map.find("scale")) vertices *= positive(*scale);
  move_and_rotate(context, map, vertices);
  if (!vertices.allFinite()) fail(file, "the mesh's coordinates are too large");
  if (order && !read.quadratic && !read.mesh.edge_nodes.empty())
    fail(*order, "'order' is 1, but the tetrahedra of the mesh are of order 2");
  if (const Node* curve = map.find("curve")) {
    read.curve = read_curve(context, *curve);
    if (read.curve && !read.quadratic && read.mesh.edge_nodes.empty())
      fail(*curve, "'curve' moves the nodes of edges, which elements of order 2 have: add 'order: 2'");
  }
  return read;
}

/// Where the first file is named; whether errors are accepted, of any.
void note_origin(const Map& map, RobotSpec& spec) {
  if (spec.mesh_options.origin.file.empty()) spec.mesh_options.origin = map.at("file").origin;
  if (const Node* accept = map.find("accept_errors"))
    spec.mesh_options.accept_errors = choice(*accept, {"false", "true"}) == 1 || spec.mesh_options.accept_errors;
}

void check_joinable(const Node& node, const MeshFile& first, const MeshFile& next) {
  if (first.quadratic != next.quadratic) fail(node, "'order' must be the same in every entry of 'meshes'");
  const auto smooth = [](const MeshFile& read) { return read.curve && read.curve->smooth; };
  if (smooth(first) != smooth(next) || (smooth(first) && first.curve->crease_degrees != next.curve->crease_degrees))
    fail(node, "'curve: true' or its 'crease' must be the same in every entry of 'meshes'");
  if (first.mesh.edge_nodes.empty() == next.mesh.edge_nodes.empty()) return;
  fail(node,
       "its elements are of order " + std::string(next.mesh.edge_nodes.empty() ? "1" : "2") +
           ", those of the meshes before it of the other: give files of one order, or of order 1 with 'order: 2'");
}

/// The surfaces of each are those of all.
void add_curve(std::optional<CurveSpec>& all, std::optional<CurveSpec>& next) {
  if (!all)
    all = std::move(next);
  else if (next)
    std::move(next->surfaces.begin(), next->surfaces.end(), std::back_inserter(all->surfaces));
}

}  // namespace

void move_and_rotate(const Context& context, const Map& map, Points& vertices) {
  if (const Node* move = map.find("move")) vertices.rowwise() += read_position(context, *move).transpose();
  if (const Node* turn = map.find("rotate")) rotate(context, *turn, vertices);
}

void read_mesh_of(const Context& context, const Map& scene, RobotSpec& spec) {
  const Node* several = scene.find("meshes");
  if (several == nullptr || scene.find("mesh") != nullptr) {
    if (several != nullptr) (void)scene.one_of({"mesh", "meshes"});
    const Map map(scene.at("mesh"), {"file", "order", "curve", "accept_errors"});
    MeshFile read = read_file_of(context, map);
    spec.mesh = std::move(read.mesh);
    spec.mesh_options.quadratic = read.quadratic;
    spec.mesh_options.curve = std::move(read.curve);
    spec.mesh_options.linear_by_choice = read.linear_by_choice;
    note_origin(map, spec);
    return;
  }
  if (list(*several).empty()) fail(*several, "'meshes' is empty");
  Names names;
  std::optional<MeshFile> all;
  for (const auto& item : list(*several)) {
    const Map map(*item, {"file", "order", "curve", "accept_errors", "name", "scale", "rotate", "move"});
    MeshFile read = read_file_of(context, map);
    note_origin(map, spec);
    if (const Node* name = map.find("name")) {
      const std::string before = names.add_label(*name) + ".";
      for (Region& region : read.mesh.regions) region.name.insert(0, before);
    }
    if (!all) {
      all = std::move(read);
      continue;
    }
    check_joinable(*item, *all, read);
    all->linear_by_choice = all->linear_by_choice && read.linear_by_choice;
    append(all->mesh, read.mesh);
    add_curve(all->curve, read.curve);
  }
  spec.mesh = std::move(all->mesh);
  spec.mesh_options.quadratic = all->quadratic;
  spec.mesh_options.curve = std::move(all->curve);
  spec.mesh_options.linear_by_choice = all->linear_by_choice;
}

}  // namespace softkin::scene
