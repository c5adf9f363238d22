#include <nlohmann/json.hpp>
#include <softkin/io/json_text.hpp>

namespace softkin {

namespace {

constexpr int max_levels = 100;

bool is_deep(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (quoted && c == '\\') ++i;
    if (quoted) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > max_levels) return true;
  }
  return false;
}

}  // namespace

Json parse_json(std::string_view text) {
  return is_deep(text) ? Json() : Json::parse(text);
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

Json json_of(const Vec3& point) {
  return {point[0], point[1], point[2]};
}

}  // namespace softkin
