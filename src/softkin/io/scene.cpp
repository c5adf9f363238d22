#include <array>
#include <softkin/io/length_unit.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene.hpp>
#include <softkin/io/scene_parts.hpp>
#include <string>
#include <variant>

namespace softkin {

namespace scene {

namespace {

constexpr const char* not_in_this_version = "is not in this version of softkin";

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

void check_formulation(const Node& node) {
  if (text(node) == "physical")
    fail(node, std::string("formulation 'physical' ") + not_in_this_version + "; use 'target-shape'");
  (void)choice(node, {"target-shape"});
}

double read_length_unit(const Node& node) {
  const Map map(node, {"length"});
  const Node* length = map.find("length");
  return length ? mm_per(length_units()[choice(*length, length_units())]) : 1;
}

Mesh read_mesh_of(const Context& context, const Node& node) {
  const Map map(node, {"file"});
  const Node& file = map.at("file");
  Mesh mesh = load_file(context, file, context.files.mesh);
  mesh.vertices *= context.to_mm;
  if (!mesh.vertices.allFinite()) fail(file, "the mesh's coordinates are too large");
  return mesh;
}

MaterialSpec read_material(const Node& node) {
  const Keys physical{"youngs_modulus", "poisson_ratio", "law"};
  const Map map(node, {"region", "shape_ratio", "weight", "linear_range", physical[0], physical[1], physical[2]});
  for (const std::string& key : physical)
    if (const Node::Entry* entry = map.entry(key))
      throw InvalidInput(entry->origin, "key '" + key + "' belongs to the physical formulation, which " +
                                            not_in_this_version + "; use 'shape_ratio'");
  MaterialSpec material;
  material.origin = node.origin;
  const Node* region = map.find("region");
  material.region = region ? text(*region) : "all";
  const Node& ratio = map.at("shape_ratio");
  material.shape_ratio = number(ratio);
  if (material.shape_ratio < 0 || material.shape_ratio > 1)
    fail(ratio, "'shape_ratio' must be from 0 to 1, not " + ratio.text);
  if (const Node* weight = map.find("weight")) material.weight = positive(*weight);
  if (const Node* range = map.find("linear_range")) material.linear_range = positive(*range);
  return material;
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

MarkerSpec read_marker(const Context& context, const Node& node, Names& names) {
  const Map map(node, {"name", "point", "region"});
  const std::string& name = names.add_label(map.at("name"));
  const Node::Entry& at = map.one_of({"point", "region"});
  if (at.key == "region") return {name, {text(*at.value), node.origin}};
  return {name, {read_position(context, *at.value), node.origin}};
}

void read_parts(const Context& context, const Map& map, RobotSpec& spec) {
  if (const Node* node = map.find("regions")) spec.regions = read_regions(context, *node);
  if (const Node* node = map.find("materials"))
    for (const auto& item : list(*node)) spec.materials.push_back(read_material(*item));
  if (const Node* node = map.find("void"))
    for (const auto& item : list(*node)) spec.voids.push_back(read_region_name(*item));
  if (const Node* node = map.find("fixed"))
    for (const auto& item : list(*node)) spec.fixed.push_back(read_fixed(context, *item));
  if (const Node* node = map.find("rigid"))
    for (const auto& item : list(*node)) spec.rigid.push_back(read_rigid(context, *item, spec.rigid.size() + 1));
  if (const Node* node = map.find("actuators")) spec.actuators = read_actuators(context, *node);
  if (const Node* node = map.find("markers")) {
    Names names;
    for (const auto& item : list(*node)) spec.markers.push_back(read_marker(context, *item, names));
  }
}

}  // namespace

}  // namespace scene

RobotSpec parse_scene(const std::string& yaml_text, const std::string& file_name, const SceneFiles& files) {
  const auto root = scene::parse_yaml(yaml_text, file_name);
  scene::check_version(*root);
  const scene::Map map(*root, {"softkin", "units", "mesh", "formulation", "regions", "materials", "void", "fixed",
                               "rigid", "actuators", "markers"});
  if (const scene::Node* node = map.find("formulation")) scene::check_formulation(*node);
  scene::Context context{std::filesystem::path(file_name).parent_path(), files};
  if (const scene::Node* node = map.find("units")) context.to_mm = scene::read_length_unit(*node);
  RobotSpec spec;
  spec.name = file_name;
  spec.mesh = scene::read_mesh_of(context, map.at("mesh"));
  context.vertices = spec.mesh.vertices.rows();
  context.tetrahedra = static_cast<std::int64_t>(spec.mesh.tetrahedra.size());
  scene::read_parts(context, map, spec);
  return spec;
}

}  // namespace softkin
