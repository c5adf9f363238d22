#include <nlohmann/json.hpp>
#include <softkin/io/json_text.hpp>

namespace softkin {

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

Json json_of(const Vec3& point) {
  return {point[0], point[1], point[2]};
}

}  // namespace softkin
