#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <softkin/core/target.hpp>
#include <string>
#include <vector>

#include "support/skips.hpp"

/// The main function of all test programs. A test that is skipped is listed with its reason in the file that the
/// environment variable SOFTKIN_SKIPPED names; where SOFTKIN_NO_SKIP is set, it fails unless its reason is allowed.

namespace {

using softkin::Target;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// One line in one write, as several programs write the same file.
void list_skip(const std::string& test, const std::string& reason) {
  if (const std::string file = variable("SOFTKIN_SKIPPED"); !file.empty())
    std::ofstream(file, std::ios::app) << test + ": " + reason + "\n" << std::flush;
}

std::string reason_of(const ::testing::TestResult& result) {
  for (int i = 0; i < result.total_part_count(); ++i) {
    const ::testing::TestPartResult& part = result.GetTestPartResult(i);
    if (!part.skipped()) continue;
    std::string reason = part.message();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    return reason.substr(0, reason.find_last_not_of(' ') + 1);
  }
  return "no reason given";
}

class SkipListener : public ::testing::EmptyTestEventListener {
  void OnTestEnd(const ::testing::TestInfo& test) override {
    if (!test.result()->Skipped()) return;
    const std::string reason = reason_of(*test.result());
    list_skip(std::string(test.test_suite_name()) + "." + test.name(), reason);
    if (!variable("SOFTKIN_NO_SKIP").empty() && !softkin::testing::may_be_skipped(reason))
      ADD_FAILURE() << "skipped, where SOFTKIN_NO_SKIP forbids it: " << reason;
  }
};

/// Is SOFTKIN_TARGET an instruction set of this machine, or not set?
bool has_target() {
  const std::string target = variable("SOFTKIN_TARGET");
  const std::vector<Target> present = softkin::targets_here();
  return target.empty() ||
         std::any_of(present.begin(), present.end(), [&](Target each) { return softkin::name_of(each) == target; });
}

}  // namespace

int main(int count, char** words) {
  ::testing::InitGoogleTest(&count, words);
  if (!has_target() && !GTEST_FLAG_GET(list_tests)) {
    const std::string program = words[0], target = variable("SOFTKIN_TARGET");
    const std::string reason = "this machine lacks the instruction set " + target;
    list_skip(program.substr(program.rfind('/') + 1) + " for " + target, reason);
    std::printf("skipped: %s\n", reason.c_str());
    return 0;
  }
  ::testing::UnitTest::GetInstance()->listeners().Append(new SkipListener);
  return RUN_ALL_TESTS();
}
