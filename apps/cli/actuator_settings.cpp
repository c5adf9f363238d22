#include "actuator_settings.hpp"

#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>

#include "curve_settings.hpp"
#include "fk_units.hpp"

namespace softkin::cli {

std::string unknown_actuator(const Model& model, const std::string& name) {
  std::vector<std::string> names;
  for (const Actuator& actuator : model.actuators) names.push_back(actuator.name);
  return "no actuator " + excerpt(name) + (names.empty() ? "; the scene has none" : suggest_name(name, names));
}

std::optional<Index> find_actuator(const Model& model, const std::string& name) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (model.actuators[a].name == name) return static_cast<Index>(a);
  return std::nullopt;
}

Settings read_settings(const Model& model, const std::string& option, const std::vector<std::string>& settings) {
  Settings values(model.actuators.size());
  for (const std::string& setting : settings) {
    const auto refuse = [&](const std::string& why) {
      throw InvalidInput(option + " " + excerpt(setting) + ": " + why);
    };
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) refuse("expected ACTUATOR=VALUE, for example " + option + " air=1.5");
    const std::string name = setting.substr(0, equals), text = setting.substr(equals + 1);
    const std::optional<Index> a = find_actuator(model, name);
    if (!a) refuse(unknown_actuator(model, name));
    const Actuator& actuator = model.actuators[static_cast<std::size_t>(*a)];
    double value = 0;
    if (!parse_command(actuator, text, value))
      refuse(expected_command(actuator) + ", not " + excerpt(text) + missing_curve(actuator, text));
    if (!(value >= actuator.low && value <= actuator.high))
      refuse(std::string("the ") + command_name(actuator) + " is outside " + range_text(actuator));
    if (values[static_cast<std::size_t>(*a)]) refuse("actuator '" + name + "' is set twice");
    values[static_cast<std::size_t>(*a)] = value;
  }
  return values;
}

Actuation with_settings(Actuation actuation, const Settings& settings) {
  for (std::size_t a = 0; a < settings.size(); ++a)
    if (settings[a]) actuation[static_cast<Index>(a)] = *settings[a];
  return actuation;
}

}  // namespace softkin::cli
