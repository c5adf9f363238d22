#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace softkin {
namespace {

namespace fs = std::filesystem;

std::size_t number_of_lines(const fs::path& file) {
  std::ifstream stream(file);
  std::size_t count = 0;
  for (std::string line; std::getline(stream, line);) ++count;
  return count;
}

}  // namespace

/// A file is about one thing: one that grows beyond this is about several.
TEST(Lengths, NoSourceIsTooLong) {
  constexpr std::size_t most = 800;
  std::size_t files = 0;
  for (const char* folder : {"src", "apps"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SOFTKIN_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
      EXPECT_LE(number_of_lines(entry.path()), most) << entry.path();
      ++files;
    }
  EXPECT_GT(files, 500u);
}

}  // namespace softkin
