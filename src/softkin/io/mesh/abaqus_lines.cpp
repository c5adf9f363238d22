#include <algorithm>
#include <cctype>
#include <softkin/io/mesh/abaqus_lines.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <system_error>
#include <utility>

namespace softkin {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t max_include_depth = 20, max_includes = 1000;

bool is_include(std::string_view line) {
  return line.starts_with('*') && abaqus_key(line.substr(1, line.find(',') - 1)) == "INCLUDE";
}

fs::path folder_of_deck(const fs::path& deck) {
  return deck.has_parent_path() ? deck.parent_path() : fs::path(".");
}

}  // namespace

std::string abaqus_key(std::string_view text) {
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

std::vector<std::string_view> abaqus_fields(std::string_view text) {
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

std::string without_quotes(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return std::string(text);
}

AbaqusLines::AbaqusLines(const fs::path& deck) : folder_(folder_of_deck(deck)), files_{deck.string()} {
  open_.push_back({deck, 0, std::make_unique<Scanner>(deck)});
}

bool AbaqusLines::next(std::string_view& text, AbaqusLine& place) {
  while (true) {
    Scanner& scanner = *open_.back().scanner;
    if (scanner.at_end()) {
      if (open_.size() == 1) return false;
      closed_.push_back(std::move(open_.back().scanner));
      open_.pop_back();
      continue;
    }
    text = trimmed(scanner.line());
    place = {open_.back().file, static_cast<std::uint32_t>(scanner.here().line)};
    if (text.starts_with("**")) continue;
    if (!is_include(text)) return true;
    std::string whole(text);
    while (whole.ends_with(',') && !scanner.at_end()) whole += trimmed(scanner.line());  // a continued line
    include(std::move(whole), place);
  }
}

void AbaqusLines::include(std::string text, AbaqusLine place) {
  std::string name;
  const std::vector<std::string_view> fields = abaqus_fields(text);
  for (std::size_t i = 1; i < fields.size(); ++i) {
    if (fields[i].empty()) continue;
    const std::size_t equals = fields[i].find('=');
    const std::string key = abaqus_key(fields[i].substr(0, equals));
    if (key != "INPUT" || !name.empty())
      fail(place, "parameter " + excerpt(key) + " of *INCLUDE " +
                      (key == "INPUT" ? "stands twice" : "is not supported" + suggest_name(key, {"INPUT"})));
    if (equals != std::string_view::npos) name = without_quotes(trimmed(fields[i].substr(equals + 1)));
  }
  if (name.empty()) fail(place, "*INCLUDE needs INPUT=");
  const fs::path path = inside_folder(name, place);
  for (const Open& other : open_) {
    std::error_code failure;
    if (fs::equivalent(other.path, path, failure))
      fail(place, "*INCLUDE: the file " + excerpt(name) + " includes itself");
  }
  if (open_.size() > max_include_depth)
    fail(place, "*INCLUDE: more than " + std::to_string(max_include_depth) + " files include each other");
  if (files_.size() > max_includes)
    fail(place, "*INCLUDE: more than " + std::to_string(max_includes) + " files are included");
  files_.push_back(path.string());
  try {
    open_.push_back({path, static_cast<std::uint32_t>(files_.size() - 1), std::make_unique<Scanner>(path)});
  } catch (const InvalidInput& error) {
    fail(place, "*INCLUDE: " + std::string(error.what()));
  }
}

fs::path AbaqusLines::inside_folder(const std::string& name, AbaqusLine place) const {
  std::string slashes = name;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');  // of a deck from Windows
  const fs::path relative = fs::path(slashes).lexically_normal();
  const bool drive =
      slashes.size() > 1 && slashes[1] == ':' && std::isalpha(static_cast<unsigned char>(slashes[0])) != 0;
  std::error_code failure;
  const fs::path path = folder_ / relative;
  const fs::path inside =
      fs::weakly_canonical(path, failure).lexically_relative(fs::weakly_canonical(folder_, failure));
  const bool leaves = relative.is_absolute() || drive || *relative.begin() == ".." || inside.empty() ||
                      *inside.begin() == "..";  // also by a link
  if (leaves)
    fail(place, "*INCLUDE: the file " + excerpt(name) +
                    " lies outside of the deck's folder: put it beside the deck and name it relative to the deck");
  return path;
}

void AbaqusLines::fail(AbaqusLine place, const std::string& message) const {
  throw InvalidInput(origin(place), message);
}

}  // namespace softkin
