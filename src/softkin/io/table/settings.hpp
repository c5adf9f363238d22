#pragma once

#include <optional>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin {

/// An input of an actuator's curve as the user gives it.
struct CurveSetting {
  double input = 0;  // gauge pressure [kPa] or voltage [kV]
  Branch branch = Branch::loading;
};

/// "150kPa", "250kPa_abs", "4.5kV", each with ":loading" or ":unloading" where not the scene's branch is meant. None
/// where the actuator has no curve or text is no number with such a unit.
[[nodiscard]] std::optional<CurveSetting> parse_curve_setting(const Actuator& actuator, const std::string& text);

/// The ratio that the curve gives. Throws InvalidInput, naming the actuator, outside the curve or where the ratio is
/// outside the actuator's range.
[[nodiscard]] double ratio_of(const Actuator& actuator, const CurveSetting& setting);

/// Ends of the names of a path's columns that hold inputs: "kPa" and "kPa_abs", or "kV"; none without a curve.
[[nodiscard]] std::vector<std::string> curve_units(const Actuator& actuator);

/// Lists the values that the settings ACTUATOR=VALUE take from curves, a line each: "air: 50 kPa (gauge), loading
/// branch of F: ratio 1.31 +- 0.01 [-]".
[[nodiscard]] std::string curve_remarks(const Model& model, const std::vector<std::string>& settings);

/// "; curve F: 0 to 140 kPa (gauge), loading branch".
[[nodiscard]] std::string curve_text(const Actuator& actuator);

/// What an option such as --set asks for, per actuator.
using Settings = std::vector<std::optional<double>>;

/// ACTUATOR=VALUE, of the option of that name. Throws InvalidInput naming it: an unknown actuator, a value that is
/// none, has another unit or is outside the range, an actuator that is named twice.
[[nodiscard]] Settings read_settings(const Model& model, const std::string& option,
                                     const std::vector<std::string>& settings);

/// The actuation with what the settings change in it.
[[nodiscard]] Actuation with_settings(Actuation actuation, const Settings& settings);

/// The place in model.bodies of the body that the option of that name names; empty: the only one. Throws InvalidInput
/// naming the option.
[[nodiscard]] Index read_body(const Model& model, const std::string& option, const std::string& name);

/// A direction, "-x" or "1,0,-1", of the option of that name; of length 1. Throws InvalidInput naming it.
[[nodiscard]] Vec3 read_direction(const std::string& option, const std::string& text);

/// "no actuator 'ari'; did you mean 'air'?"
[[nodiscard]] std::string unknown_actuator(const Model& model, const std::string& name);

}  // namespace softkin
