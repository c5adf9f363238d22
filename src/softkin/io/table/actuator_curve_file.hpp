#pragma once

#include <filesystem>
#include <softkin/model/actuator_curve.hpp>
#include <string>

namespace softkin {

/// Reads a curve file, YAML (docs/pressure.md).
/// throws  InvalidInput naming file and line: unknown keys or units, points that do not ascend, numbers out of range
[[nodiscard]] ActuatorCurve read_actuator_curve(const std::filesystem::path& path);

/// The text of a curve file. comments: lines at its head, how it was made.
[[nodiscard]] std::string actuator_curve_text(const ActuatorCurve& curve, const std::string& comments);

}  // namespace softkin
