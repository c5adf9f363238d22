#pragma once

#include <cstddef>
#include <softkin/core/text.hpp>
#include <softkin/core/types.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softkin::cli {

/// "(x, y, z) mm"; what is 1e-12 of the largest coordinate or less counts as 0.
[[nodiscard]] std::string point_text(const Vec3& point);

/// The first lines, at most so many, and what was left out: "... and N more".
[[nodiscard]] std::vector<std::string> cut(std::vector<std::string> lines, std::size_t most);

[[nodiscard]] std::string joined(const std::vector<std::string>& lines, const std::string& indent);

/// "plot: F.svg", a line for each file that is given.
[[nodiscard]] std::string written_text(const std::vector<std::pair<std::string, std::string>>& files);

// Throw InvalidInput where standard output cannot be written.
void print(const std::string& text);
void print_piece(std::string_view text);  // without a flush

}  // namespace softkin::cli
