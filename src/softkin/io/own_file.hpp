#pragma once

#include <filesystem>
#include <string_view>

namespace softkin {

// What files say that softkin writes, so that it knows them again: what it knows it may replace, all else is the
// user's.
inline constexpr std::string_view made_by_softkin = "made by softkin";      // in a comment, of forms that have some
inline constexpr std::string_view xml_mark = "<!-- made by softkin -->\n";  // of .vtu, .pvd and .svg
inline constexpr std::string_view page_mark = "id=\"softkin-page\"";        // of .html: where its document stands
inline constexpr std::string_view gcode_mark = "; Before this program the motors stand at home";
inline constexpr std::string_view workspace_mark = "# softkin workspace: ";

/// Did softkin write it, by what it holds? An empty file counts, as there is nothing in it to lose.
///
/// throws  InvalidInput where it cannot be read
[[nodiscard]] bool is_own_file(const std::filesystem::path& file);

/// The same of what a file holds.
[[nodiscard]] bool is_own_content(std::string_view content);

}  // namespace softkin
