#include <algorithm>
#include <cctype>
#include <limits>
#include <softkin/io/mesh/abaqus_deck.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>

namespace softkin {

namespace {

/// Capitals; one blank where there are several.
std::string normal_key(std::string_view text) {
  std::string key;
  for (const char c : upper_case(trimmed(text))) {
    const bool blank = c == ' ' || c == '\t';
    if (!blank)
      key += c;
    else if (key.back() != ' ')
      key += ' ';
  }
  return key;
}

/// At commas outside of quotes.
std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (text[i] != ',' || quoted) continue;
    parts.push_back(trimmed(text.substr(begin, i - begin)));
    begin = i + 1;
  }
  parts.push_back(trimmed(text.substr(begin)));
  return parts;
}

std::string unquoted(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return std::string(text);
}

}  // namespace

std::string upper_case(std::string_view text) {
  std::string upper(text);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return upper;
}

AbaqusDeck::AbaqusDeck(const std::filesystem::path& path) : file_(path.string()), scanner_(path) {}

/// Is there a line ahead that is neither blank nor a comment?
bool AbaqusDeck::peek() {
  while (!peeked_ && !scanner_.at_end()) {
    next_ = trimmed(scanner_.line());
    next_line_ = scanner_.here().line;
    peeked_ = !next_.starts_with("**");
  }
  return peeked_;
}

bool AbaqusDeck::next_data() {
  if (!peek() || next_.front() == '*') return false;
  peeked_ = false;
  line_ = next_line_;
  fields_ = split(next_);
  continued_ = fields_.back().empty();
  if (continued_) fields_.pop_back();
  return true;
}

bool AbaqusDeck::next_keyword() {
  while (peek() && next_.front() != '*') peeked_ = false;
  if (!peek()) return false;
  peeked_ = false;
  line_ = next_line_;
  std::string text(next_.substr(1));
  while (text.ends_with(',') && peek() && next_.front() != '*') {
    text += next_;
    peeked_ = false;
  }
  read_parameters(text);
  return true;
}

void AbaqusDeck::read_parameters(std::string_view text) {
  const std::vector<std::string_view> parts = split(text);
  keyword_ = normal_key(parts.front());
  parameters_.clear();
  repeated_.clear();
  for (std::size_t i = 1; i < parts.size(); ++i)
    if (!parts[i].empty()) add_parameter(parts[i]);
}

void AbaqusDeck::add_parameter(std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string key = normal_key(text.substr(0, equals));
  const std::string value = equals == std::string_view::npos ? "" : unquoted(trimmed(text.substr(equals + 1)));
  if (!parameters_.emplace(key, value).second) repeated_ = key;
}

std::string AbaqusDeck::value(const std::string& parameter) const {
  const auto found = parameters_.find(parameter);
  return found == parameters_.end() ? "" : found->second;
}

std::string AbaqusDeck::required(const std::string& parameter) const {
  const std::string text = value(parameter);
  if (text.empty()) fail("*" + keyword_ + " needs " + parameter + "=");
  return text;
}

void AbaqusDeck::allow(std::initializer_list<const char*> parameters) const {
  const std::vector<std::string> known(parameters.begin(), parameters.end());
  for (const auto& [key, value] : parameters_)
    if (std::find(known.begin(), known.end(), key) == known.end())
      fail("parameter '" + key.substr(0, 40) + "' of *" + keyword_ + " is not supported" + suggest_name(key, known));
  if (!repeated_.empty()) fail("parameter " + repeated_ + " stands twice on *" + keyword_);
}

std::int64_t AbaqusDeck::integer(std::size_t field, const char* what) const {
  std::int64_t value = 0;
  const std::string text(fields_.at(field).substr(0, 40));
  if (!parse_integer(fields_[field], value) || value < 1 || value > std::numeric_limits<Index>::max())
    fail(std::string(what) + " must be a whole number from 1, not '" + text + "'");
  return value;
}

double AbaqusDeck::real(std::size_t field, const char* what) const {
  double value = 0;
  const std::string text(fields_.at(field).substr(0, 40));
  if (!parse_real(fields_[field], value)) fail(std::string(what) + " must be a finite number, not '" + text + "'");
  return value;
}

}  // namespace softkin
