#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <softkin/io/scanner.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <string_view>

namespace softkin {

/// The extension in lower case, with its dot.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

[[nodiscard]] std::string upper_case(std::string_view text);

/// The text with everything from each '#' to the end of its line replaced by blanks: lines keep their numbers.
[[nodiscard]] std::string without_comments(std::string text);
/// The same of a file.
[[nodiscard]] std::string read_without_comments(const std::filesystem::path& path);

/// Without the blanks around it.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// Next integer as an Index within low to high.
[[nodiscard]] Index read_index(Scanner& scanner, const char* what, Index low, Index high);

/// Next integer as a number of items, at least low, that fit into the rest of the file with bytes_each.
[[nodiscard]] Index read_count(Scanner& scanner, const char* items, Index low, std::size_t bytes_each);

/// Next integer as the label (reference, marker) of an element.
[[nodiscard]] Index read_label(Scanner& scanner, const char* what);

/// The scanner itself; fails where the line ends before another token.
Scanner& on_line(Scanner& scanner, const char* what);

/// Fails unless only blanks follow.
void expect_end(Scanner& scanner);

/// Regions by label, to be named when all are known.
using LabelledRegions = std::map<Index, Region>;

/// Appends them in ascending order as PREFIX + label.
void append_regions(Mesh& mesh, LabelledRegions&& regions, const std::string& prefix, int dimension);

}  // namespace softkin
