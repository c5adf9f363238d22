#include <softkin/io/scene/parts.hpp>

namespace softkin::scene {

namespace {

Capsule read_capsule(const Context& context, const Node& node) {
  const auto [start, end, radius] = read_cylinder(context, node);
  return {start, end, radius};
}

ObstacleShape read_shape(const Context& context, const std::string& key, const Node& node) {
  if (key == "box") return read_box(context, node);
  if (key == "sphere") return read_sphere(context, node);
  if (key == "cylinder") return read_cylinder(context, node);
  if (key == "capsule") return read_capsule(context, node);
  if (key == "halfspace") return read_halfspace(context, node);
  return read_surface(context, node);
}

/// "x", "y" and "z".
std::array<bool, 3> read_motion_axes(const Node& node) {
  std::array<bool, 3> axes{false, false, false};
  for (const auto& item : list(node)) {
    bool& axis = axes[choice(*item, {"x", "y", "z"})];
    if (axis) fail(*item, "axis " + item->text + " is given twice");
    axis = true;
  }
  return axes;
}

std::vector<ObstacleSpec> read_obstacles(const Context& context, const Node& node) {
  const Keys shapes{"box", "sphere", "cylinder", "capsule", "halfspace", "surface"};
  Keys known = shapes;
  known.insert(known.begin(), {"name", "friction", "motion"});
  std::vector<ObstacleSpec> obstacles;
  Names names;
  for (const auto& item : list(node)) {
    const Map map(*item, known);
    ObstacleSpec spec;
    spec.name = names.add_label(map.at("name"));
    const Node::Entry& shape = map.one_of(shapes);
    spec.shape = read_shape(context, shape.key, *shape.value);
    if (const Node* friction = map.find("friction")) spec.friction = not_negative(*friction);
    if (const Node* motion = map.find("motion")) spec.motion = read_motion_axes(*motion);
    spec.origin = item->origin;
    obstacles.push_back(std::move(spec));
  }
  return obstacles;
}

std::vector<BodySpec> read_bodies(const Context& context, const Node& node) {
  const Keys shapes{"box", "sphere", "cylinder", "capsule", "surface"};
  Keys known = shapes;
  known.insert(known.begin(), {"name", "density", "friction"});
  std::vector<BodySpec> bodies;
  Names names;
  for (const auto& item : list(node)) {
    const Map map(*item, known);
    BodySpec spec;
    spec.name = names.add_label(map.at("name"));
    const Node::Entry& shape = map.one_of(shapes);
    spec.shape = read_shape(context, shape.key, *shape.value);
    if (const Node* density = map.find("density")) spec.density = read_density(*density);
    if (const Node* friction = map.find("friction")) spec.friction = not_negative(*friction);
    spec.origin = item->origin;
    bodies.push_back(std::move(spec));
  }
  return bodies;
}

ContactPairSpec read_pair(const Node& node) {
  const Map map(node, {"a", "b", "friction"});
  return {text(map.at("a")), text(map.at("b")), not_negative(map.at("friction")), node.origin};
}

void read_contact_keys(const Context& context, const Node& node, ContactSpec& spec) {
  const Map map(node, {"distance", "friction", "self", "pairs"});
  if (const Node* distance = map.find("distance")) spec.distance_mm = read_positive_length(context, *distance);
  if (const Node* friction = map.find("friction")) spec.friction = not_negative(*friction);
  if (const Node* self = map.find("self")) spec.self = choice(*self, {"false", "true"}) == 1;
  if (const Node* pairs = map.find("pairs"))
    for (const auto& item : list(*pairs)) spec.pairs.push_back(read_pair(*item));
}

}  // namespace

std::optional<ContactSpec> read_contact(const Context& context, const Map& scene) {
  const Node::Entry* contact = scene.entry("contact");
  const Node::Entry* obstacles = scene.entry("obstacles");
  const Node::Entry* bodies = scene.entry("bodies");
  if (contact == nullptr && obstacles == nullptr && bodies == nullptr) return std::nullopt;
  ContactSpec spec;
  spec.origin = (contact ? contact : obstacles ? obstacles : bodies)->origin;
  if (contact) read_contact_keys(context, *contact->value, spec);
  if (obstacles) spec.obstacles = read_obstacles(context, *obstacles->value);
  if (bodies) spec.bodies = read_bodies(context, *bodies->value);
  return spec;
}

}  // namespace softkin::scene
