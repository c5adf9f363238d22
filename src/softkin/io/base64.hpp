#pragma once

#include <string>
#include <string_view>

namespace softkin {

/// Bytes as text, RFC 4648 with padding.
[[nodiscard]] std::string to_base64(std::string_view bytes);

/// The other way round. throws InvalidInput on other text
[[nodiscard]] std::string from_base64(std::string_view text);

}  // namespace softkin
