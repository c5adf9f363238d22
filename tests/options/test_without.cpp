#include <gtest/gtest.h>

#include "cli/fk_samples.hpp"

/// What a program answers that was built without OpenCV and without its page.

namespace {

using namespace softkin::testing;

const std::string no_page = "this softkin was built without its page";

TEST(WithoutOpenCv, MeasureNamesThePackageThatItNeeds) {
  const ProgramResult result = run_program({"measure", "--help"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.errors.find("libopencv-dev"), std::string::npos) << result.errors;
}

TEST(WithoutPage, HtmlIsRefusedAndNothingIsWritten) {
  const BlockFolder folder;
  expect_refused(folder, {"--html", folder / "block.html"}, no_page);
}

TEST(WithoutPage, ViewIsRefused) {
  const BlockFolder folder;
  const ProgramResult result = run_program({"view", folder.scene});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.errors.find(no_page), std::string::npos) << result.errors;
}

TEST(WithoutPage, MapsAreExportedForCAloneAndTheModuleIsRefused) {
  const BlockFolder folder;
  const std::string map = folder / "block.skmap";
  const ProgramResult made = run_program({"map", folder.scene, "-o", map, "--check", "1", "--accuracy", "1"});
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  const std::size_t files = folder.files();
  const ProgramResult refused =
      run_program({"map", "export", map, "--c", folder / "block.h", "--js", folder / "block.mjs"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("no module for JavaScript: " + no_page), std::string::npos) << refused.errors;
  EXPECT_EQ(folder.files(), files);
  EXPECT_EQ(run_program({"map", "export", map, "--c", folder / "block.h"}).exit_code, 0);
}

}  // namespace
