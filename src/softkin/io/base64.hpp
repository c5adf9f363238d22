#pragma once

#include <bit>
#include <cstddef>
#include <string>
#include <string_view>

namespace softkin {

/// Bytes as text, RFC 4648 with padding.
[[nodiscard]] std::string to_base64(std::string_view bytes);

static_assert(std::endian::native == std::endian::little, "numbers are written little-endian");

/// So many numbers, as they lie in memory: little-endian.
template <class Number>
[[nodiscard]] std::string to_base64(const Number* numbers, std::size_t count) {
  return to_base64({reinterpret_cast<const char*>(numbers), count * sizeof(Number)});
}

/// Decodes base64. throws InvalidInput on other text
[[nodiscard]] std::string from_base64(std::string_view text);

}  // namespace softkin
