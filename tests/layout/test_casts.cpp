#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

namespace softkin {
namespace {

namespace fs = std::filesystem;

/// A cast that changes nothing: of a size that is compared with an Index, where std::ssize stands, or that begins an
/// integer, which converts by itself. Empty: none.
std::string needless_cast(const std::string& text) {
  static const std::regex compared(R"([<>=!]=? static_cast<Index>\([\w.\[\]>-]*[.>](size|rows|cols)\(\)\))"),
      initialised(R"((Index|auto)\s+\w+ =\s+static_cast<Index>\([\w.\[\]>-]*[.>](size|rows|cols)\(\)\);)");
  std::smatch found;
  for (const std::regex& pattern : {compared, initialised})
    if (std::regex_search(text, found, pattern)) return found.str();
  return "";
}

}  // namespace

TEST(Casts, OfSizesAreNeeded) {
  std::size_t files = 0;
  for (const char* folder : {"src", "apps", "bench", "tests", "python/src"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SOFTKIN_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
      if (entry.path().filename() == "test_casts.cpp") continue;
      std::stringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      EXPECT_EQ(needless_cast(text.str()), "") << entry.path();
      ++files;
    }
  EXPECT_GT(files, 1000u);
}

TEST(Casts, NeedlessOnesAreSeen) {
  EXPECT_NE(needless_cast("for (Index i = 0; i < static_cast<Index>(model.markers.size()); ++i)"), "");
  EXPECT_NE(needless_cast("const auto count =\n    static_cast<Index>(rest.rows());"), "");
  EXPECT_EQ(needless_cast("std::max(1, static_cast<Index>(model.markers.size()))"), "");
  EXPECT_EQ(needless_cast("for (Index i = 0; i < std::ssize(model.markers); ++i)"), "");
}

}  // namespace softkin
