#include "printing.hpp"

#include <cmath>
#include <cstdio>
#include <softkin/core/error.hpp>

namespace softkin::cli {

std::string point_text(const Vec3& point) {
  const double rounding = 1e-12 * point.cwiseAbs().maxCoeff();
  std::string text;
  for (const double x : point) text += (text.empty() ? "(" : ", ") + number(std::abs(x) < rounding ? 0 : x);
  return text + ") mm";
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

std::string written_text(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string text;
  for (const auto& [what, file] : files)
    if (!file.empty()) text += what + ": " + file + "\n";
  return text;
}

void print_piece(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
    throw InvalidInput("standard output cannot be written");
}

void print(const std::string& text) {
  print_piece(text);
  if (std::fflush(stdout) != 0) throw InvalidInput("standard output cannot be written");
}

}  // namespace softkin::cli
