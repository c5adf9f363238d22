#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/vtk.hpp>

#include "gmsh_samples.hpp"
#include "text_mesh_files.hpp"
#include "vtk_files.hpp"

namespace softkin {
namespace {

using gmsh_samples::kQuadratic2;
using gmsh_samples::kQuadratic4;
using gmsh_samples::replaced;
using List = std::vector<Index>;

const Region& region(const Mesh& mesh, const std::string& name) {
  return vtk_files::region(mesh, name);
}

Vec3 at(const Mesh& mesh, Index vertex) {
  return mesh.vertices.row(vertex).transpose();
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const Tetrahedron& element : mesh.tetrahedra) sum += signed_volume(mesh.vertices, element);
  return sum;
}

/// Every edge node is in the middle of its edge, so each is at its place in EdgeNodes.
void expect_nodes_on_edges(const Mesh& mesh) {
  ASSERT_EQ(mesh.edge_nodes.size(), mesh.tetrahedra.size());
  EXPECT_TRUE(mesh.prisms.empty());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
    for (std::size_t k = 0; k < 6; ++k) {
      const Vec3 a = at(mesh, mesh.tetrahedra[e][tetrahedron_edges[k][0]]);
      const Vec3 b = at(mesh, mesh.tetrahedra[e][tetrahedron_edges[k][1]]);
      EXPECT_LT((at(mesh, mesh.edge_nodes[e][k]) - (a + b) / 2).norm(), 1e-9) << "element " << e << " edge " << k;
    }
}

void expect_same(const Mesh& found, const Mesh& expected) {
  EXPECT_EQ(found.vertices, expected.vertices);
  EXPECT_EQ(found.tetrahedra, expected.tetrahedra);
  EXPECT_EQ(found.edge_nodes, expected.edge_nodes);
  EXPECT_EQ(found.triangles, expected.triangles);
  ASSERT_EQ(found.regions.size(), expected.regions.size());
  for (std::size_t r = 0; r < found.regions.size(); ++r) {
    EXPECT_EQ(found.regions[r].name, expected.regions[r].name);
    EXPECT_EQ(found.regions[r].tetrahedra, expected.regions[r].tetrahedra);
    EXPECT_EQ(found.regions[r].triangles, expected.regions[r].triangles);
    EXPECT_EQ(found.regions[r].vertices, expected.regions[r].vertices);
  }
}

Mesh read_gmsh_text(const std::string& content) {
  return read_gmsh("sample.msh", content);
}

TEST(Order2, GmshInEveryForm) {
  const Mesh mesh = read_gmsh_text(kQuadratic2);
  EXPECT_EQ(mesh.vertices.rows(), 10);
  EXPECT_NEAR(volume(mesh), 8, 1e-12);
  expect_nodes_on_edges(mesh);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(region(mesh, "body").tetrahedra, List{0});
  EXPECT_EQ(region(mesh, "base").triangles, List{0});
  EXPECT_EQ(region(mesh, "edge").vertices, (List{1, 3, 8}));
  EXPECT_EQ(region(mesh, "tip").vertices, List{3});
  expect_same(read_gmsh_text(kQuadratic4), mesh);
  for (const bool swapped : {false, true}) {
    expect_same(read_gmsh_text(gmsh_samples::binary_2(swapped, kQuadratic2)), mesh);
    expect_same(read_gmsh_text(gmsh_samples::binary_4(swapped, kQuadratic4)), mesh);
  }
}

TEST(Order2, GmshElementOfTwoGroupsIsStoredOnce) {
  const std::string second = "4 11 2 1 1 1 3 4 2 7 10 8 5 9 6\n5 11 2 7 1 3 1 4 2 7 8 10 6 9 5\n";
  const std::string twice = replaced(kQuadratic2, "4 11 2 1 1 1 3 4 2 7 10 8 5 9 6\n", second);
  const Mesh mesh = read_gmsh_text(replaced(twice, "$Elements\n4\n", "$Elements\n5\n"));
  EXPECT_EQ(mesh.tetrahedra.size(), 1u);
  EXPECT_EQ(region(mesh, "physical_3_7").tetrahedra, List{0});
  expect_nodes_on_edges(mesh);
}

TEST(Order2, GmshRefusals) {
  const auto with = [](const std::string& element) {
    const std::string more = "4 11 2 1 1 1 3 4 2 7 10 8 5 9 6\n" + element + "\n";
    return gmsh_samples::refusal(
        replaced(replaced(kQuadratic2, "4 11 2 1 1 1 3 4 2 7 10 8 5 9 6\n", more), "$Elements\n4\n", "$Elements\n5\n"),
        "a.msh");
  };
  const std::string mixed = "a.msh:30: tetrahedra of order 1 and of order 2 in one mesh are not supported";
  EXPECT_TRUE(with("5 4 2 1 1 1 3 4 2").starts_with(mixed)) << with("5 4 2 1 1 1 3 4 2");
  EXPECT_TRUE(with("5 4 2 1 1 5 6 7 8").starts_with(mixed));
  EXPECT_TRUE(with("5 6 2 1 1 1 2 3 4 5 6").starts_with("a.msh:30: tetrahedra of order 2 beside prisms"));
  EXPECT_TRUE(with("5 13 2 1 1 1 2 3").starts_with("a.msh:30: second-order prisms (type 13) are not supported"));
  EXPECT_TRUE(
      with("5 11 2 1 1 1 3 4 2 7 10 8 5 9 1").starts_with("a.msh:30: two tetrahedra have the same corners but"));
  EXPECT_TRUE(with("5 11 2 1 1 1 3 4 2 7 10 8 5 9 99").starts_with("a.msh:30: element 5 names node 99"));
  const std::string first =
      gmsh_samples::refusal(replaced(replaced(kQuadratic2, "4 11 2 1 1", "5 4 2 1 1 1 3 4 2\n4 11 2 1 1"),
                                     "$Elements\n4\n", "$Elements\n5\n"),
                            "a.msh");
  EXPECT_TRUE(first.starts_with(mixed)) << first;
}

TEST(Order2, VtkLegacy) {
  const vtk_files::TempFolder folder;
  const Mesh mesh = read_vtk(folder.write("a.vtk", vtk_files::kQuadraticLegacy));
  expect_nodes_on_edges(mesh);
  EXPECT_NEAR(volume(mesh), 8, 1e-12);
  EXPECT_EQ(region(mesh, "CellEntityIds_1").tetrahedra, List{0});
  EXPECT_EQ(region(mesh, "CellEntityIds_2").triangles, List{0});
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(region(mesh, "CellEntityIds_3").vertices, (List{1, 3, 8}));
  EXPECT_EQ(region(mesh, "CellEntityIds_4").vertices, List{3});
}

TEST(Order2, Medit) {
  const text_mesh_tests::MeshFolder folder;
  const Mesh mesh = read_medit(folder.write("q.mesh", text_mesh_tests::quadratic_medit_file));
  expect_nodes_on_edges(mesh);
  EXPECT_NEAR(volume(mesh), 8 - 8, 1e-12);
  EXPECT_EQ(region(mesh, "ref_2").tetrahedra, List{1});
  EXPECT_EQ(region(mesh, "surface_ref_1").triangles, List{0});
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(Order2, MeditMayHoldEmptySectionsOfTheOtherOrder) {
  const text_mesh_tests::MeshFolder folder;
  const std::string text =
      replaced(text_mesh_tests::quadratic_medit_file, " End", " Tetrahedra\n 0\n Triangles\n 0\n End");
  const Mesh mesh = read_medit(folder.write("q.mesh", text));
  expect_nodes_on_edges(mesh);
  EXPECT_EQ(mesh.triangles.size(), 1u);
}

TEST(Order2, Tetgen) {
  const text_mesh_tests::MeshFolder folder;
  for (const auto& [name, content] : text_mesh_tests::quadratic_tetgen_files) folder.write(name, content);
  const Mesh mesh = read_tetgen(folder / "q.node");
  expect_nodes_on_edges(mesh);
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 2, 3, 1}, {0, 1, 2, 10}}));
  EXPECT_EQ(region(mesh, "attribute_2").tetrahedra, List{1});
  EXPECT_EQ(region(mesh, "marker_4").triangles, List{0});
  folder.write("q.face", "1 0\n1 1 2 3 6 7 5\n");
  EXPECT_TRUE(read_tetgen(folder / "q.node").triangles.empty());
  folder.write("q.face", "1 1\n1 1 2 3 8\n");
  EXPECT_EQ(region(read_tetgen(folder / "q.node"), "marker_8").triangles, List{0});
}

