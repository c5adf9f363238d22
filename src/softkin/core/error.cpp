#include <algorithm>
#include <limits>
#include <numeric>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>

namespace softkin {

std::string Origin::text() const {
  if (binary) return file + ": byte " + std::to_string(byte);
  if (line > 0) return file + ":" + std::to_string(line);
  return file;
}

InvalidInput::InvalidInput(const std::string& message) : std::runtime_error(on_one_line(message)) {}

InvalidInput::InvalidInput(const Origin& origin, const std::string& message)
    : InvalidInput(origin.file.empty() ? message : origin.text() + ": " + message) {}

namespace {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({change, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : candidates) {
    // a beginning of three letters or more is a name cut short
    const bool cut = name.size() > 2 && candidate.starts_with(name);
    const std::size_t distance = cut ? 1 : edit_distance(name, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return least <= std::max<std::size_t>(2, name.size() / 3) ? best : "";
}

std::string suggest_name(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string near = nearest_name(name, candidates);
  if (!near.empty()) return "; did you mean '" + near + "'?";
  if (candidates.empty()) return "";
  std::string text = "; known: ";
  for (std::size_t i = 0; i < candidates.size(); ++i) text += (i ? ", " : "") + candidates[i];
  return text;
}

}  // namespace softkin
