#include <gtest/gtest.h>

#include <functional>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/scene/hardware.hpp>
#include <softkin/io/scene/scene.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/path_table.hpp>

#include "text_mesh_files.hpp"

namespace softkin {
namespace {

using namespace text_mesh_tests;

const std::string lfs_pointer =
    "version https://git-lfs.github.com/spec/v1\n"
    "oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 12345\n";

/// Whatever a file stands for, it is named as what it is.
TEST(LfsPointers, AreRecognisedByEveryReader) {
  MeshFolder folder;
  const auto expect = [&](const std::string& name, const std::function<void(const std::filesystem::path&)>& read,
                          const std::string& pointer = "") {
    const auto path = folder.write(name, pointer.empty() ? lfs_pointer : tetgen_files.at(name));
    if (!pointer.empty()) folder.write(pointer, lfs_pointer);
    const std::string what = (folder / (pointer.empty() ? name : pointer)).string() +
                             ": is a Git LFS pointer, not the file itself; run `git lfs pull`";
    try {
      read(path);
      ADD_FAILURE() << name << " was read";
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  };
  const auto mesh = [](const std::filesystem::path& path) { (void)read_mesh(path); };
  for (const char* name : {"a.msh", "a.vtk", "a.vtu", "a.mesh", "b.node", "a.inp", "a.tet"}) expect(name, mesh);
  expect("a.node", mesh, "a.ele");
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.off", "a.vtk", "a"})
    expect(name, [](const auto& path) { (void)read_surface(path); });
  expect("s.yaml", [](const auto& path) { (void)read_scene(path); });
  expect("h.yaml", [](const auto& path) { (void)read_hardware(path); });
  expect("c.yaml", [](const auto& path) { (void)read_actuator_curve(path); });
  expect("t.csv", [](const auto& path) { (void)read_path(path); });
  expect("d.csv", [](const auto& path) { (void)read_directions(path); });
  expect("f.csv", [](const auto& path) { (void)read_field_samples(path); });
  expect("side.txt", [](const auto& path) { (void)read_sidecar(path); });
}

/// A mesh that a scene names.
TEST(LfsPointers, OfASceneAreNamedWithTheLineOfTheScene) {
  MeshFolder folder;
  folder.write("a.msh", lfs_pointer);
  const auto scene = folder.write("s.yaml", "softkin: 1\nmesh: {file: a.msh}\n");
  try {
    (void)read_scene(scene);
    ADD_FAILURE() << "read";
  } catch (const InvalidInput& error) {
    const std::string what = error.what();
    EXPECT_TRUE(what.starts_with(scene.string() + ":2: ")) << what;
    EXPECT_TRUE(what.ends_with("a.msh: is a Git LFS pointer, not the file itself; run `git lfs pull`")) << what;
  }
}

/// A text that only speaks of them is none.
TEST(LfsPointers, OtherTextsAreNot) {
  MeshFolder folder;
  EXPECT_EQ(read_file(folder.write("a.txt", "# " + lfs_pointer)), "# " + lfs_pointer);
  EXPECT_NO_THROW(refuse_lfs_pointer(folder.write("b.txt", "")));
  EXPECT_THROW(refuse_lfs_pointer(folder.write("c.txt", lfs_pointer)), InvalidInput);
}

}  // namespace
}  // namespace softkin
