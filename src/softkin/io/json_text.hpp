#pragma once

#include <nlohmann/json_fwd.hpp>
#include <softkin/core/types.hpp>
#include <string>

namespace softkin {

using Json = nlohmann::ordered_json;

/// JSON as users see it, indented; text that is no UTF-8 is replaced.
[[nodiscard]] std::string json_text(const Json& json);

/// [x, y, z]
[[nodiscard]] Json json_of(const Vec3& point);

}  // namespace softkin
