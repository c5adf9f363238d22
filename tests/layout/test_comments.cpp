#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>

namespace softkin {
namespace {

namespace fs = std::filesystem;

/// clang-format leaves the line breaks of comments alone, and so does not see what becomes too long or is joined.
std::string fault_of(const std::string& line) {
  static const std::regex joined(R"(\s*///.*\S (throws|returns|source|equation)  +\S.*)");
  if (line.size() > 120) return "longer than 120 characters";
  return std::regex_match(line, joined) ? "a part of the docstring begins within the line" : "";
}

}  // namespace

TEST(Comments, FitTheirLines) {
  std::size_t lines = 0;
  for (const char* folder : {"src", "apps", "bench", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SOFTKIN_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
      std::ifstream stream(entry.path());
      std::size_t number = 0;
      for (std::string line; std::getline(stream, line); ++lines) {
        ++number;
        if (line.find("//") != std::string::npos) {
          EXPECT_EQ(fault_of(line), "") << entry.path() << ":" << number;
        }
      }
    }
  EXPECT_GT(lines, 40000u);
}

TEST(Comments, FaultsAreSeen) {
  EXPECT_NE(fault_of("/// equilibrium throws     InvalidInput on a size mismatch"), "");
  EXPECT_NE(fault_of("// " + std::string(118, 'x')), "");
  EXPECT_EQ(fault_of("/// throws     InvalidInput where it throws"), "");
}

}  // namespace softkin
