#include <softkin/io/scene/parts.hpp>
#include <softkin/model/sensor.hpp>

namespace softkin::scene {

std::shared_ptr<const SensorSpec> read_sensor(const Context& context, const Node& node, Names& names) {
  const Keys kind_names{"length", "angle", "direction"};
  check_choice(node, "kind", kind_names);
  const Map map(node, {"name", "kind", "points", "regions", "region", "axis"});
  SensorSpec spec;
  spec.name = names.add_label(map.at("name"));
  spec.origin = node.origin;
  constexpr SensorKind kinds[] = {SensorKind::length, SensorKind::angle, SensorKind::direction};
  spec.kind = kinds[choice(map.at("kind"), kind_names)];
  constexpr const char* places[] = {"points", "regions", "region"};
  const std::string own = places[static_cast<std::size_t>(spec.kind)];
  for (const std::string& key : Keys{"points", "regions", "region", "axis"})
    if (const Node* other = map.find(key);
        other != nullptr && key != own && (key != "axis" || spec.kind == SensorKind::length))
      fail(*other, other->name + " is not of a sensor of kind '" + map.at("kind").text + "'");
  if (spec.kind == SensorKind::length) {
    for (const auto& point : list(map.at("points"))) spec.points.push_back(read_position(context, *point));
    return std::make_shared<const SensorSpec>(std::move(spec));
  }
  if (spec.kind == SensorKind::direction) {
    spec.sections[0] = text(map.at("region"));
  } else {
    const auto& regions = list_of(2, map.at("regions"));
    for (std::size_t i = 0; i < 2; ++i) spec.sections[i] = text(*regions[i]);
  }
  spec.axis = read_vector(map.at("axis"));
  if (!(spec.axis.stableNorm() > 0)) fail(map.at("axis"), "'axis' has no direction");
  return std::make_shared<const SensorSpec>(std::move(spec));
}

}  // namespace softkin::scene
