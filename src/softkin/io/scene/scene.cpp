#include <algorithm>
#include <array>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/changes.hpp>
#include <softkin/io/scene/parts.hpp>
#include <softkin/io/scene/scene.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>
#include <softkin/model/joined.hpp>
#include <string>
#include <variant>

namespace softkin {

namespace scene {

namespace {

double read_length_unit(const Node& node) {
  const Map map(node, {"length"});
  const Node* length = map.find("length");
  return length ? mm_per(length_units()[choice(*length, length_units())]) : 1;
}

Formulation formulation_of(const Context& context, const Map& map, const std::vector<MaterialSpec>& materials) {
  if (context.formulation) return *context.formulation;
  if (const Node* node = map.find("formulation")) return read_formulation(*node);
  const bool elastic = std::any_of(materials.begin(), materials.end(),
                                   [](const MaterialSpec& material) { return material.elastic.has_value(); });
  return elastic ? Formulation::physical : Formulation::target_shape;
}

std::array<bool, 3> read_held_axes(const Node& node) {
  std::array<bool, 3> axes{};
  for (const char c : text(node)) {
    const std::size_t axis = std::string("xyz").find(c);
    if (axis == std::string::npos || axes[axis])
      fail(node, node.name + " must be of the letters x, y, z, each at most once, not " + excerpt(node.text));
    axes[axis] = true;
  }
  return axes;
}

RotationSpec read_rotation(const Context& context, const Node& node) {
  const Map map(node, {"axis", "degrees", "about"});
  RotationSpec rotation;
  rotation.axis = read_vector(map.at("axis"));
  if (!(rotation.axis.stableNorm() > 0)) fail(map.at("axis"), "'axis' has no direction");
  if (const Node* degrees = map.find("degrees")) rotation.degrees = number(*degrees);
  if (const Node* about = map.find("about")) rotation.about = read_position(context, *about);
  return rotation;
}

FixedSpec read_fixed(const Context& context, const Node& node) {
  Keys known = place_keys();
  known.insert(known.end(), {"axes", "displacement", "rotation"});
  const Map map(node, known);
  FixedSpec fixed{read_place(context, map)};
  if (const Node* axes = map.find("axes")) fixed.axes = read_held_axes(*axes);
  if (const Node* displacement = map.find("displacement")) fixed.displacement = read_position(context, *displacement);
  if (const Node* rotation = map.find("rotation")) fixed.rotation = read_rotation(context, *rotation);
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

/// A point, the mean of a region, or a stem on one: by its offset, or by the point where it ends.
MarkerSpec read_marker(const Context& context, const Node& node, Names& names) {
  const Map map(node, {"name", "point", "region", "offset"});
  const std::string name = names.add_label(map.at("name"));
  const Node *point = map.find("point"), *region = map.find("region"), *offset = map.find("offset");
  if (point != nullptr && region != nullptr) {
    if (offset != nullptr) fail(*offset, "a stem ends at 'point' or by 'offset', not both");
    return {name, {read_position(context, *point), node.origin}, std::nullopt, text(*region)};
  }
  MarkerSpec marker{name, read_point_or_region(context, map)};
  if (offset == nullptr) return marker;
  if (region == nullptr) fail(*offset, "'offset' is from the mean of a 'region', which the marker has not");
  marker.offset = read_position(context, *offset);
  return marker;
}

/// Of a commanded force or moment along x, y and z: [low, high] each.
std::array<Vec3, 2> read_force_range(const Node& node) {
  std::array<Vec3, 2> range{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& ends = list_of(2, *list_of(3, node)[axis]);
    for (std::size_t end = 0; end < 2; ++end) range[end][axis] = number(*ends[end]);
  }
  return range;
}

ForceSpec read_force(const Context& context, const Node& node, Names& names) {
  const Map map(node, {"name", "point", "region", "force", "range", "moment", "moment_range"});
  ForceSpec spec{names.add_label(map.at("name")), read_point_or_region(context, map)};
  const Node *range = map.find("range"), *moment = map.find("moment"), *moment_range = map.find("moment_range");
  const bool turns = moment != nullptr || moment_range != nullptr;
  if (range != nullptr) spec.range = read_force_range(*range);
  if ((range == nullptr && !turns) || map.find("force") != nullptr) spec.force = read_vector(map.at("force"));
  if (moment != nullptr) spec.moment = read_vector(*moment);
  if (moment_range != nullptr) spec.moment_range = read_force_range(*moment_range);
  return spec;
}

/// A traction that keeps its direction or turns with the surface, or a pressure, which may be commanded.
TractionSpec read_traction(const Context& context, const Node& node, Names& names) {
  Keys known = place_keys();
  known.insert(known.end(), {"name", "traction", "pressure", "follows", "range"});
  const Map map(node, known);
  TractionSpec spec{names.add_label(map.at("name")), read_place(context, map)};
  const Node *traction = map.find("traction"), *follows = map.find("follows"), *range = map.find("range");
  if (range == nullptr || traction != nullptr) (void)map.one_of({"traction", "pressure"});
  if (traction != nullptr) {
    if (range != nullptr) fail(*range, "a pressure can have a range, a traction cannot");
    spec.kilopascals = read_vector(*traction);
    spec.follows = follows != nullptr && choice(*follows, {"false", "true"}) == 1;
    return spec;
  }
  if (follows != nullptr) fail(*follows, "a pressure always follows the surface: leave 'follows' out");
  spec.follows = true;
  if (const Node* pressure = map.find("pressure")) spec.pressure_kPa = number(*pressure);
  if (range != nullptr) {
    const auto& ends = list_of(2, *range);
    spec.range_kPa = {number(*ends[0]), number(*ends[1])};
  }
  return spec;
}

/// A liquid up to a place of its surface, or to a level against gravity from the origin.
LiquidAroundSpec read_submerged(const Context& context, const Node& node, const Vec3& gravity) {
  const Map map(node, {"density", "surface", "level"});
  LiquidAroundSpec liquid;
  liquid.origin = node.origin;
  if (const Node* density = map.find("density")) liquid.density = positive(*density);
  const Node::Entry& place = map.one_of({"surface", "level"});
  if (place.key == "surface") {
    liquid.surface = read_position(context, *place.value);
    return liquid;
  }
  if (gravity.isZero(0)) fail(*place.value, "'level' is measured against 'gravity', which this scene does not have");
  liquid.surface = -read_length(context, *place.value) * gravity.stableNormalized();
  return liquid;
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

void set_atmosphere(double kPa, RobotSpec& spec) {
  for (ActuatorSpec& actuator : spec.actuators)
    if (auto* chamber = actuator.as<PneumaticSpec>(); chamber && chamber->filling)
      chamber->filling->atmosphere_kPa = kPa;
}

void read_parts(const Context& context, const Map& map, RobotSpec& spec) {
  const auto each = [&map](const char* key, const auto& read) {
    if (const Node* node = map.find(key))
      for (const auto& item : list(*node)) read(*item);
  };
  Names forces, tractions, fibres, layers, markers, sensors;
  if (const Node* node = map.find("regions")) spec.regions = read_regions(context, *node);
  each("materials", [&](const Node& item) { spec.materials.push_back(read_material(context, item)); });
  spec.formulation = formulation_of(context, map, spec.materials);
  if (const Node* node = map.find("weights")) spec.weights = read_weights(*node);
  if (const Node::Entry* gravity = map.entry("gravity")) {
    spec.loads.gravity = read_vector(*gravity->value);
    spec.loads.gravity_origin = gravity->origin;
  }
  each("void", [&](const Node& item) { spec.voids.push_back(read_region_name(item)); });
  each("fixed", [&](const Node& item) { spec.fixed.push_back(read_fixed(context, item)); });
  each("rigid", [&](const Node& item) { spec.rigid.push_back(read_rigid(context, item, spec.rigid.size() + 1)); });
  if (const Node* node = map.find("actuators")) spec.actuators = read_actuators(context, spec.formulation, *node);
  if (const Node* node = map.find("submerged"))
    spec.loads.liquid_around = read_submerged(context, *node, spec.loads.gravity);
  if (const Node* node = map.find("atmosphere")) set_atmosphere(positive(*node), spec);
  each("forces", [&](const Node& item) { spec.loads.forces.push_back(read_force(context, item, forces)); });
  each("tractions", [&](const Node& item) { spec.loads.tractions.push_back(read_traction(context, item, tractions)); });
  each("fibres", [&](const Node& item) { spec.fibres.push_back(read_fibre(context, item, fibres)); });
  each("layers", [&](const Node& item) { spec.layers.push_back(read_layer(context, item, layers)); });
  each("markers", [&](const Node& item) { spec.markers.push_back(read_marker(context, item, markers)); });
  each("sensors", [&](const Node& item) { spec.sensors.push_back(read_sensor(context, item, sensors)); });
  if (const Node* node = map.find("feet"))
    for (const auto& item : list_of(2, *node)) spec.feet.push_back(read_foot(*item));
  spec.contact = read_contact(context, map);
}

RobotSpec read_several(Context& context, const Map& map, const std::string& file_name) {
  (void)map.one_of({"mesh", "meshes", "robots"});  // fails where there are two of them
  RobotSpec robots = read_robots(context, map, file_name), common;
  context.formulation = robots.formulation;
  context.vertices = robots.mesh.vertices.rows();
  context.tetrahedra = static_cast<std::int64_t>(robots.mesh.tetrahedra.size());
  read_parts(context, map, common);
  add_common(robots, std::move(common));
  return robots;
}

}  // namespace

Formulation read_formulation(const Node& node) {
  return choice(node, {"target-shape", "physical"}) == 0 ? Formulation::target_shape : Formulation::physical;
}

ElementWeights read_weights(const Node& node) {
  return choice(node, {"printed", "mesh-independent"}) == 0 ? ElementWeights::printed
                                                            : ElementWeights::mesh_independent;
}

}  // namespace scene

RobotSpec parse_scene(const std::string& yaml_text, const std::string& file_name, const SceneFiles& files) {
  return parse_scene(*scene::parse_yaml(yaml_text, file_name), file_name, files);
}

RobotSpec parse_scene(const scene::Node& root, const std::string& file_name, const SceneFiles& files) {
  scene::check_version(root, "softkin", "scenes", "a scene must be a map that begins with 'softkin: 1'",
                       "the scene needs key 'softkin', its version: 'softkin: 1'");
  const scene::Map map(
      root, {"softkin", "units", "mesh",    "meshes",    "robots",  "formulation", "weights",   "regions", "materials",
             "void",    "fixed", "rigid",   "actuators", "gravity", "forces",      "tractions", "fibres",  "layers",
             "markers", "feet",  "contact", "obstacles", "bodies",  "atmosphere",  "submerged", "sensors"});
  scene::Context context{std::filesystem::path(file_name).parent_path(), files};
  if (const scene::Node* node = map.find("units")) context.to_mm = scene::read_length_unit(*node);
  if (map.find("robots") != nullptr) return scene::read_several(context, map, file_name);
  RobotSpec spec;
  spec.name = file_name;
  scene::read_mesh_of(context, map, spec);
  context.vertices = spec.mesh.vertices.rows();
  context.tetrahedra = static_cast<std::int64_t>(spec.mesh.tetrahedra.size());
  scene::read_parts(context, map, spec);
  return spec;
}

RobotSpec read_scene(const std::filesystem::path& path) {
  return parse_scene(read_scene_file(path), path.string(), {read_mesh, read_surface, read_sidecar});
}

namespace fs = std::filesystem;

namespace {

RobotSpec read_scene_and(std::vector<fs::path>& inputs, const RequestedScene& requested) {
  const auto noting = [&inputs](auto read) {
    return [&inputs, read](const fs::path& path) {
      inputs.push_back(path);
      return read(path);
    };
  };
  auto root = scene::parse_yaml(read_scene_file(requested.scene), requested.scene);
  for (const std::string& material : requested.materials)
    root = scene::changed(root, "--material", material, "materials");
  for (const std::string& each : requested.changes) root = scene::changed(root, "--change", each, "");
  return parse_scene(*root, requested.scene,
                     {noting(read_mesh), noting(read_surface), noting(read_sidecar), noting(read_actuator_curve),
                      noting(read_scene_file), noting(read_field_samples), noting(read_path), noting(read_directions)});
}

bool parse_vector(const std::string& text, Vec3& vector) {
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t end = axis < 2 ? text.find(',', begin) : text.size();
    if (end == std::string::npos || !parse_real(text.substr(begin, end - begin), vector[axis])) return false;
    begin = end + 1;
  }
  return true;
}

ForceSpec* find_force(RobotSpec& spec, const std::string& name) {
  for (ForceSpec& force : spec.loads.forces)
    if (force.name == name) return &force;
  return nullptr;
}

std::string unknown_force(const RobotSpec& spec, const std::string& name) {
  std::vector<std::string> names;
  for (const ForceSpec& force : spec.loads.forces) names.push_back(force.name);
  return "no force " + excerpt(name) + (names.empty() ? "; the scene has none" : suggest_name(name, names));
}

void change_forces(RobotSpec& spec, const std::vector<std::string>& forces, const std::string& option) {
  std::set<std::string> changed;
  for (const std::string& force : forces) {
    const auto refuse = [&](const std::string& why) { throw InvalidInput(option + " " + excerpt(force) + ": " + why); };
    if (spec.formulation != Formulation::physical)
      refuse("the target-shape formulation knows no forces; the physical one does");
    const std::size_t equals = force.find('=');
    if (equals == std::string::npos) refuse("expected NAME=FX,FY,FZ in N, for example " + option + " payload=0,0,-0.5");
    const std::string name = force.substr(0, equals), text = force.substr(equals + 1);
    ForceSpec* found = find_force(spec, name);
    if (found == nullptr) refuse(unknown_force(spec, name));
    if (!parse_vector(text, found->force))
      refuse("the force must be three finite numbers in N, FX,FY,FZ, not " + excerpt(text));
    if (!changed.insert(name).second) refuse("force '" + name + "' is given twice");
  }
}

}  // namespace

RobotSpec read_requested_scene(const RequestedScene& requested, std::vector<fs::path>& inputs) {
  RobotSpec spec = read_scene_and(inputs, requested);
  change(spec, requested);
  return spec;
}

void change(RobotSpec& spec, const RequestedScene& requested, const std::string& option) {
  if (requested.formulation == "physical") spec.formulation = Formulation::physical;
  if (requested.formulation == "target-shape") spec.formulation = Formulation::target_shape;
  change_forces(spec, requested.forces, option);
}

}  // namespace softkin
