#pragma once

#include <cstddef>
#include <softkin/core/types.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace softkin {

/// The shortest decimal text of a number at so many significant digits; never "-0".
[[nodiscard]] std::string number(double value, int digits = 6);

/// The shortest decimal text that reads back as the number.
[[nodiscard]] std::string exact(double value);

/// A number with so many digits behind the point; never "-0.000".
[[nodiscard]] std::string decimal(double value, int decimals);

/// "(x, y, z)" to so many digits; rounding: over the largest coordinate, below which a coordinate counts as 0.
[[nodiscard]] std::string point_text(const Vec3& point, int digits = 6, double rounding = 1e-12);

/// "45 s", "3 min 20 s", "2 h 5 min".
[[nodiscard]] std::string duration(double seconds);

/// "1 prism", "2 prisms"; many: where the plural is not one + "s".
[[nodiscard]] std::string counted(std::size_t count, const std::string& one, const std::string& many = "");

/// "0 to 3, 7"; numbers ascend.
[[nodiscard]] std::string list_text(const std::vector<std::size_t>& numbers);

/// Characters, not bytes: those that continue a UTF-8 character do not count.
[[nodiscard]] std::size_t characters(const std::string& text);

/// Bytes of the UTF-8 character that text begins with; 0: malformed (RFC 3629). text: not empty
[[nodiscard]] std::size_t character_length(std::string_view text);

/// The text on one line and safe to print: control characters and bytes that are no UTF-8 as '?'.
[[nodiscard]] std::string on_one_line(std::string_view text);

/// Of the coordinates 0, 1, 2.
inline constexpr const char* axis_names[] = {"x", "y", "z"};

}  // namespace softkin
