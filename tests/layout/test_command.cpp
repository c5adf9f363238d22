#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace softkin {

/// The command is a face: whatever else needs stands in the library.
TEST(Command, KnowsNoJsonAndStaysSmall) {
  std::size_t lines = 0, files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SOFTKIN_SOURCE_DIR "/apps/cli")) {
    if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
    ++files;
    std::ifstream stream(entry.path());
    for (std::string line; std::getline(stream, line); ++lines) {
      EXPECT_EQ(line.find("nlohmann"), std::string::npos) << entry.path() << ": " << line;
    }
  }
  EXPECT_GT(files, 20u);
  EXPECT_LE(lines, 5200u);
}

}  // namespace softkin
