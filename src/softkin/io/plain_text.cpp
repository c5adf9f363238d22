#include <algorithm>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>

namespace softkin {

namespace {

constexpr std::size_t longest_excerpt = 60;  // bytes

bool is_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
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
