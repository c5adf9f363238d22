#include <algorithm>
#include <softkin/io/wrapped_lines.hpp>

namespace softkin {

std::vector<std::string> wrapped_lines(const std::string& text, std::size_t max_lines,
                                       const std::function<bool(const std::string& line)>& fits) {
  const auto begins_character = [&](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xC0) != 0x80; };
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (lines.size() + 1 < max_lines && !fits(text.substr(begin))) {
    std::size_t at_space = begin, anywhere = begin;  // ends of the longest lines that fit
    for (std::size_t end = begin + 1; end < text.size(); ++end) {
      if (!begins_character(end)) continue;
      if (!fits(text.substr(begin, end - begin))) break;
      anywhere = end;
      if (text[end] == ' ') at_space = end;
    }
    const std::size_t end = at_space > begin ? at_space : anywhere;
    if (end == begin) break;  // not even a character
    lines.push_back(text.substr(begin, end - begin));
    begin = std::min(text.find_first_not_of(' ', end), text.size());
  }
  lines.push_back(text.substr(begin));
  return lines;
}

}  // namespace softkin
