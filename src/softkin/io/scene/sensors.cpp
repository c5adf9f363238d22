#include <softkin/io/scene/parts.hpp>
#include <softkin/model/sensor.hpp>

namespace softkin::scene {

std::shared_ptr<const SensorSpec> read_sensor(const Context& context, const Node& node, Names& names) {
  const Map map(node, {"name", "kind", "points", "regions", "axis"});
  SensorSpec spec;
  spec.name = names.add_label(map.at("name"));
  spec.origin = node.origin;
  spec.kind = choice(map.at("kind"), {"length", "angle"}) == 0 ? SensorKind::length : SensorKind::angle;
  const bool length = spec.kind == SensorKind::length;
  for (const char* key : {"points", "regions", "axis"})
    if (const Node* other = map.find(key); other != nullptr && length != (std::string(key) == "points"))
      fail(*other, other->name + " is not of a sensor of kind '" + map.at("kind").text + "'");
  if (length) {
    for (const auto& point : list(map.at("points"))) spec.points.push_back(read_position(context, *point));
    return std::make_shared<const SensorSpec>(std::move(spec));
  }
  const auto& regions = list_of(2, map.at("regions"));
  for (std::size_t i = 0; i < 2; ++i) spec.sections[i] = text(*regions[i]);
  spec.axis = read_vector(map.at("axis"));
  if (!(spec.axis.stableNorm() > 0)) fail(map.at("axis"), "'axis' has no direction");
  return std::make_shared<const SensorSpec>(std::move(spec));
}

}  // namespace softkin::scene
