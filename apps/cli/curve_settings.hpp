#pragma once

#include <optional>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

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

/// "; or a pressure by its curve, such as 50kPa (gauge), 150kPa_abs or 50kPa:unloading"; "" without a curve.
[[nodiscard]] std::string curve_hint(const Actuator& actuator);

/// Where to get a curve, for a pressure or voltage given to an actuator that has none; else "".
[[nodiscard]] std::string missing_curve(const Actuator& actuator, const std::string& text);

/// Ends of the names of a path's columns that hold inputs: "kPa" and "kPa_abs", or "kV"; none without a curve.
[[nodiscard]] std::vector<std::string> curve_units(const Actuator& actuator);

/// What the settings ACTUATOR=VALUE asked of curves, a line each: "air: 50 kPa (gauge), loading branch of F: ratio
/// 1.31 +- 0.01 [-]".
[[nodiscard]] std::string curve_remarks(const Model& model, const std::vector<std::string>& settings);

/// "curve_pressure_kPa" or "curve_voltage_kV".
[[nodiscard]] const char* curve_key(const ActuatorCurve& curve);

/// "; curve F: 0 to 140 kPa (gauge), loading branch".
[[nodiscard]] std::string curve_text(const Actuator& actuator);

}  // namespace softkin::cli
