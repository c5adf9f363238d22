#pragma once

#include <softkin/model/model.hpp>
#include <string>

namespace softkin::cli {

/// "pneumatic", "cable" or "dea".
[[nodiscard]] const char* kind_name(const Actuator& actuator);
/// What the user commands: "volume", "length", "area" (over that at rest), "pressure" or "tension".
[[nodiscard]] const char* control_name(const Actuator& actuator);
/// "ratio", "pressure" or "tension".
[[nodiscard]] const char* command_name(const Actuator& actuator);
/// The unit of what the user commands, bare: "", "kPa" or "N"; as the table has it: "[-]", "[kPa]" or "[N]".
[[nodiscard]] std::string command_unit(const Actuator& actuator);
[[nodiscard]] std::string bracketed_unit(const Actuator& actuator);

/// What a physical robot answers with: "pressure_kPa" (pneumatic), "tension_N" (cable), or "" (dea).
[[nodiscard]] std::string multiplier_key(const Actuator& actuator);

/// "1.62" or "50 kPa".
[[nodiscard]] std::string command_text(const Actuator& actuator, double value, int digits = 6);
/// "its range, 1 to 2 [-]" or "its range, 0 to 80 kPa".
[[nodiscard]] std::string range_text(const Actuator& actuator);

/// Reads a value as the user gives it: a ratio without unit, a load with or without its own, or the pressure or voltage
/// of the actuator's curve with its unit, which becomes a ratio; false where it is none of these. Throws InvalidInput
/// outside the curve.
[[nodiscard]] bool parse_command(const Actuator& actuator, const std::string& text, double& value);
/// "the pressure must be a finite number in kPa, such as 5 or 5kPa".
[[nodiscard]] std::string expected_command(const Actuator& actuator);

[[nodiscard]] const char* law_name(Law law);
[[nodiscard]] const char* formulation_name(Formulation formulation);

}  // namespace softkin::cli
