#include "mesh_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>

#include "terminal.hpp"

namespace softkin::cli {

std::string point_text(const Vec3& point) {
  const double rounding = 1e-12 * point.cwiseAbs().maxCoeff();
  std::string text;
  for (const double x : point) text += (text.empty() ? "(" : ", ") + number(std::abs(x) < rounding ? 0 : x);
  return text + ") mm";
}

Json point_json(const Vec3& point) {
  return {point[0], point[1], point[2]};
}

std::string printable(const std::string& name) {
  const bool plain = find_unprintable(name) == std::string::npos && name.find_first_of("\t\r\n") == std::string::npos;
  return plain ? name : excerpt(name);
}

std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows, const std::string& alignment) {
  std::vector<std::size_t> widths(alignment.size(), 0);
  for (const auto& row : rows)
    for (std::size_t i = 0; i < widths.size(); ++i) widths[i] = std::max(widths[i], characters(row[i]));
  std::vector<std::string> lines;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < widths.size(); ++i) {
      const std::string fill(widths[i] - characters(row[i]), ' ');
      line += (i > 0 ? "  " : "") + (alignment[i] == 'r' ? fill + row[i] : row[i] + fill);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    lines.push_back(line);
  }
  return lines;
}

std::vector<std::string> cut(std::vector<std::string> lines, std::size_t most) {
  if (lines.size() <= most) return lines;
  const std::size_t more = lines.size() - most;
  lines.resize(most);
  lines.push_back("... and " + std::to_string(more) + " more");
  return lines;
}

std::string joined(const std::vector<std::string>& lines, const std::string& indent) {
  std::string text;
  for (const std::string& line : lines) text += indent + line + "\n";
  return text;
}

void print_piece(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
    throw InvalidInput("standard output cannot be written");
}

void print(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!written || std::fflush(stdout) != 0) throw InvalidInput("standard output cannot be written");
}

void print(const Json& json) {
  print(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace softkin::cli
