#include <gtest/gtest.h>

#include <softkin/io/zip.hpp>

namespace softkin {
namespace {

using namespace std::string_literals;

/// Written by hand from the format's description; the checksum of "b" is 71BEEFF9, of "" 0.
TEST(Zip, IsWhatTheFormatSays) {
  const std::string entry =
      "\x14\0\x00\x08\0\0\0\0\x21\0\xF9\xEF\xBE\x71\x01\0\0\0\x01\0\0\0\x01\0\0\0"s;  // version to lengths of names
  const std::string empty = "\x14\0\x00\x08\0\0\0\0\x21\0\0\0\0\0\0\0\0\0\0\0\0\0\x02\0\0\0"s;
  const std::string local = "PK\x03\x04" + entry + "ab" + "PK\x03\x04" + empty + "no";
  const std::string rest(10, '\0');
  const std::string directory =
      "PK\x01\x02\x14\0"s + entry + rest + "\0\0\0\0a"s + "PK\x01\x02\x14\0"s + empty + rest + "\x20\0\0\0no"s;
  const std::string end =
      "PK\x05\x06\0\0\0\0\x02\0\x02\0"s + static_cast<char>(directory.size()) + "\0\0\0\x40\0\0\0\0\0"s;
  EXPECT_EQ(zip_of({{"a", "b"}, {"no", ""}}), local + directory + end);
}

TEST(Zip, NothingIsAnArchiveToo) {
  EXPECT_EQ(zip_of({}), "PK\x05\x06"s + std::string(18, '\0'));
}

}  // namespace
}  // namespace softkin
