#include <algorithm>
#include <array>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/parts.hpp>
#include <softkin/io/scene/scene.hpp>
#include <string>
#include <variant>

namespace softkin {

namespace scene {

namespace {

void check_version(const Node& root) {
  if (root.kind != Node::Kind::map) fail(root, "a scene must be a map that begins with 'softkin: 1'");
  for (const Node::Entry& entry : root.entries) {
    if (entry.key != "softkin") continue;
    if (integer(*entry.value) != 1)
      fail(*entry.value, "this version of softkin reads scenes of version 1, not " + entry.value->text);
    return;
  }
  fail(root, "the scene needs key 'softkin', its version: 'softkin: 1'");
}

double read_length_unit(const Node& node) {
  const Map map(node, {"length"});
  const Node* length = map.find("length");
  return length ? mm_per(length_units()[choice(*length, length_units())]) : 1;
}

std::int64_t read_order(const Node& node) {
  const std::int64_t order = integer(node);
  if (order != 1 && order != 2) fail(node, node.name + " must be 1 or 2, not " + node.text);
  return order;
}

void read_mesh_of(const Context& context, const Node& node, RobotSpec& spec) {
  const Map map(node, {"file", "order"});
  const Node& file = map.at("file");
  const Node* order = map.find("order");
  const bool quadratic = order && read_order(*order) == 2;
  spec.mesh = load_file(context, file, context.files.mesh);
  spec.mesh.vertices *= context.to_mm;
  if (!spec.mesh.vertices.allFinite()) fail(file, "the mesh's coordinates are too large");
  if (order && !quadratic && !spec.mesh.edge_nodes.empty())
    fail(*order, "'order' is 1, but the tetrahedra of the mesh are of order 2");
  spec.quadratic = quadratic;
}

Formulation read_formulation(const Map& map, const std::vector<MaterialSpec>& materials) {
  if (const Node* node = map.find("formulation"))
    return choice(*node, {"target-shape", "physical"}) == 0 ? Formulation::target_shape : Formulation::physical;
  const bool elastic = std::any_of(materials.begin(), materials.end(),
                                   [](const MaterialSpec& material) { return material.elastic.has_value(); });
  return elastic ? Formulation::physical : Formulation::target_shape;
}

std::array<bool, 3> read_axes(const Node& node) {
  std::array<bool, 3> axes{};
  for (const char c : text(node)) {
    const std::size_t axis = std::string("xyz").find(c);
    if (axis == std::string::npos || axes[axis])
      fail(node, node.name + " must be of the letters x, y, z, each at most once, not " + excerpt(node.text));
    axes[axis] = true;
  }
  return axes;
}

FixedSpec read_fixed(const Context& context, const Node& node) {
  Keys known = place_keys();
  known.insert(known.end(), {"axes", "displacement"});
  const Map map(node, known);
  FixedSpec fixed{read_place(context, map)};
  if (const Node* axes = map.find("axes")) fixed.axes = read_axes(*axes);
  if (const Node* displacement = map.find("displacement")) fixed.displacement = read_position(context, *displacement);
  return fixed;
}

RigidSpec read_rigid(const Context& context, const Node& node, std::size_t number) {
  if (node.kind == Node::Kind::scalar) return {read_region_name(node), node.text};
  RigidSpec rigid{read_place(context, Map(node, place_keys())), "rigid_" + std::to_string(number)};
  if (const auto* name = std::get_if<std::string>(&rigid.where.region)) rigid.name = *name;
  return rigid;
}

PointRef read_point_or_region(const Context& context, const Map& map) {
  const Node::Entry& at = map.one_of({"point", "region"});
  if (at.key == "region") return {text(*at.value), map.node().origin};
  return {read_position(context, *at.value), map.node().origin};
}

MarkerSpec read_marker(const Context& context, const Node& node, Names& names) {
  const Map map(node, {"name", "point", "region"});
  return {names.add_label(map.at("name")), read_point_or_region(context, map)};
}

ForceSpec read_force(const Context& context, const Node& node, Names& names) {
  const Map map(node, {"name", "point", "region", "force"});
  return {names.add_label(map.at("name")), read_point_or_region(context, map), read_vector(map.at("force"))};
}

FootSpec read_foot(const Node& node) {
  const Map map(node, {"marker", "forward", "backward"});
  const auto friction = [&map](const char* key) {
    const Node& value = map.at(key);
    const double newtons = number(value);
    if (newtons < 0) fail(value, value.name + " must be 0 N or more, not " + value.text);
    return newtons;
  };
  return {text(map.at("marker")), friction("forward"), friction("backward"), node.origin};
}

void read_parts(const Context& context, const Map& map, RobotSpec& spec) {
  if (const Node* node = map.find("regions")) spec.regions = read_regions(context, *node);
  if (const Node* node = map.find("materials"))
    for (const auto& item : list(*node)) spec.materials.push_back(read_material(*item));
  spec.formulation = read_formulation(map, spec.materials);
  if (const Node* node = map.find("gravity")) spec.gravity = read_vector(*node);
  if (const Node* node = map.find("void"))
    for (const auto& item : list(*node)) spec.voids.push_back(read_region_name(*item));
  if (const Node* node = map.find("fixed"))
    for (const auto& item : list(*node)) spec.fixed.push_back(read_fixed(context, *item));
  if (const Node* node = map.find("rigid"))
    for (const auto& item : list(*node)) spec.rigid.push_back(read_rigid(context, *item, spec.rigid.size() + 1));
  if (const Node* node = map.find("actuators")) spec.actuators = read_actuators(context, spec.formulation, *node);
  if (const Node* node = map.find("forces")) {
    Names names;
    for (const auto& item : list(*node)) spec.forces.push_back(read_force(context, *item, names));
  }
  if (const Node* node = map.find("markers")) {
    Names names;
    for (const auto& item : list(*node)) spec.markers.push_back(read_marker(context, *item, names));
  }
  if (const Node* node = map.find("feet"))
    for (const auto& item : list_of(2, *node)) spec.feet.push_back(read_foot(*item));
}

}  // namespace

}  // namespace scene

RobotSpec parse_scene(const std::string& yaml_text, const std::string& file_name, const SceneFiles& files) {
  const auto root = scene::parse_yaml(yaml_text, file_name);
  scene::check_version(*root);
  const scene::Map map(*root, {"softkin", "units", "mesh", "formulation", "regions", "materials", "void", "fixed",
                               "rigid", "actuators", "gravity", "forces", "markers", "feet"});
  scene::Context context{std::filesystem::path(file_name).parent_path(), files};
  if (const scene::Node* node = map.find("units")) context.to_mm = scene::read_length_unit(*node);
  RobotSpec spec;
  spec.name = file_name;
  scene::read_mesh_of(context, map.at("mesh"), spec);
  context.vertices = spec.mesh.vertices.rows();
  context.tetrahedra = static_cast<std::int64_t>(spec.mesh.tetrahedra.size());
  scene::read_parts(context, map, spec);
  return spec;
}

}  // namespace softkin
