#include <softkin/io/scene/parts.hpp>
#include <softkin/model/growth.hpp>

namespace softkin::scene {

namespace {

/// `radial` and `circumferential`: about a line.
DirectionSpec read_around(const Context& context, const Node::Entry& entry) {
  const bool around = entry.key == "circumferential";
  const Map map(*entry.value, around ? Keys{"center", "axis", "degrees"} : Keys{"center", "axis"});
  DirectionSpec spec;
  spec.kind = around ? DirectionSpec::Kind::circumferential : DirectionSpec::Kind::radial;
  spec.center = read_position(context, map.at("center"));
  const Node& axis = map.at("axis");
  spec.axis = read_vector(axis);
  if (spec.axis.isZero(0)) fail(axis, axis.name + " must not be zero");
  if (const Node* degrees = map.find("degrees")) spec.degrees = number(*degrees);
  return spec;
}

DirectionSpec sampled(const Context& context, FieldSamples samples) {
  DirectionSpec spec;
  spec.kind = DirectionSpec::Kind::samples;
  spec.file = std::move(samples.file);
  spec.places = samples.in_mm ? std::move(samples.places) : Points(context.to_mm * samples.places);
  spec.samples = std::move(samples.values);
  return spec;
}

/// reference: that of the actuator; none: it is this one
TemperatureSpec read_temperature(const Node& node, const std::optional<double>& reference) {
  const Map map(node, reference ? Keys{"expansion_per_K", "table"} : Keys{"reference_C", "expansion_per_K", "table"});
  TemperatureSpec spec;
  if (reference) spec.reference_C = *reference;
  if (const Node* own = map.find("reference_C")) spec.reference_C = number(*own);
  const Node::Entry& by = map.one_of({"expansion_per_K", "table"});
  if (by.key == "expansion_per_K") {
    spec.expansion_per_K = number(*by.value);
    return spec;
  }
  for (const auto& item : list(*by.value)) {
    const auto& pair = list_of(2, *item);
    spec.table.push_back({number(*pair[0]), positive(*pair[1])});
  }
  try {
    (void)GrowthCurve(spec);
  } catch (const InvalidInput& error) {
    fail(*by.value, by.value->name + ": " + error.what());
  }
  return spec;
}

/// The keys of growth_keys() but `also`.
GrowthPart read_part(const Context& context, const Map& map, const std::optional<double>& reference) {
  GrowthPart part;
  part.region = text(map.at("region"));
  if (const Node* direction = map.find("direction")) part.direction = read_direction(context, *direction);
  if (const Node* keeps = map.find("keeps_volume")) {
    part.keeps_volume = choice(*keeps, {"false", "true"}) == 1;
    if (part.keeps_volume && !part.direction) fail(*keeps, keeps->name + " needs a 'direction'");
  }
  if (const Node* temperature = map.find("temperature")) part.temperature = read_temperature(*temperature, reference);
  return part;
}

/// The part of an actuator, and what else grows with it.
GrowthSpec read_parts_of(const Context& context, const Map& map) {
  GrowthSpec growth;
  growth.parts.push_back(read_part(context, map, std::nullopt));
  const auto& temperature = growth.parts.front().temperature;
  const std::optional<double> reference = temperature ? std::optional(temperature->reference_C) : std::nullopt;
  const Node* also = map.find("also");
  if (also == nullptr) return growth;
  for (const auto& item : list(*also)) {
    const Map other(*item, {"region", "direction", "keeps_volume", "temperature"});
    const Node* own = other.find("temperature");
    if ((own != nullptr) != reference.has_value())
      fail(own != nullptr ? *own : *item, item->name + (reference ? " needs" : " takes no") +
                                              " 'temperature', as the actuator is commanded by its " +
                                              (reference ? "temperature" : "stretch"));
    growth.parts.push_back(read_part(context, other, reference));
  }
  return growth;
}

}  // namespace

DirectionSpec read_direction(const Context& context, const Node& node) {
  DirectionSpec spec;
  if (node.kind != Node::Kind::map) {
    spec.uniform = read_vector(node);
    if (spec.uniform.isZero(0)) fail(node, node.name + " must not be zero");
    return spec;
  }
  const Map map(node, {"radial", "circumferential", "file", "places", "samples"});
  if (map.find("places") != nullptr || map.find("samples") != nullptr) {
    for (const char* key : {"radial", "circumferential", "file"})
      if (const Node* beside = map.find(key)) fail(*beside, beside->name + " and 'places' exclude each other");
    return sampled(context, read_samples(context, map));
  }
  const Node::Entry& entry = map.one_of({"radial", "circumferential", "file"});
  if (entry.key != "file") return read_around(context, entry);
  return sampled(context, load_file(context, *entry.value, context.files.directions));
}

const Keys& growth_keys() {
  static const Keys keys{"region", "direction", "keeps_volume", "temperature", "also"};
  return keys;
}

ActuatorSpec read_growth(const Context& context, const Map& map, const std::string& name) {
  for (const char* key : {"control", "weight", "distribution"})
    if (const Node::Entry* entry = map.entry(key))
      throw InvalidInput(entry->origin, "key '" + entry->key + "' does not belong to kind 'growth'");
  ActuatorSpec actuator;
  actuator.origin = map.node().origin;
  actuator.name = name;
  GrowthSpec growth = read_parts_of(context, map);
  const Node& range = map.at("range");
  const auto& items = list_of(2, range);
  if (const auto& temperature = growth.parts.front().temperature) {
    actuator.control = Control::load;
    actuator.rest = temperature->reference_C;
    actuator.low = number(*items[0]);
    actuator.high = number(*items[1]);
  } else {
    actuator.low = positive(*items[0]);
    actuator.high = positive(*items[1]);
  }
  if (actuator.low > actuator.high)
    fail(range, range.name + " must be [low, high], but " + items[0]->text + " is above " + items[1]->text);
  actuator.drive = std::move(growth);
  return actuator;
}

}  // namespace softkin::scene
