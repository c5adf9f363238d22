#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "fk_samples.hpp"

namespace softkin::testing {
namespace {

namespace fs = std::filesystem;

/// A scene of a block with a chamber; its mesh stands beside it.
std::string block_scene(const TemporaryFolder& folder) {
  folder.write("block.msh", Block(3).mesh.text());
  return folder.write("block.yaml",
                      "softkin: 1\nmesh: {file: block.msh}\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
                      "fixed: [{region: base}]\n"
                      "actuators: [{name: air, kind: pneumatic, region: chamber, range: [0.5, 3]}]\n"
                      "markers: [{name: tip, region: base}]\n");
}

/// Refused as it should be: one line, exit code 2.
void expect_refused(const ProgramResult& result, const std::string& words) {
  EXPECT_EQ(result.exit_code, 2) << result.errors;
  EXPECT_NE(result.errors.find(words), std::string::npos) << result.errors;
  EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
}

/// Runs softkin with limited address space [KiB].
ProgramResult run_with_memory(int kibibytes, const std::string& arguments) {
  const TemporaryFolder folder;
  const std::string errors = folder / "stderr";
  ProgramResult result = run_shell("ulimit -v " + std::to_string(kibibytes) + "; " + shell_quoted(SOFTKIN_PROGRAM) +
                                   " " + arguments + " </dev/null 2>" + shell_quoted(errors));
  result.errors = read_text(errors);
  return result;
}

TEST(Robustness, ThreadsThatCannotBeStartedAreToldOrDoneWithout) {
  const TemporaryFolder folder;
  const std::string scene = shell_quoted(block_scene(folder));
  expect_refused(run_with_memory(400000, "fk " + scene + " --set air=1.1 --threads 200"),
                 "threads could be started (Resource temporarily unavailable): ask for fewer threads");
  expect_refused(
      run_with_memory(400000, "workspace " + scene + " --samples 9 --threads 200 -o " + shell_quoted(folder / "w.csv")),
      "threads could be started");
  const ProgramResult fewer = run_with_memory(400000, "fk " + scene + " --set air=1.1");
  EXPECT_EQ(fewer.exit_code, 0) << fewer.errors;
}

TEST(Robustness, WhatIsNoFileIsNotRead) {
  const TemporaryFolder folder;
  expect_refused(run_program({"fk", "/dev/zero"}), "/dev/zero: is a device, not a file");
  const std::string scene = folder.write("scene.yaml", "softkin: 1\nmesh: {file: loop.msh}\n");
  fs::create_symlink("loop.msh", folder / "loop.msh");
  expect_refused(run_program({"fk", scene}), "loop.msh");
#ifdef SOFTKIN_OPENCV
  fs::create_symlink("loop.png", folder / "loop.png");
  expect_refused(run_program({"measure", folder / "loop.png", "--dots", "red", "--scale", "0,0,10,0=1mm"}), "loop.png");
#endif
}

TEST(Robustness, ALineBreakInANameLeavesTheMessageOneLine) {
  const TemporaryFolder folder;
  expect_refused(run_program({"fk", folder / "two\nlines.yaml"}), "two?lines.yaml: no such file");
  expect_refused(run_program({"fk", folder / "a.yaml", "--no\nsuch"}), "there is no option '--no?such'");
}

TEST(Robustness, ASecondRunBesideALiveOneIsRefusedBeforeItWrites) {
  const TemporaryFolder folder;
  const std::string scene = block_scene(folder), report = folder / "report.json";
  const std::string path = folder.write("path.csv", "air\n1.1\n1.2\n");
  // the journal of a run that is at work: held by this shell
  const std::string command = "exec 9>" + shell_quoted(report + ".run") + "; flock 9; " +
                              shell_quoted(SOFTKIN_PROGRAM) + " fk " + shell_quoted(scene) + " --path " +
                              shell_quoted(path) + " --report " + shell_quoted(report) + " -o " +
                              shell_quoted(folder / "s.pvd") + " 9>&- 2>&1";
  const ProgramResult beside = run_shell(command);
  EXPECT_EQ(beside.exit_code, 2) << beside.output;
  EXPECT_NE(beside.output.find("another softkin is at work on it"), std::string::npos) << beside.output;
  EXPECT_FALSE(fs::exists(folder / "s_0000.vtu"));
  EXPECT_TRUE(fs::exists(report + ".run"));
}

}  // namespace
}  // namespace softkin::testing
