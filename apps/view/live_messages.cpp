#include "live_messages.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/model/names.hpp>

namespace softkin::view {

namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

constexpr RequestId largest_id = RequestId{1} << 53;  // beyond it a page cannot count

/// What a page wrote, as it may be repeated to it.
std::string repeated(std::string_view text) {
  constexpr std::size_t most = 40;
  return "'" + on_one_line(text.substr(0, most)) + (text.size() > most ? "..." : "") + "'";
}

/// One message, its keys looked up with words for what is wrong about them.
class Message {
 public:
  explicit Message(const Json& json) : json_(json) {
    const Json* id = find("id");
    if (id != nullptr && id->is_number_unsigned() && *id >= 1u && *id <= largest_id) id_ = id->get<RequestId>();
  }

  [[noreturn]] void refuse(const std::string& why) const { throw Refusal(why, id_); }

  [[nodiscard]] RequestId id() const {
    (void)at("id");
    if (!id_) refuse("id must be an integer from 1 to 2^53");
    return *id_;
  }

  [[nodiscard]] std::string text(const char* key) const {
    const Json& value = at(key);
    if (!value.is_string()) refuse(std::string(key) + " must be text");
    return value.get<std::string>();
  }

  /// A list of so many finite numbers. count: "3 numbers", for people
  [[nodiscard]] Eigen::VectorXd numbers(const char* key, std::size_t size, const std::string& count) const {
    const Json& list = at(key);
    if (!list.is_array() || list.size() != size) refuse(std::string(key) + " must be a list of " + count);
    Eigen::VectorXd numbers(size);
    for (std::size_t i = 0; i < size; ++i) {
      if (list[i].is_number()) numbers[i] = list[i].get<double>();
      if (!list[i].is_number() || !std::isfinite(numbers[i]))
        refuse(std::string(key) + " must be a list of finite numbers");
    }
    return numbers;
  }

  /// So many readings; null: not read, NaN.
  [[nodiscard]] Eigen::VectorXd readings(std::size_t size) const {
    const Json& list = at("values");
    if (!list.is_array() || list.size() != size)
      refuse("values must be a list of " + counted(size, "number") + " or null, one per column");
    Eigen::VectorXd values = Eigen::VectorXd::Constant(size, std::nan(""));
    for (std::size_t i = 0; i < size; ++i) {
      if (list[i].is_null()) continue;
      if (!list[i].is_number() || !(std::abs(list[i].get<double>()) <= largest_reading))
        refuse("values must be null or numbers up to " + number(largest_reading));
      values[i] = list[i].get<double>();
    }
    return values;
  }

  [[nodiscard]] std::size_t place(const char* key, std::size_t size) const {
    const Json& value = at(key);
    if (size == 0) refuse("the robot has no " + std::string(key));
    if (!value.is_number_unsigned() || value >= size)
      refuse(std::string(key) + " must be an integer from 0 to " + std::to_string(size - 1));
    return value.get<std::size_t>();
  }

 private:
  [[nodiscard]] const Json* find(const char* key) const {
    const auto at = json_.find(key);
    return at == json_.end() ? nullptr : &*at;
  }

  [[nodiscard]] const Json& at(const char* key) const {
    const Json* value = find(key);
    if (value == nullptr) refuse(std::string(key) + " is missing");
    return *value;
  }

