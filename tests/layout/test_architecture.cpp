#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace softkin {
namespace {

namespace fs = std::filesystem;

/// The names in the first column of architecture.md's tables, without folders.
std::set<std::string> names_in_tables(const fs::path& file) {
  static const std::regex name(R"(`(?:[\w/]*/)?(\w+)`)");
  std::set<std::string> names;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with("| `")) continue;
    const std::string cell = line.substr(0, line.find(" | "));
    for (std::sregex_iterator match(cell.begin(), cell.end(), name), end; match != end; ++match)
      names.insert((*match)[1].str());
  }
  return names;
}

}  // namespace

/// Every source of the rooms that are not read in a minute.
TEST(Architecture, HasARowForEverySource) {
  const fs::path source(SOFTKIN_SOURCE_DIR);
  const std::set<std::string> names = names_in_tables(source / "docs/architecture.md");
  std::set<std::string> stems;
  for (const char* room : {"statics", "runs"})
    for (const auto& entry : fs::recursive_directory_iterator(source / "src/softkin" / room)) {
      if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
      stems.insert(entry.path().stem().string());
      EXPECT_TRUE(names.contains(entry.path().stem().string())) << entry.path();
    }
  EXPECT_GT(stems.size(), 90u);
}

}  // namespace softkin
