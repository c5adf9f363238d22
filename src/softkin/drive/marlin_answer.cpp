#include <charconv>
#include <cmath>
#include <softkin/drive/marlin_answer.hpp>

namespace softkin::drive {

namespace {

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// The whole text as a line's number.
std::optional<long> number_in(std::string_view text) {
  text = without_blanks(text);
  long value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || failure != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

bool has(std::string_view line, std::string_view part) {
  return line.find(part) != std::string_view::npos;
}

/// "X:1.00 Y:2.00"; nothing where a coordinate is not whole: half a report is none.
std::optional<std::vector<std::pair<char, double>>> coordinates(std::string_view text) {
  std::vector<std::pair<char, double>> position;
  while (!(text = without_blanks(text)).empty()) {
    if (text.size() < 3 || text[1] != ':') return std::nullopt;
    double value = 0;
    const auto [end, failure] = std::from_chars(text.data() + 2, text.data() + text.size(), value);
    if (failure != std::errc() || !std::isfinite(value) || (end != text.data() + text.size() && *end != ' '))
      return std::nullopt;
    position.emplace_back(text[0], value);
    text.remove_prefix(end - text.data());
  }
  return position;
}

MarlinAnswer parse_ok(std::string_view line) {
  MarlinAnswer answer{MarlinAnswer::Kind::ok, {}, {}};
  if (line.starts_with("ok X:")) {
    if (auto position = coordinates(line.substr(3, line.find(" Count") - 3))) answer.position = std::move(*position);
  } else if (const std::size_t at = line.find(" N"); at != std::string_view::npos) {
    answer.number = number_in(line.substr(at + 2, line.find(' ', at + 2) - at - 2));
  }
  return answer;
}

/// One damaged byte leaves a mark of these messages whole, so that noise is not taken for a fault of the board.
MarlinAnswer parse_error(std::string_view line) {
  const bool of_a_line = has(line, "Last Line") || has(line, "hecksum") || has(line, "Line Number");
  if (!of_a_line) return {has(line, "halted") ? MarlinAnswer::Kind::halted : MarlinAnswer::Kind::error, {}, {}};
  MarlinAnswer answer{MarlinAnswer::Kind::line_error, {}, {}};
  if (const std::size_t at = line.rfind("Last Line: "); at != std::string_view::npos)
    answer.number = number_in(line.substr(at + 11));
  return answer;
}

std::optional<MarlinAnswer> parse_position(std::string_view line) {
  const std::size_t count = line.find(" Count");
  if (count == std::string_view::npos) return std::nullopt;
  auto position = coordinates(line.substr(0, count));
  if (!position) return std::nullopt;
  return MarlinAnswer{MarlinAnswer::Kind::position, {}, std::move(*position)};
}

}  // namespace

MarlinAnswer parse_answer(std::string_view line) {
  using Kind = MarlinAnswer::Kind;
  line = without_blanks(line);
  if (line == "ok" || line.starts_with("ok ")) return parse_ok(line);
  for (const std::string_view begin : {"Resend:", "rs "})
    if (line.starts_with(begin)) {
      const auto number = number_in(line.substr(begin.size()));
      return number ? MarlinAnswer{Kind::resend, number, {}} : MarlinAnswer{};
    }
  if (line == "start" || line.starts_with("echo:Marlin ") || line.starts_with("Marlin "))
    return {Kind::started, {}, {}};
  if (line.starts_with("Error:")) return parse_error(line);
  if (line.starts_with("!!")) return {Kind::halted, {}, {}};
  if (has(line, "busy:")) return {Kind::busy, {}, {}};
  if (line.starts_with("X:"))
    if (auto answer = parse_position(line)) return *answer;
  return {};
}

}  // namespace softkin::drive
