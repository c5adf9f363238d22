#pragma once

#include <optional>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

/// What an option such as --set asks for, per actuator.
using Settings = std::vector<std::optional<double>>;

/// ACTUATOR=VALUE, of the option of that name. Throws InvalidInput naming it: an unknown actuator, a value that is
/// none, has another unit or is outside the range, an actuator that is named twice.
[[nodiscard]] Settings read_settings(const Model& model, const std::string& option,
                                     const std::vector<std::string>& settings);

/// The actuation with what the settings change in it.
[[nodiscard]] Actuation with_settings(Actuation actuation, const Settings& settings);

[[nodiscard]] std::optional<Index> find_actuator(const Model& model, const std::string& name);
/// "no actuator 'ari'; did you mean 'air'?"
[[nodiscard]] std::string unknown_actuator(const Model& model, const std::string& name);

}  // namespace softkin::cli
