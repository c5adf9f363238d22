#include <algorithm>
#include <cctype>
#include <limits>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <utility>

namespace softkin {

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string upper_case(std::string_view text) {
  std::string upper(text);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return upper;
}

std::string without_comments(std::string content) {
  for (std::size_t begin = content.find('#'); begin != std::string::npos; begin = content.find('#', begin)) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    std::fill(content.begin() + static_cast<std::ptrdiff_t>(begin), content.begin() + static_cast<std::ptrdiff_t>(end),
              ' ');
  }
  return content;
}

std::string read_without_comments(const std::filesystem::path& path) {
  return without_comments(read_file(path));
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

Index read_index(Scanner& scanner, const char* what, Index low, Index high) {
  return scanner.integer(what, low, high);
}

Index read_count(Scanner& scanner, const char* items, Index low, std::size_t bytes_each) {
  const std::string what = std::string("number of ") + items;
  const Index count = read_index(scanner, what.c_str(), low, std::numeric_limits<Index>::max());
  scanner.require(static_cast<std::uint64_t>(count), bytes_each, items);
  return count;
}

Index read_label(Scanner& scanner, const char* what) {
  return read_index(scanner, what, std::numeric_limits<Index>::min(), std::numeric_limits<Index>::max());
}

Scanner& on_line(Scanner& scanner, const char* what) {
  if (!scanner.line_has_more()) scanner.fail(std::string("the line ends before ") + what);
  return scanner;
}

void expect_end(Scanner& scanner) {
  if (scanner.at_end()) return;
  const std::string extra(scanner.token("the end of the file").substr(0, 40));
  scanner.fail("unexpected '" + extra + "' where the file should end");
}

void append_regions(Mesh& mesh, LabelledRegions&& regions, const std::string& prefix, int dimension) {
  for (auto& [label, region] : regions) {
    region.name = prefix + std::to_string(label);
    region.dimension = dimension;
    mesh.regions.push_back(std::move(region));
  }
}

}  // namespace softkin
