#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/skips.hpp"

/// Robots of public reports that misled softkin; their files are not in the repository.

namespace {

using namespace softkin::testing;
using nlohmann::json;
namespace fs = std::filesystem;

/// Empty where the files are absent.
fs::path field_folder() {
  const char* named = std::getenv("SOFTKIN_REFERENCE");
  const fs::path folder = fs::path(named ? named : SOFTKIN_SOURCE_DIR "/../shared/reference") / "../field";
  return fs::exists(folder) ? folder : fs::path();
}

/// The report of `fk` of a scene in that folder.
json solved(const std::string& scene, const std::vector<std::string>& options) {
  std::vector<std::string> words{"fk", (field_folder() / scene).string(), "--json", "--threads", "1"};
  words.insert(words.end(), options.begin(), options.end());
  const ProgramResult result = run_program(words);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return json::parse(result.output);
}

}  // namespace

/// Bellows of a PneuNet come to touch in one step, whose prediction is cut there: that is no jump. The shape is that of
/// a path of four rows.
TEST(FieldCases, BellowsThatTouchTakeFewIterations) {
  if (field_folder().empty()) GTEST_SKIP() << absent_reference << "field/pneunet.yaml";
  const json once = solved("pneunet.yaml", {"--set", "air=15"});
  const TemporaryFolder folder;
  folder.write("path.csv", "air\n4\n8\n12\n15\n");
  const json rows = solved("pneunet.yaml", {"--path", folder / "path.csv"});
  const json &step = once["steps"][0], &last = rows["steps"][3];
  EXPECT_LE(step["iterations"].get<int>(), 30);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(step["markers"]["end"][axis].get<double>(), last["markers"]["end"][axis].get<double>(), 0.01) << axis;
}
