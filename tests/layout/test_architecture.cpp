#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
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

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

using Constants = std::multiset<std::pair<std::string, std::string>>;

/// Names and values of the numbers of a source.
Constants constants_in(const std::string& source) {
  static const std::regex declared(R"(constexpr (?:double|int|Index|std::size_t|std::int64_t) ([^;{]*);)");
  static const std::regex one(R"((\w+) = ([^,]+))");
  Constants found;
  for (std::sregex_iterator match(source.begin(), source.end(), declared), end; match != end; ++match) {
    const std::string list = (*match)[1].str();
    for (std::sregex_iterator each(list.begin(), list.end(), one); each != end; ++each)
      found.emplace((*each)[1].str(), (*each)[2].str());
  }
  return found;
}

/// By file, what the tables of path_tracking.md have.
std::map<std::string, Constants> constants_reported(const std::string& page) {
  static const std::regex heading(R"(### `(\w+)`)"), row(R"(\| `(\w+)` \| ([^|]+) \|.*)");
  std::map<std::string, Constants> reported;
  std::string file;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, heading))
      file = match[1].str();
    else if (!file.empty() && std::regex_match(line, match, row))
      reported[file].emplace(match[1].str(), match[2].str());
  }
  return reported;
}

}  // namespace

/// path_tracking.md has every number of laws that is no option, with its value.
TEST(Architecture, ListsConstantsOfLaws) {
  const fs::path source(SOFTKIN_SOURCE_DIR);
  const auto reported = constants_reported(text_of(source / "docs/path_tracking.md"));
  for (const std::string file : {"pressures", "fibres", "fibre_families"}) {
    ASSERT_TRUE(reported.contains(file)) << file;
    EXPECT_EQ(reported.at(file), constants_in(text_of(source / "src/softkin/statics/physical" / (file + ".cpp"))))
        << file;
    EXPECT_FALSE(reported.at(file).empty()) << file;
  }
}

/// At most 60 constants of the physical formulation are no options: numerics, units and laws.
TEST(Architecture, LeavesFewConstantsThatAreNoOptions) {
  const fs::path source(SOFTKIN_SOURCE_DIR);
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(source / "src/softkin/statics/physical"))
    count += constants_in(text_of(entry.path())).size();
  EXPECT_GT(count, 30u);
  EXPECT_LE(count, 60u);
}

/// Every source of the modules that are not read in a minute.
TEST(Architecture, HasARowForEverySource) {
  const fs::path source(SOFTKIN_SOURCE_DIR);
  const std::set<std::string> names = names_in_tables(source / "docs/architecture.md");
  std::set<std::string> stems;
  for (const char* module : {"statics", "runs"})
    for (const auto& entry : fs::recursive_directory_iterator(source / "src/softkin" / module)) {
      if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
      stems.insert(entry.path().stem().string());
      EXPECT_TRUE(names.contains(entry.path().stem().string())) << entry.path();
    }
  EXPECT_GT(stems.size(), 90u);
}

}  // namespace softkin
