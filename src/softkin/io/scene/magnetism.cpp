#include <softkin/io/scene/parts.hpp>
#include <softkin/model/magnetic_field.hpp>

namespace softkin::scene {

namespace {

struct Range {
  double low = 0, high = 0;
};

Range read_field_range(const Node& node) {
  const auto& items = list_of(2, node);
  const Range range{number(*items[0]), number(*items[1])};
  if (range.low > range.high)
    fail(node, node.name + " must be [low, high], but " + items[0]->text + " is above " + items[1]->text);
  return range;
}

/// Adds an actuator for a command of a source.
class MagneticCommands {
 public:
  MagneticCommands(const Node& node, const std::string& name) : node_(node), name_(name) {}

  void add(FieldCommand command, const std::string& suffix, const Range& range, double rest = 0) {
    ActuatorSpec& actuator = actuators_.emplace_back();
    actuator.origin = node_.origin;
    actuator.name = name_ + suffix;
    actuator.control = Control::load;
    actuator.low = range.low;
    actuator.high = range.high;
    actuator.rest = rest;
    commands_.push_back(command);
  }

  [[nodiscard]] std::vector<ActuatorSpec> of(FieldSource source) {
    const auto shared = std::make_shared<const FieldSource>(std::move(source));
    for (std::size_t i = 0; i < actuators_.size(); ++i) actuators_[i].drive = FieldSpec{shared, commands_[i]};
    return std::move(actuators_);
  }