  const Json& json_;
  std::optional<RequestId> id_;
};

Actuation commands_of(const Message& message, const Model& model) {
  const std::size_t count = model.actuators.size();
  Actuation commands = message.numbers("commands", count, counted(count, "number") + ", one per actuator");
  for (std::size_t a = 0; a < count; ++a) check_command(model.actuators[a], commands[a], message.id());
  return commands;
}

CommandRequest command_of(const Message& message, const Model& model) {
  const RequestId id = message.id();
  return {id, commands_of(message, model)};
}

ReadingsRequest readings_of(const Message& message, const Model& model, std::size_t count) {
  ReadingsRequest request{message.id(), {}, {}};
  request.commands = commands_of(message, model);
  request.values = message.readings(count);
  return request;
}

TargetRequest target_of(const Message& message, const Model& model) {
  TargetRequest request{message.id()};
  request.marker = message.place("marker", model.markers.size());
  request.at = message.numbers("at", 3, "3 numbers");
  const double farthest = farthest_target_mm(model);
  if (request.at.cwiseAbs().maxCoeff() > farthest)
    message.refuse("at is farther away than " + number(farthest, 3) + " mm");
  return request;
}

ClientMessage message_of(const Json& json, const Model& model, std::size_t readings) {
  if (!json.is_object()) throw Refusal("a message is a JSON object");
  const Message message(json);
  const std::string type = message.text("type");
  if (type == "hello") return Hello{message.text("secret")};
  const bool moves = type == "command" || type == "target";
  if (type == "readings" && readings == 0)
    message.refuse("nothing is estimated here: start softkin view with --unknown");
  if (moves && readings > 0) message.refuse("forces are estimated here: send readings");
  if (type == "command") return command_of(message, model);
  if (type == "target") return target_of(message, model);
  if (type == "readings") return readings_of(message, model, readings);
  if (type == "take") return Take{};
  if (type == "release") return Release{};
  message.refuse("there is no message of type " + repeated(type));
}

Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json points_of(const std::vector<Vec3>& points) {
  Json list = Json::array();
  for (const Vec3& point : points) {
    Json each = Json::array();
    for (int axis = 0; axis < 3; ++axis) each.push_back(finite_or_null(point[axis]));
    list.push_back(std::move(each));
  }
  return list;
}

Json json_of(const TargetAnswer& target) {
  return {{"marker", target.marker},
          {"at", points_of({target.at})[0]},
          {"error_mm", finite_or_null(target.error_mm)},
          {"reached", target.reached},
          {"why", target.why}};
}

/// On one line, without its end.
std::string message_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string head_text(const LiveShape& shape, RequestId id) {
  Json commands = Json::array(), loads = Json::array(), measures = Json::array();
  for (const double command : shape.commands) commands.push_back(finite_or_null(command));
  for (const auto& load : shape.loads) loads.push_back(load ? finite_or_null(*load) : Json());
  for (const auto& measure : shape.measures) measures.push_back(measure ? finite_or_null(*measure) : Json());
  std::string text = message_text({{"id", id},
                                   {"status", shape.status},
                                   {"remark", shape.remark},
                                   {"commands", std::move(commands)},
                                   {"loads", std::move(loads)},
                                   {"measures", std::move(measures)},
                                   {"markers", points_of(shape.markers)},
                                   {"iterations", shape.iterations},
                                   {"seconds", finite_or_null(shape.seconds)},
                                   {"target", shape.target ? json_of(*shape.target) : Json()},
                                   {"arrays", shape.arrays},
                                   {"vertices", shape.vertices}});
  if (!shape.estimate.empty()) text.replace(text.size() - 1, 1, ",\"estimate\":" + shape.estimate + "}");
  return text;
}

}  // namespace

double farthest_target_mm(const Model& model) {
  const double farthest = model.rest.size() > 0 ? model.rest.cwiseAbs().maxCoeff() : 0;
  return farthest + 100 * model.diagonal_mm;
}

void check_command(const Actuator& actuator, double value, std::optional<RequestId> id) {
  if (value < actuator.low || value > actuator.high)
    throw Refusal(actuator.name + ": " + command_text(actuator, value) + " is outside " + range_text(actuator), id);
}

std::optional<RequestId> id_of(const ClientMessage& message) {
  if (const auto* command = std::get_if<CommandRequest>(&message)) return command->id;
  if (const auto* target = std::get_if<TargetRequest>(&message)) return target->id;
  if (const auto* readings = std::get_if<ReadingsRequest>(&message)) return readings->id;
  return std::nullopt;
}

ClientMessage read_client_message(std::string_view text, const Model& model, std::size_t readings) {
  if (const std::size_t longest = longest_message_of(readings); text.size() > longest)
    throw Refusal("a message is at most " + std::to_string(longest) + " bytes long");
  try {
    return message_of(parse_json(text), model, readings);
  } catch (const Json::exception&) {
    throw Refusal("this is no JSON with numbers that a computer has");
  }
}

std::string frame_bytes(const LiveShape& shape, RequestId id) {
  std::string head = head_text(shape, id);
  head.resize((head.size() + 3) / 4 * 4, ' ');
  const auto length = static_cast<std::uint32_t>(head.size());
  std::string bytes(sizeof length + head.size() + shape.numbers.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  std::memcpy(bytes.data() + sizeof length, head.data(), head.size());
  if (!shape.numbers.empty())
    std::memcpy(bytes.data() + sizeof length + head.size(), shape.numbers.data(), shape.numbers.size() * sizeof(float));
  return bytes;
}

std::string state_text(const LiveState& state) {
  return message_text({{"type", "state"},
                       {"model", state.model},
                       {"secret", state.secret},
                       {"control", state.control},
                       {"free", state.free},
                       {"streamed", state.streamed},
                       {"watchers", state.watchers}});
}

std::string refused_text(const Refusal& refusal) {
  return message_text(
      {{"type", "refused"}, {"id", refusal.id() ? Json(*refusal.id()) : Json()}, {"why", refusal.what()}});
}

std::string map_text(std::string_view map) {
  return R"({"type":"map","map":)" + std::string(map) + "}";
}

bool same_secret(std::string_view given, std::string_view secret) {
  unsigned differs = given.size() == secret.size() ? 0 : 1;
  for (std::size_t i = 0; i < secret.size(); ++i) {
    const char c = i < given.size() ? given[i] : '\0';
    differs |= static_cast<unsigned char>(c ^ secret[i]);
  }
  return differs == 0;
}

}  // namespace softkin::view
