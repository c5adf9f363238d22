#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "run_program.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;
namespace fs = std::filesystem;

const fs::path source_examples = fs::path(SOFTKIN_SOURCE_DIR) / "examples";

json listed() {
  const ProgramResult result = run_program({"examples", "list", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return json::parse(result.output);
}

ProgramResult copy_to(const TemporaryFolder& folder, const std::string& name) {
  return run_program({"examples", "copy", name, folder / ""});
}

void expect_refused(const std::string& name, const std::string& words) {
  SCOPED_TRACE(name);
  const TemporaryFolder folder;
  const ProgramResult result = copy_to(folder, name);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.output, "");
  EXPECT_NE(result.errors.find(words), std::string::npos) << result.errors;
  EXPECT_EQ(folder.files(), 0u);
}

std::set<std::string> files_below(const fs::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.insert(entry.path().lexically_relative(folder).string());
  return files;
}

TEST(ExamplesList, HasEveryFolderOfTheSources) {
  std::set<std::string> expected, found;
  for (const auto& entry : fs::recursive_directory_iterator(source_examples)) {
    const fs::path name = entry.path().parent_path().lexically_relative(source_examples);
    if (entry.path().filename() == "README.md" && name != "." && name != "python") expected.insert(name.string());
  }
  for (const json& each : listed()) {
    SCOPED_TRACE(each["name"]);
    found.insert(each["name"]);
    EXPECT_FALSE(each["title"].get<std::string>().empty());
    ASSERT_GT(each["command"].size(), 2u);
    EXPECT_EQ(each["command"][0], "softkin");
    const std::string scene = each["scene"];
    EXPECT_TRUE(scene.empty() ? each["name"] == "acrylic_strip" : fs::exists(source_examples / scene)) << scene;
  }
  EXPECT_EQ(found, expected);
}

TEST(ExamplesList, TellsWhatIsCommanded) {
  json of;
  for (const json& each : listed()) of[each["name"]] = each;
  EXPECT_EQ(of["pneumatic_finger"]["actuators"],
            json::parse(R"([{"name": "air", "kind": "pneumatic", "unit": "", "range": [1.0, 3.0]}])"));
  EXPECT_EQ(of["magnetic_crawler"]["actuators"][1],
            json::parse(R"({"name": "field_z", "kind": "magnetic", "unit": "mT", "range": [-1.2, 1.2]})"));
  EXPECT_EQ(of["two_finger_gripper"]["actuators"][0]["name"], "left.air");
  const std::string text = run_program({"examples", "list"}).output;
  for (const char* part :
       {"air1, air2, air3: 1 to 1.6\n", "none\n", "pneumatic_finger             finger         Pneumatic finger"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

/// Robots whose meshes or measurements do not come with softkin.
TEST(ExamplesList, TellsWhatIsMadeOrFetchedFirst) {
  json of;
  for (const json& each : listed()) of[each["name"]] = each["missing"];
  const bool made = fs::exists(source_examples / "real/beam/beam.mesh");
  if (!made)
    EXPECT_EQ(of["real/beam"][0], json::parse(R"({"file": "real/beam/beam.mesh",
      "source": "'python3 real/beam/make_beam.py' makes it"})"));
  EXPECT_EQ(of["paper/published_robot"][0]["file"], "paper/published_robot/soro_body.tet");
  EXPECT_EQ(of["paper/published_robot"][0]["source"], "paper/published_robot/README.md says where it comes from");
  EXPECT_EQ(of["pneumatic_finger"], json::array());
  const std::string text = run_program({"examples", "list"}).output;
  EXPECT_NE(text.find("paper/published_robot needs paper/published_robot/soro_body.tet, which does not come with "
                      "softkin: paper/published_robot/README.md says where it comes from\n"),
            std::string::npos)
      << text;
}

TEST(ExamplesCopy, KnowsEveryNameAndShortName) {
  const TemporaryFolder folder;
  std::set<std::string> names;
  for (const json& each : listed())
    for (const char* key : {"name", "short_name"}) {
      const std::string name = each[key];
      if (name.empty()) continue;
      EXPECT_TRUE(names.insert(name).second) << name;
      const ProgramResult result = run_program({"examples", "copy", name, folder / "", "--json"});
      ASSERT_EQ(result.exit_code, 0) << result.errors;
      EXPECT_EQ(json::parse(result.output)["name"], each["name"]);
    }
  EXPECT_GT(names.size(), 20u);
}

TEST(ExamplesCopy, CopiesFilesAsTheyAre) {
  const TemporaryFolder folder;
  ASSERT_EQ(copy_to(folder, "finger").exit_code, 0);
  EXPECT_EQ(folder.files(), 1u);
  const std::set<std::string> files = files_below(folder / "pneumatic_finger");
  for (const char* file : {"pneumatic_finger.yaml", "path.csv", "cycles/viscous_finger.yaml"})
    EXPECT_TRUE(files.contains(file)) << file;
  for (const std::string& file : files) {
    const std::string text = read_text(folder / ("pneumatic_finger/" + file));
    if (file == "README.md") {
      EXPECT_EQ(text.find("build/softkin"), std::string::npos);
      EXPECT_NE(text.find("softkin fk pneumatic_finger/pneumatic_finger.yaml --set air=1.4"), std::string::npos);
    } else {
      EXPECT_EQ(text, read_text(source_examples / "pneumatic_finger" / file)) << file;
    }
  }
}

/// The command that is suggested next runs; one of them takes the mesh of another example.
TEST(ExamplesCopy, TellsACommandThatRuns) {
  for (const char* name : {"chambers", "two_fingers"}) {
    SCOPED_TRACE(name);
    const TemporaryFolder folder;
    const std::string here = "cd " + shell_quoted(folder / "") + " && ", program = shell_quoted(SOFTKIN_PROGRAM);
    const ProgramResult copied = run_shell(here + program + " examples copy " + name);
    ASSERT_EQ(copied.exit_code, 0);
    const std::size_t next = copied.output.find("next:\n  softkin ");
    ASSERT_NE(next, std::string::npos) << copied.output;
    const ProgramResult bent = run_shell(here + program + copied.output.substr(next + 15));
    EXPECT_EQ(bent.exit_code, 0) << bent.output;
    EXPECT_NE(bent.output.find("converged"), std::string::npos) << bent.output;
    EXPECT_TRUE(fs::exists(folder / "out"));
  }
}

TEST(ExamplesCopy, NamesTheFolderInTheCommand) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program({"examples", "copy", "bar", folder / "my robots"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("softkin fk '" + (folder / "my robots/two_material_bar/two_material_bar.yaml") + "'"),
            std::string::npos)
      << result.output;
}

TEST(ExamplesCopy, ReplacesNothing) {
  const TemporaryFolder folder;
  ASSERT_EQ(copy_to(folder, "bar").exit_code, 0);
  const std::string scene = folder / "two_material_bar/two_material_bar.yaml";
  fs::remove(folder / "two_material_bar/README.md");
  EXPECT_EQ(copy_to(folder, "two_material_bar").exit_code, 0);  // what is missing comes back
  EXPECT_TRUE(fs::exists(folder / "two_material_bar/README.md"));
  std::ofstream(scene, std::ios::app) << "# mine\n";
  fs::remove(folder / "two_material_bar/README.md");
  const ProgramResult refused = copy_to(folder, "bar");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("two_material_bar.yaml: is there already and not the example's: nothing was copied"),
            std::string::npos)
      << refused.errors;
  EXPECT_FALSE(fs::exists(folder / "two_material_bar/README.md"));
  EXPECT_TRUE(read_text(scene).ends_with("# mine\n"));
}

TEST(ExamplesCopy, RefusesNamesThatAreNone) {
  expect_refused("fingr", "examples: there is none named 'fingr'; did you mean 'finger'?");
  expect_refused("octopus", "known: acrylic_strip, bilayer, cable_gripper,");
  expect_refused("", "examples: there is none named ''");
  expect_refused("../examples/cpp", "there is none named");
  expect_refused("three", "'three' may be three_chamber_actuator or three_tendon_finger");
  expect_refused("magnetic_", "'magnetic_' may be magnetic_cantilever or magnetic_crawler");
}

/// A program without its examples reports what is missing.
TEST(Examples, MissingOnesAreToldOf) {
  const TemporaryFolder folder;
  fs::copy_file(SOFTKIN_PROGRAM, folder / "softkin");
  const ProgramResult result = run_shell(shell_quoted(folder / "softkin") + " examples list 2>&1");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.output.find("softkin: examples: they were not installed with this softkin"), std::string::npos)
      << result.output;
}

}  // namespace
