#include <gtest/gtest.h>

#include <functional>
#include <softkin/core/error.hpp>
#include <softkin/io/missing_file.hpp>
#include <softkin/io/scene/scene.hpp>

#include "support/temporary_folder.hpp"

/// Files that are not there, or that are no scenes.

namespace softkin {
namespace {

std::string refusal_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(MissingFile, IsMadeByAScriptAModelOrNamedInTheReadme) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path at = folder / "";
  EXPECT_EQ(source_of_missing(at, at / "a.msh"), "");
  folder.write("README.md", "Put `a.msh` and `b.tet` here.");
  EXPECT_EQ(source_of_missing(at, at / "b.tet"), folder / "README.md" + " says where it comes from");
  folder.write("a.geo", "Box(1) = {0, 0, 0, 1, 1, 1};");
  EXPECT_EQ(source_of_missing(at, at / "a.msh"),
            "'gmsh -3 " + folder / "a.geo" + " -o " + folder / "a.msh" + "' makes it");
  folder.write("make.py", "open('a.msh')");
  EXPECT_EQ(source_of_missing(at, at / "a.msh"), "'python3 " + folder / "make.py" + "' makes it");
  EXPECT_EQ(source_of_missing(at / "nowhere", at / "a.msh"), "");
}

TEST(MissingFile, IsToldWithWhatMakesIt) {
  const testing::TemporaryFolder folder;
  const std::string scene = folder.write("s.yaml", "softkin: 1\nmesh: {file: a.mesh}\n");
  folder.write("make_a.py", "Path('a.mesh').write_text(mesh())");
  EXPECT_EQ(refusal_of([&] { (void)read_scene(scene); }),
            scene + ":2: " + folder / "a.mesh" + ": no such file: 'python3 " + folder / "make_a.py" + "' makes it");
}

TEST(SceneFile, OfAnotherKindIsRefusedByItsName) {
  const testing::TemporaryFolder folder;
  const std::pair<const char*, const char*> cases[] = {
      {"a.stl", "is a surface by its name, not a scene in YAML: 'python -m softkin mesh generate' makes a mesh and a"},
      {"a.STEP", "is a CAD model by its name, not a scene in YAML: 'python -m softkin mesh generate'"},
      {"a.msh", "is a mesh by its name, not a scene in YAML: write a scene that names it, 'mesh: {file: ...}'"},
      {"a.inp", "is a mesh by its name"},
      {"a.skmap", "is a kinematic map by its name, not a scene in YAML: give the scene that it is of"},
      {"a.json", "is a report by its name"}};
  for (const auto& [name, message] : cases) {
    const std::string file = folder.write(name, "solid");
    const std::string refusal = refusal_of([&] { (void)read_scene(file); });
    EXPECT_TRUE(refusal.starts_with(file + ": " + message)) << refusal;
  }
  EXPECT_EQ(refusal_of([&] { (void)read_scene(folder / "none.stl"); }), folder / "none.stl" + ": no such file");
}

}  // namespace
}  // namespace softkin
