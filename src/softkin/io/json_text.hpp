#pragma once

#include <nlohmann/json_fwd.hpp>
#include <softkin/core/types.hpp>
#include <string>
#include <string_view>

namespace softkin {

using Json = nlohmann::ordered_json;

/// Parses the JSON of a text that a user brings. Null where it is nested deeper than 100 levels, which softkin never
/// writes: copying or printing such JSON would exhaust the stack. Throws Json::exception where it is no JSON.
[[nodiscard]] Json parse_json(std::string_view text);

/// JSON as users see it, indented; text that is no UTF-8 is replaced.
[[nodiscard]] std::string json_text(const Json& json);

/// [x, y, z]
[[nodiscard]] Json json_of(const Vec3& point);

}  // namespace softkin
