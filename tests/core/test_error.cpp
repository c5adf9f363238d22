#include <gtest/gtest.h>

#include <softkin/core/error.hpp>

namespace softkin {

TEST(Error, OriginNamesFileAndLineOrByte) {
  EXPECT_EQ((Origin{"a.msh", 3}).text(), "a.msh:3");
  EXPECT_EQ((Origin{"a.msh", 0, 12, true}).text(), "a.msh: byte 12");
  EXPECT_EQ((Origin{"a.msh"}).text(), "a.msh");
  EXPECT_STREQ(InvalidInput({"a.msh", 3}, "too short").what(), "a.msh:3: too short");
}

TEST(Error, IsOneLineThatIsSafeToPrintWhateverItRepeatsOfAFile) {
  EXPECT_STREQ(InvalidInput({"a.msh", 3}, "found '\x1b[2J\n\x7f\t\xff\xc3'").what(),
               "a.msh:3: found '?[2J????"
               "?'");
  EXPECT_STREQ(InvalidInput(std::string("cut \xe2\x82 off, \0 too", 17)).what(), "cut ?? off, ? too");
  EXPECT_STREQ(InvalidInput("Länge in \u00b5m, \u20ac, \U0001d11e").what(), "Länge in \u00b5m, \u20ac, \U0001d11e");
}

TEST(Error, SuggestsTheNearestName) {
  const std::vector<std::string> known{"chamber", "body", "base"};
  EXPECT_EQ(nearest_name("chmaber", known), "chamber");
  EXPECT_EQ(nearest_name("bdy", known), "body");
  EXPECT_EQ(nearest_name("cha", {"the", "bha2", "chamber"}), "chamber");
  EXPECT_EQ(nearest_name("quite_another", known), "");
  EXPECT_EQ(suggest_name("basee", known), "; did you mean 'base'?");
  EXPECT_EQ(suggest_name("quite_another", known), "; known: chamber, body, base");
  EXPECT_EQ(suggest_name("x", {}), "");
}

}  // namespace softkin
