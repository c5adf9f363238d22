#include <algorithm>
#include <cstdint>
#include <softkin/io/plain_text.hpp>

namespace softkin {

namespace {

constexpr std::size_t longest_excerpt = 60;  // bytes

bool is_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

/// Bytes of the UTF-8 character that text begins with; 0: malformed (RFC 3629).
std::size_t character_length(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || length > text.size()) return 0;
  std::uint32_t code = lead & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (!is_continuation(text[i])) return 0;
    code = (code << 6) | (static_cast<unsigned char>(text[i]) & 0x3Fu);
  }
  const std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  return code < least[length] || surrogate || code > 0x10FFFF ? 0 : length;
}

bool is_control(char c) {
  return (static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7F;
}

}  // namespace

std::size_t find_unprintable(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(text.substr(i));
    if (length == 0 || is_control(text[i])) return i;
    i += length;
  }
  return std::string_view::npos;
}

std::string excerpt(std::string_view text) {
  std::size_t end = std::min(text.size(), longest_excerpt);
  while (end > 0 && end < text.size() && is_continuation(text[end])) --end;
  std::string shown(text.substr(0, end));
  const bool printable = find_unprintable(shown) == std::string::npos;
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 0x20 || (!printable && (is_control(c) || static_cast<signed char>(c) < 0)))
      c = '?';
  return "'" + shown + (end < text.size() ? "..." : "") + "'";
}

std::string printable(const std::string& name) {
  const bool plain = find_unprintable(name) == std::string::npos && name.find_first_of("\t\r\n") == std::string::npos;
  return plain ? name : excerpt(name);
}

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += c;
  }
  return escaped;
}

}  // namespace softkin