TEST(Order2, Abaqus) {
  const text_mesh_tests::MeshFolder folder;
  const Mesh mesh = read_abaqus(folder.write("q.inp", text_mesh_tests::quadratic_abaqus_file));
  expect_nodes_on_edges(mesh);
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 2, 3, 1}, {0, 1, 2, 10}}));
  EXPECT_EQ(region(mesh, "upper").tetrahedra, List{0});
  EXPECT_EQ(region(mesh, "of_lower").vertices, (List{0, 1, 2, 4, 5, 6, 10, 11, 12, 13}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

/// Two tetrahedra with curved edges, one of them reversed, their common side in a region, and one vertex in another.
Mesh curved_mesh() {
  const text_mesh_tests::MeshFolder folder;
  Mesh mesh = read_abaqus(folder.write("q.inp", text_mesh_tests::quadratic_abaqus_file));
  mesh.vertices.row(8) += Eigen::RowVector3d(0.1, 0.2, 0.3);
  std::swap(mesh.tetrahedra[0][2], mesh.tetrahedra[0][3]);
  std::swap(mesh.edge_nodes[0][1], mesh.edge_nodes[0][4]);
  std::swap(mesh.edge_nodes[0][2], mesh.edge_nodes[0][3]);
  mesh.regions = {
      {"between", 2, {}, {}, {0}, {}, {}}, {"upper", 3, {0}, {}, {}, {}, {}}, {"tip", 0, {}, {}, {}, {}, {8}}};
  return mesh;
}

TEST(Order2, WrittenGmshReadsBackTheSame) {
  const text_mesh_tests::MeshFolder folder;
  const Mesh mesh = curved_mesh();
  for (const bool binary : {false, true}) {
    write_gmsh(folder / "a.msh", mesh, binary);
    expect_same(read_gmsh(folder / "a.msh"), mesh);
  }
  Mesh with_loose_triangle = mesh;
  with_loose_triangle.triangles[0] = {0, 1, 8};  // no side of a tetrahedron, so its edge nodes are not known
  write_gmsh(folder / "a.msh", with_loose_triangle);
  expect_same(read_gmsh(folder / "a.msh"), with_loose_triangle);
}

TEST(Order2, GmshIsWrittenWithCellsOfOrder2) {
  const text_mesh_tests::MeshFolder folder;
  Mesh mesh = read_gmsh_text(kQuadratic2);
  write_gmsh(folder / "a.msh", mesh, false);
  const std::string text = vtk_files::slurp(folder / "a.msh");
  EXPECT_NE(text.find("\n2 1 9 1\n4 1 2 3 5 6 7\n"), std::string::npos) << text;  // as Gmsh wrote it
  EXPECT_NE(text.find("\n3 1 11 1\n5 1 3 4 2 7 10 8 5 9 6\n"), std::string::npos) << text;
}

TEST(Order2, WrittenVtuReadsBackTheSame) {
  const text_mesh_tests::MeshFolder folder;
  const Mesh mesh = curved_mesh();
  write_mesh(folder / "a.vtu", mesh);
  const Mesh read = read_mesh(folder / "a.vtu");
  EXPECT_EQ(read.vertices, mesh.vertices);
  EXPECT_EQ(read.tetrahedra, mesh.tetrahedra);
  EXPECT_EQ(read.edge_nodes, mesh.edge_nodes);
  EXPECT_EQ(region(read, "upper").tetrahedra, List{0});
}

TEST(Order2, BoundaryHasFourFacetsAFaceAndPointsOutwards) {
  const text_mesh_tests::MeshFolder folder;
  Mesh mesh = curved_mesh();
  write_mesh(folder / "a.stl", mesh);
  const TriangleSurface surface = read_stl(folder / "a.stl");
  EXPECT_EQ(surface.triangles.size(), 4u * 6u);
  EXPECT_EQ(surface.vertices.rows(), 14);
  mesh.vertices.row(8) -= Eigen::RowVector3d(0.1, 0.2, 0.3);
  write_mesh(folder / "flat.stl", mesh);
  const TriangleSurface flat = read_stl(folder / "flat.stl");
  EXPECT_NEAR(enclosed_volume(flat.vertices, flat.triangles), 16, 1e-5);
}

TEST(Order2, WritersRefuseMixedOrders) {
  const text_mesh_tests::MeshFolder folder;
  Mesh mesh = curved_mesh();
  mesh.edge_nodes.pop_back();
  Mesh prism = curved_mesh();
  prism.prisms.push_back({0, 1, 2, 3, 4, 5});
  Mesh outside = curved_mesh();
  outside.edge_nodes[1][3] = 14;
  for (const char* name : {"a.msh", "a.vtu"}) {
    const auto refusal = [&](const Mesh& bad) { return vtk_files::refusal([&] { write_mesh(folder / name, bad); }); };
    EXPECT_NE(refusal(mesh).find("tetrahedra of order 1 and of order 2"), std::string::npos) << refusal(mesh);
    EXPECT_NE(refusal(prism).find("tetrahedra of order 2 beside prisms"), std::string::npos) << refusal(prism);
    EXPECT_NE(refusal(outside).find("tetrahedron 1 has"), std::string::npos) << refusal(outside);
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  }
}

}  // namespace
}  // namespace softkin
