#include <softkin/io/scene/parts.hpp>

namespace softkin::scene {

namespace {

constexpr double sharpest = 120;  // degrees: beyond it nothing is left to be called a crease

void read_crease(const Node& node, CurveSpec& curve) {
  curve.smooth = true;
  curve.crease_degrees = number(node);
  if (!(curve.crease_degrees > 0 && curve.crease_degrees <= sharpest))
    fail(node, node.name + " must be above 0 and at most 120 degrees, not " + node.text);
}

void read_curve_surface(const Context& context, const Node& node, CurveSpec& curve) {
  const Map map(node, {"crease", "file", "unit", "move", "rotate", "cylinder", "sphere"});
  const Node::Entry& found = map.one_of({"crease", "file", "cylinder", "sphere"});
  for (const std::string key : {"unit", "move", "rotate"})
    if (map.find(key) && found.key != "file") fail(*map.find(key), "'" + key + "' is that of a 'file' alone");
  if (found.key == "crease") return read_crease(*found.value, curve);
  GivenSurface surface{Sphere{}, found.origin};
  if (found.key == "file")
    surface.shape = read_moved_surface(context, *found.value, map);
  else if (found.key == "cylinder")
    surface.shape = read_cylinder(context, *found.value);
  else
    surface.shape = read_sphere(context, *found.value);
  curve.surfaces.push_back(std::move(surface));
}

void read_entry(const Context& context, const Node& node, CurveSpec& curve) {
  if (node.kind == Node::Kind::map) return read_curve_surface(context, node, curve);
  if (choice(node, {"true"}) == 0) curve.smooth = true;
}

}  // namespace

std::optional<CurveSpec> read_curve(const Context& context, const Node& node) {
  CurveSpec curve;
  curve.origin = node.origin;
  if (node.kind == Node::Kind::list) {
    if (list(node).empty()) fail(node, node.name + " is empty");
    for (const auto& entry : list(node)) read_entry(context, *entry, curve);
    return curve;
  }
  if (node.kind == Node::Kind::map) {
    read_curve_surface(context, node, curve);
    return curve;
  }
  if (choice(node, {"false", "true"}) == 0) return std::nullopt;
  curve.smooth = true;
  return curve;
}

}  // namespace softkin::scene