 private:
  const Node& node_;
  std::string name_;
  std::vector<ActuatorSpec> actuators_;
  std::vector<FieldCommand> commands_;
};

constexpr const char* field_axes = "xyz";

UniformField read_uniform(const Map& map, MagneticCommands& commands) {
  const Range range = read_field_range(map.at("range"));
  UniformField field;
  if (const Node* direction = map.find("direction")) {
    if (const Node* axes = map.find("axes")) fail(*axes, "'axes' and 'direction' exclude each other");
    field.direction = read_vector(*direction);
    commands.add(FieldCommand::flux_density, "", range);
    return field;
  }
  std::array<bool, 3> taken{true, true, true};
  if (const Node* axes = map.find("axes")) {
    taken = {false, false, false};
    for (const auto& item : list(*axes)) {
      bool& axis = taken[choice(*item, {"x", "y", "z"})];
      if (axis) fail(*item, "axis " + item->text + " is given twice");
      axis = true;
    }
    if (taken == std::array<bool, 3>{}) fail(*axes, axes->name + " must name an axis: x, y or z");
  }
  for (int axis = 0; axis < 3; ++axis)
    if (taken[axis])
      commands.add(static_cast<FieldCommand>(static_cast<int>(FieldCommand::flux_density_x) + axis),
                   std::string("_") + field_axes[axis], range);
  return field;
}

CoilField read_coils(const Context& context, const Node& node) {
  CoilField field;
  for (const auto& item : list(node)) {
    const Map map(*item, {"center", "axis", "radius", "turns"});
    CoilLoop loop;
    loop.center = read_position(context, map.at("center"));
    loop.axis = read_vector(map.at("axis"));
    loop.radius_mm = read_positive_length(context, map.at("radius"));
    if (const Node* turns = map.find("turns")) loop.turns = number(*turns);
    field.loops.push_back(loop);
  }
  return field;
}

GridField read_grid(const Context& context, const Node& node) {
  const auto load = [&](const std::filesystem::path& path) {
    FieldSamples samples = context.files.samples(path);
    if (!samples.in_mm) samples.places *= context.to_mm;
    return grid_of(samples);
  };
  return load_file(context, node, load);
}

/// Three entries, of which each is a number, or the [low, high] of what is commanded. middle: is a command at rest in
/// the middle of its range, else at 0
Vec3 read_entries(const Node& node, double unit, bool middle, FieldCommand first, const std::string& prefix,
                  MagneticCommands& commands) {
  const auto& items = list_of(3, node);
  Vec3 values;
  for (int axis = 0; axis < 3; ++axis) {
    const Node& item = *items[axis];
    if (item.kind != Node::Kind::list) {
      values[axis] = unit * number(item);
      continue;
    }
    Range range = read_field_range(item);
    range = {unit * range.low, unit * range.high};
    values[axis] = middle ? 0.5 * (range.low + range.high) : 0;
    commands.add(static_cast<FieldCommand>(static_cast<int>(first) + axis), prefix + field_axes[axis], range,
                 values[axis]);
  }
  return values;
}

DipoleField read_dipole(const Context& context, const Node& node, MagneticCommands& commands) {
  const Map map(node, {"position", "moment"});
  DipoleField field;
  field.position = read_entries(map.at("position"), context.to_mm, true, FieldCommand::position_x, "_", commands);
  field.moment = read_entries(map.at("moment"), 1, false, FieldCommand::moment_x, "_m", commands);
  return field;
}

}  // namespace

const Keys& field_keys() {
  static const Keys keys{"direction", "axes", "coils", "grid", "dipole"};
  return keys;
}

std::vector<ActuatorSpec> read_field(const Context& context, const Map& map, const std::string& name) {
  for (const char* key : {"control", "weight", "distribution"})
    if (const Node::Entry* entry = map.entry(key))
      throw InvalidInput(entry->origin, "key '" + entry->key + "' does not belong to kind 'magnetic'");
  const Node::Entry* kind = nullptr;
  for (const std::string& key : field_keys())
    if (const Node::Entry* entry = map.entry(key)) {
      const bool uniform = kind && kind->key == "direction" && key == "axes";
      if (kind && !uniform)
        throw InvalidInput(entry->origin, "key '" + key + "' excludes '" + kind->key + "': a field has one source");
      if (!kind) kind = entry;
    }
  MagneticCommands commands(map.node(), name);
  FieldSource source{name, UniformField{}};
  if (kind && kind->key == "dipole") {
    if (const Node::Entry* range = map.entry("range"))
      throw InvalidInput(range->origin,
                         "'range' does not belong to a dipole: what is commanded of its 'position' and "
                         "'moment' is [low, high] there");
    source.field = read_dipole(context, *kind->value, commands);
    auto actuators = commands.of(std::move(source));
    if (actuators.empty())
      fail(*kind->value, kind->value->name +
                             " must have something to command: [low, high] in place of a number of its "
                             "'position' or 'moment'");
    return actuators;
  }
  if (kind && kind->key == "coils")
    source.field = read_coils(context, *kind->value);
  else if (kind && kind->key == "grid")
    source.field = read_grid(context, *kind->value);
  else
    source.field = read_uniform(map, commands);
  if (!std::holds_alternative<UniformField>(source.field))
    commands.add(FieldCommand::current, "", read_field_range(map.at("range")));
  return commands.of(std::move(source));
}

namespace {

Points read_triples(const Node& node, double unit) {
  const auto& items = list(node);
  Points triples(items.size(), 3);
  for (std::size_t i = 0; i < items.size(); ++i) triples.row(i) = unit * read_vector(*items[i]).transpose();
  return triples;
}

}  // namespace

FieldSamples read_samples(const Context& context, const Map& map) {
  const Node &places = map.at("places"), &samples = map.at("samples");
  FieldSamples all{places.origin.file, read_triples(places, context.to_mm), read_triples(samples, 1), true, {}};
  if (all.places.rows() == 0) fail(places, places.name + " is empty");
  if (all.places.rows() != all.values.rows())
    fail(samples, samples.name + " must hold as many as 'places', " + std::to_string(all.places.rows()) + ", not " +
                      std::to_string(all.values.rows()));
  return all;
}

std::shared_ptr<const RemanenceSpec> read_remanence(const Context& context, const Map& material) {
  const Node *given = material.find("remanence"), *magnetisation = material.find("magnetisation");
  if (!given) {
    if (magnetisation) fail(*magnetisation, magnetisation->name + " says what becomes of a 'remanence': there is none");
    return nullptr;
  }
  const Node& node = *given;
  RemanenceSpec remanence;
  if (magnetisation)
    remanence.magnetisation = static_cast<Magnetisation>(choice(*magnetisation, {"turns", "stretches"}));
  if (node.kind == Node::Kind::map) {
    const Map map(node, {"file", "places", "samples"});
    const Node* file = map.find("file");
    for (const char* key : {"places", "samples"})
      if (const Node* beside = map.find(key); beside != nullptr && file != nullptr)
        fail(*beside, beside->name + " and 'file' exclude each other");
    FieldSamples samples =
        file != nullptr ? load_file(context, *file, context.files.samples) : read_samples(context, map);
    remanence.file = std::move(samples.file);
    remanence.places = samples.in_mm ? std::move(samples.places) : Points(context.to_mm * samples.places);
    remanence.samples = std::move(samples.values);
  } else {
    remanence.uniform = read_vector(node);
  }
  return std::make_shared<const RemanenceSpec>(std::move(remanence));
}

}  // namespace softkin::scene
