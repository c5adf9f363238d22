#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/hardware.hpp>
#include <softkin/io/scene/parts.hpp>
#include <softkin/io/scene/tree.hpp>

namespace softkin {

namespace {

using scene::Keys;
using scene::Map;
using scene::Node;

const std::string axis_letters = "XYZABCUVW";

template <class Value, class Read>
std::optional<Value> optional(const Map& map, const char* key, const Read& read) {
  const Node* node = map.find(key);
  return node ? std::optional<Value>(read(*node)) : std::nullopt;
}

std::array<double, 2> limits(const Node& node) {
  const auto& items = scene::list_of(2, node);
  const std::array<double, 2> result{scene::number(*items[0]), scene::number(*items[1])};
  if (result[0] > result[1])
    scene::fail(node, node.name + " must be [low, high], but " + items[0]->text + " is above " + items[1]->text);
  return result;
}

std::array<double, 2> length_limits(const Node& node) {
  (void)scene::positive(*scene::list_of(2, node)[0]);
  return limits(node);
}

int direction(const Node& node) {
  const std::int64_t value = scene::integer(node);
  if (value != 1 && value != -1) scene::fail(node, node.name + " must be 1 or -1, not " + node.text);
  return static_cast<int>(value);
}

bool truth(const Node& node) {
  return scene::choice(node, {"false", "true"}) == 1;
}

char axis(const Node& node) {
  const std::string& letter = scene::text(node);
  if (letter == "E") scene::fail(node, node.name + " must not be E: the board moves its extruder by rules of its own");
  if (letter.size() != 1 || axis_letters.find(letter) == std::string::npos)
    scene::fail(node, node.name + " must be one of the letters X, Y, Z, A, B, C, U, V, W, not " + excerpt(letter));
  return letter[0];
}

const scene::Keys motor_keys{"actuator",  "axis",        "steps_per_revolution", "steps_per_mm",
                             "direction", "backlash_mm", "max_speed_mm_per_s",   "max_acceleration_mm_per_s2"};

scene::Keys with_motor_keys(std::initializer_list<const char*> more) {
  scene::Keys keys = motor_keys;
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

/// turn: the key of the motion per revolution of the motor.
void read_motor(const Map& map, const char* turn, scene::Names& actuators, scene::Names& axes, MotorSpec& motor) {
  motor.actuator = actuators.add(map.at("actuator"));
  motor.axis = axis(map.at("axis"));
  (void)axes.add(map.at("axis"));
  motor.steps_per_revolution = optional<double>(map, "steps_per_revolution", scene::positive);
  if (motor.steps_per_revolution && map.find(turn) == nullptr)
    scene::fail(map.at("steps_per_revolution"), std::string("steps_per_revolution needs ") + turn + " beside it");
  motor.steps_per_mm = optional<double>(map, "steps_per_mm", scene::positive);
  motor.direction = optional<int>(map, "direction", direction);
  motor.backlash_mm = optional<double>(map, "backlash_mm", scene::not_negative);
  motor.max_speed_mm_per_s = optional<double>(map, "max_speed_mm_per_s", scene::positive);
  motor.max_acceleration_mm_per_s2 = optional<double>(map, "max_acceleration_mm_per_s2", scene::positive);
}

TendonSpec read_tendon(const Node& node, scene::Names& actuators, scene::Names& axes) {
  const Map map(node, with_motor_keys({"rest_length_mm", "drum_radius_mm", "slack_offset_mm", "length_limits_mm"}));
  TendonSpec tendon;
  tendon.origin = node.origin;
  read_motor(map, "drum_radius_mm", actuators, axes, tendon);
  tendon.rest_length_mm = optional<double>(map, "rest_length_mm", scene::positive);
  tendon.drum_radius_mm = optional<double>(map, "drum_radius_mm", scene::positive);
  tendon.slack_offset_mm = optional<double>(map, "slack_offset_mm", scene::not_negative);
  tendon.length_limits_mm = optional<std::array<double, 2>>(map, "length_limits_mm", length_limits);
  return tendon;
}

/// By one of two keys.
double ml_per_mm(const Map& map, const Node& node) {
  const Node *area = map.find("plunger_area_mm2"), *volume = map.find("mL_per_mm");
  if ((area == nullptr) == (volume == nullptr))
    scene::fail(node, node.name + (area != nullptr ? " has both 'plunger_area_mm2' and 'mL_per_mm': give one of them"
                                                   : " needs key 'plunger_area_mm2' or 'mL_per_mm'"));
  constexpr double ml_per_mm3 = 1e-3;
  return area != nullptr ? scene::positive(*area) * ml_per_mm3 : scene::positive(*volume);
}

SyringeSpec read_syringe(const Node& node, scene::Names& actuators, scene::Names& axes) {
  const Map map(node, with_motor_keys({"chamber_mL", "syringe_mL", "dead_volume_mL", "plunger_area_mm2", "mL_per_mm",
                                       "lead_mm", "travel_limits_mm", "limits_kPa"}));
  SyringeSpec syringe;
  syringe.origin = node.origin;
  read_motor(map, "lead_mm", actuators, axes, syringe);
  syringe.chamber_mL = optional<double>(map, "chamber_mL", scene::positive);
  syringe.syringe_mL = scene::positive(map.at("syringe_mL"));
  syringe.dead_volume_mL = optional<double>(map, "dead_volume_mL", scene::not_negative);
  syringe.mL_per_mm = ml_per_mm(map, node);
  syringe.lead_mm = optional<double>(map, "lead_mm", scene::positive);
  syringe.travel_limits_mm = optional<std::array<double, 2>>(map, "travel_limits_mm", limits);
  syringe.limits_kpa = optional<std::array<double, 2>>(map, "limits_kPa", limits);
  return syringe;
}

ChamberSpec read_chamber(const Node& node, scene::Names& actuators, scene::Names& channels) {
  const Map map(node, {"actuator", "channel", "limits_kPa"});
  ChamberSpec chamber;
  chamber.origin = node.origin;
  chamber.actuator = actuators.add(map.at("actuator"));
  if (const Node* channel = map.find("channel")) chamber.channel = channels.add_label(*channel);
  chamber.limits_kpa = optional<std::array<double, 2>>(map, "limits_kPa", limits);
  return chamber;
}

/// Which length a feed rate is of: the board's own settings decide it where both families move.
void check_families(const Node& node, const HardwareSpec& spec) {
  char first = 0, second = 0;
  const auto look = [&](const MotorSpec& motor) {
    if (std::string("ABC").find(motor.axis) != std::string::npos) first = motor.axis;
    if (std::string("UVW").find(motor.axis) != std::string::npos) second = motor.axis;
  };
  for (const TendonSpec& tendon : spec.tendons) look(tendon);
  for (const SyringeSpec& syringe : spec.syringes) look(syringe);
  if (first && second)
    scene::fail(node, std::string("axes ") + first + " and " + second +
                          ": beside X, Y, Z use A, B, C or U, V, W, not both; how fast a board moves both together "
                          "depends on how it was built");
}

}  // namespace

HardwareSpec read_hardware(const std::filesystem::path& path) {
  const auto root = scene::parse_yaml(read_file(path), path.string());
  scene::check_version(*root, "softkin_hardware", "hardware",
                       "a hardware file must be a map that begins with 'softkin_hardware: 1'",
                       "a hardware file needs key 'softkin_hardware', its version: 'softkin_hardware: 1'");
  const Map map(*root, {"softkin_hardware", "board", "atmosphere_kPa", "tendons", "syringes", "chambers"});
  HardwareSpec spec;
  spec.file = path.string();
  scene::Names actuators, axes, channels;
  if (const Node* node = map.find("board")) {
    const Map board(*node, {"configure", "approach_speed_mm_per_s"});
    spec.configure = optional<bool>(board, "configure", truth);
    spec.approach_speed_mm_per_s = optional<double>(board, "approach_speed_mm_per_s", scene::positive);
  }
  if (const Node* node = map.find("tendons")) {
    for (const auto& item : scene::list(*node)) spec.tendons.push_back(read_tendon(*item, actuators, axes));
    check_families(*node, spec);
  }
  if (const Node* node = map.find("syringes")) {
    for (const auto& item : scene::list(*node)) spec.syringes.push_back(read_syringe(*item, actuators, axes));
    check_families(*node, spec);
  }
  spec.atmosphere_kPa = optional<double>(map, "atmosphere_kPa", scene::positive);
  if (const Node* node = map.find("chambers"))
    for (const auto& item : scene::list(*node)) spec.chambers.push_back(read_chamber(*item, actuators, channels));
  return spec;
}

}  // namespace softkin
