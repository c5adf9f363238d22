#include <gtest/gtest.h>

#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <string>

#include "text_mesh_files.hpp"

namespace softkin {
namespace {

using namespace text_mesh_tests;

TEST(MeshIo, ExtensionsInAnyCase) {
  MeshFolder folder;
  const Mesh mesh = read_mesh(folder.write("a.INP", abaqus_file));
  for (const char* name : {"b.msh", "b.VTU"}) {
    write_mesh(folder / name, mesh);
    const Mesh back = read_mesh(folder / name);
    EXPECT_EQ(back.vertices, mesh.vertices) << name;
    EXPECT_EQ(back.tetrahedra, mesh.tetrahedra) << name;
    EXPECT_EQ(back.prisms, mesh.prisms) << name;
  }
  EXPECT_EQ(read_mesh(folder.write("m.mesh", medit_file)).prisms.size(), 1u);
  for (const auto& [name, content] : tetgen_files) folder.write(name, content);
  EXPECT_EQ(read_mesh(folder / "a.ele").tetrahedra.size(), 2u);
  EXPECT_EQ(read_mesh(folder / "a.node").tetrahedra.size(), 2u);
}

TEST(MeshIo, BoundaryPointsOutwardsWhateverTheElementsDo) {
  MeshFolder folder;
  write_mesh(folder / "t.stl", read_mesh(folder.write("t.tet", tet_file)));  // its second tet is reversed
  const TriangleSurface surface = read_stl(folder / "t.stl");
  EXPECT_NEAR(enclosed_volume(surface.vertices, surface.triangles), 1.0 / 3, 1e-6);
  Mesh mesh = read_mesh(folder.write("m.mesh", medit_file));
  mesh.prisms[0] = {mesh.prisms[0][3], mesh.prisms[0][4], mesh.prisms[0][5],
                    mesh.prisms[0][0], mesh.prisms[0][1], mesh.prisms[0][2]};
  write_mesh(folder / "m.stl", mesh);
  const TriangleSurface whole = read_stl(folder / "m.stl");
  EXPECT_NEAR(enclosed_volume(whole.vertices, whole.triangles), 1.0 / 3 + 0.5, 1e-6);
}

TEST(MeshIo, UnknownExtensionsListTheKnown) {
  const auto message = [](const auto& action) -> std::string {
    try {
      action();
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  for (const char* name : {"x.meshb", "x", "x.stl"})
    EXPECT_NE(message([&] { (void)read_mesh(name); }).find("known: .msh, .vtk, .vtu, .mesh, .node, .ele, .inp, .tet"),
              std::string::npos);
  EXPECT_NE(message([] { write_mesh("x.tet", Mesh{}); }).find("known: .msh, .vtu, .stl"), std::string::npos);
}

}  // namespace
}  // namespace softkin
