#include "reading_lines.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/model/names.hpp>

namespace softkin::view {

namespace {

constexpr const char* time_key = "t_s";

Json object_of_line(std::string_view text) {
  if (text.size() > longest_line) throw Refusal("a line is at most " + std::to_string(longest_line) + " bytes long");
  try {
    Json json = parse_json(text);
    if (!json.is_object()) throw Refusal("a line is a JSON object");
    return json;
  } catch (const Json::exception&) {
    throw Refusal("this is no JSON with numbers that a computer has");
  }
}

double finite_at(const std::string& key, const Json& value) {
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (!std::isfinite(number)) throw Refusal(key + " must be a finite number");
  return number;
}

/// Reads one line, key by key.
class LineReader {
 public:
  explicit LineReader(const LineColumns& columns) : columns_(columns), commanded_(columns.model.actuators.size()) {
    line_.commands = columns.model.rest_actuation();
    line_.values = Eigen::VectorXd::Constant(columns.readings.size(), std::nan(""));
  }

  void take(const std::string& key, const Json& value) {
    if (key == time_key) return take_time(value);
    if (const auto reading = columns_.by_name.find(key); reading != columns_.by_name.end())
      return take_reading(key, reading->second, value);
    const auto actuator = actuator_of_column(columns_.model, key);
    if (!actuator) throw Refusal("there is no column " + excerpt(key) + suggest_name(key, names()));
    take_command(key, *actuator, value);
  }

  [[nodiscard]] ReadingsRequest line(std::optional<double> after) {
    if (columns_.timed && !line_.time_s) throw Refusal("t_s is missing: estimates fade in time");
    if (after && line_.time_s && !(*line_.time_s > *after)) throw Refusal("t_s must increase from line to line");
    if (line_.values.array().isNaN().all()) throw Refusal("every reading is missing");
    return std::move(line_);
  }

 private:
  void take_time(const Json& value) {
    if (!value.is_null()) line_.time_s = finite_at(time_key, value);
  }

  void take_reading(const std::string& key, Index column, const Json& value) {
    if (value.is_null()) return;
    const double read = finite_at(key, value);
    if (std::abs(read) > largest_reading) throw Refusal(key + " is larger than " + number(largest_reading));
    line_.values[column] = read;
  }

  void take_command(const std::string& key, Index actuator, const Json& value) {
    const std::size_t at = actuator;
    const Actuator& of = columns_.model.actuators[at];
    if (std::find(columns_.reported.begin(), columns_.reported.end(), actuator) != columns_.reported.end())
      throw Refusal(key + " is to be estimated: leave it out");
    if (key != of.name && key != command_column(of))
      throw Refusal(key + " is no command of '" + of.name + "': its column is '" + command_column(of) + "'");
    if (commanded_[at]) throw Refusal(key + ": another key commands the same");
    if (value.is_null()) throw Refusal(key + " is a command: leave it out where it rests, or let it be estimated");
    commanded_[at] = true;
    const double command = finite_at(key, value);
    check_command(of, command);
    line_.commands[actuator] = command;
  }

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names{time_key};
    for (const auto& [name, column] : columns_.by_name) names.push_back(name);
    for (const Actuator& actuator : columns_.model.actuators) names.push_back(command_column(actuator));
    return names;
  }

  const LineColumns& columns_;
  std::vector<bool> commanded_;
  ReadingsRequest line_;
};

}  // namespace

LineColumns::LineColumns(const Model& of, std::vector<PoseColumn> columns, std::vector<Index> are_reported,
                         bool is_timed)
    : model(of), readings(std::move(columns)), reported(std::move(are_reported)), timed(is_timed) {
  for (std::size_t r = 0; r < readings.size(); ++r) {
    by_name.emplace(readings[r].name, static_cast<Index>(r));
    // as tables have it: x_mm of the only marker
    if (readings[r].marker >= 0 && model.markers.size() == 1)
      by_name.emplace(std::string(axis_names[readings[r].axis]) + "_mm", static_cast<Index>(r));
  }
}

std::string read_token_line(std::string_view text) {
  const Json json = object_of_line(text);
  const auto token = json.find("token");
  if (token == json.end() || !token->is_string() || json.size() != 1)
    throw Refusal(R"(the first line must be {"token": "..."} with the token that softkin printed)");
  return token->get<std::string>();
}

ReadingsRequest read_reading_line(std::string_view text, const LineColumns& columns, std::optional<double> after) {
  const Json json = object_of_line(text);
  LineReader reader(columns);
  for (const auto& [key, value] : json.items()) reader.take(key, value);
  return reader.line(after);
}

std::string error_line(const std::string& why) {
  return Json{{"error", why}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace softkin::view
