#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "fk_physical_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// Runs `fk` with a file of options; report: where its report is written.
ProgramResult run_with(const BlockFolder& folder, const std::string& options) {
  const std::string file = folder.write("tuned.yaml", options);
  return run_fk(folder.scene, {"--set", "air=20", "--options", file, "--report", folder / "a.json"});
}

TEST(SolverOptionsFile, ChangesAreInTheReportAndInNoOther) {
  const BlockFolder folder(loaded_scene());
  const ProgramResult tuned =
      run_with(folder, "newton: {max_iterations: 25}\nstep: {max_turn: 30, min_remainder: 0.2}\n");
  ASSERT_EQ(tuned.exit_code, 0) << tuned.errors;
  const json expected = {{"newton", {{"max_iterations", 25.0}}}, {"step", {{"min_remainder", 0.2}}}};
  EXPECT_EQ(json::parse(read_text(folder / "a.json"))["solver"]["options"], expected);
  ASSERT_EQ(run_fk(folder.scene, {"--set", "air=20", "--report", folder / "b.json"}).exit_code, 0);
  EXPECT_FALSE(json::parse(read_text(folder / "b.json"))["solver"].contains("options"));
}

TEST(SolverOptionsFile, RefusalsNameFileLineKeyAndTheNearestName) {
  const BlockFolder folder(loaded_scene());
  const auto refused = [&](const std::string& options, const std::string& expected) {
    const ProgramResult result = run_with(folder, options);
    EXPECT_EQ(result.exit_code, 2) << options;
    EXPECT_NE(result.errors.find(expected), std::string::npos) << result.errors;
  };
  refused("step:\n  max_turn: 20\nnewtn:\n  max_iterations: 3\n",
          "tuned.yaml:3: no group of options is called 'newtn'; did you mean 'newton'?");
  refused("step:\n  max_trun: 20\n",
          "tuned.yaml:2: the options of 'step' have no 'max_trun'; did you mean 'max_turn'?");
  refused("step:\n  max_turn: -1\n", "tuned.yaml:2: the option step.max_turn must be above 0, not -1");
  refused("step:\n  max_turn: far\n", "tuned.yaml:2: 'max_turn' must be a finite number");
  refused("step: 3\n", "tuned.yaml:1: a group of options is a map of names and numbers");
  refused("3\n", "solver options are a map of groups");
  EXPECT_NE(run_fk(folder.scene, {"--options", folder / "nowhere.yaml"}).errors.find("nowhere.yaml"),
            std::string::npos);
}

TEST(SolverOptionsFile, AHiddenCommandPrintsTheTables) {
  const ProgramResult tables = run_program({"options"});
  EXPECT_EQ(tables.exit_code, 0);
  EXPECT_EQ(tables.output.rfind("### `step`\n", 0), 0u) << tables.output.substr(0, 100);
  EXPECT_EQ(run_program({"--help"}).output.find("Tuned constants"), std::string::npos);
}

}  // namespace
