#include <gtest/gtest.h>

#include <softkin/core/error.hpp>

namespace softkin {

TEST(Error, OriginNamesFileAndLineOrByte) {
  EXPECT_EQ((Origin{"a.msh", 3}).text(), "a.msh:3");
  EXPECT_EQ((Origin{"a.msh", 0, 12, true}).text(), "a.msh: byte 12");
  EXPECT_EQ((Origin{"a.msh"}).text(), "a.msh");
  EXPECT_STREQ(InvalidInput({"a.msh", 3}, "too short").what(), "a.msh:3: too short");
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
