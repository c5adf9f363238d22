#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <softkin/core/error.hpp>
#include <softkin/core/target.hpp>
#include <string>

namespace softkin {
namespace {

TEST(Target, IsOneOfThoseThatTheMachineHas) {
  const std::vector<Target> here = targets_here();
  ASSERT_FALSE(here.empty());
  EXPECT_NE(std::find(here.begin(), here.end(), target()), here.end());
  if (const char* requested = std::getenv("SOFTKIN_TARGET"))
    EXPECT_EQ(name_of(target()), std::string(requested));
  else
    EXPECT_EQ(target(), here.front());
}

}  // namespace
}  // namespace softkin
