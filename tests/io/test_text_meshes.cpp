#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <sstream>

#include "support/skips.hpp"
#include "text_mesh_files.hpp"

namespace softkin {
namespace {

using namespace text_mesh_tests;
using Indices = std::vector<Index>;

const Region& region_of_dimension(const Mesh& mesh, const std::string& name, int dimension) {
  static const Region none;
  for (const Region& r : mesh.regions)
    if (r.name == name && r.dimension == dimension) return r;
  ADD_FAILURE() << "no region " << name << " of dimension " << dimension;
  return none;
}

TEST(TextMeshes, Medit) {
  MeshFolder folder;
  const Mesh mesh = read_medit(folder.write("a.mesh", medit_file));
  expect_consistent(mesh);
  ASSERT_EQ(mesh.vertices.rows(), 9);
  EXPECT_EQ(mesh.vertices.row(6), Eigen::RowVector3d(-1, 0, 1));
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {0, 2, 1, 4}}));
  EXPECT_EQ(mesh.prisms, (std::vector<Prism>{{0, 2, 5, 3, 8, 6}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}}));
  EXPECT_EQ(mesh.quads, (std::vector<Quad>{{0, 2, 8, 3}}));
  ASSERT_EQ(mesh.regions.size(), 4u);
  EXPECT_EQ(region_of_dimension(mesh, "ref_7", 3).tetrahedra, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "ref_7", 3).prisms, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "ref_-2", 3).tetrahedra, Indices{1});
  EXPECT_EQ(region_of_dimension(mesh, "surface_ref_1", 2).triangles, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "surface_ref_2", 2).triangles, Indices{1});
  EXPECT_EQ(region_of_dimension(mesh, "surface_ref_2", 2).quads, Indices{0});
}

TEST(TextMeshes, MeditOnOneLineWithWindowsEnds) {
  MeshFolder folder;
  const Mesh mesh =
      read_medit(folder.write("a.mesh",
                              "MeshVersionFormatted 1\r\nDimension 3\r\nVertices 4 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0\r\n"
                              "Tetrahedra 1 1 2 3 4 0\r\nEnd"));
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
  EXPECT_EQ(region_of_dimension(mesh, "ref_0", 3).tetrahedra, Indices{0});
}

TEST(TextMeshes, TetgenFromOne) {
  MeshFolder folder;
  for (const auto& [name, content] : tetgen_files) folder.write(name, content);
  for (const char* name : {"a.node", "a.ele"}) {
    const Mesh mesh = read_tetgen(folder / name);
    expect_consistent(mesh);
    ASSERT_EQ(mesh.vertices.rows(), 5);
    EXPECT_EQ(mesh.vertices.row(4), Eigen::RowVector3d(0, 0, -1));
    EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {0, 2, 1, 4}}));
    EXPECT_EQ(region_of_dimension(mesh, "attribute_3", 3).tetrahedra, Indices{0});
    EXPECT_EQ(region_of_dimension(mesh, "attribute_10", 3).tetrahedra, Indices{1});
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}, {0, 2, 4}}));
    EXPECT_EQ(region_of_dimension(mesh, "marker_0", 2).triangles, Indices{0});
    EXPECT_EQ(region_of_dimension(mesh, "marker_-1", 2).triangles, (Indices{1, 2}));
    EXPECT_EQ(mesh.regions.size(), 4u);
  }
}

TEST(TextMeshes, TetgenFromZeroWithoutMarkers) {
  MeshFolder folder;
  folder.write("b.node", "4 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1");
  const auto elements = folder.write("b.ele", "1\n0 0 1 2 3");
  folder.write("b.face", "1 0\n0 0 1 2\n");
  const Mesh mesh = read_tetgen(elements);
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
  EXPECT_TRUE(mesh.regions.empty());
  EXPECT_TRUE(mesh.triangles.empty());  // no region names them
}

TEST(TextMeshes, TetgenTakesTheLastAttribute) {
  MeshFolder folder;
  folder.write("b.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n");
  const Mesh mesh = read_tetgen(folder.write("b.ele", "1 4 2\n0 0 1 2 3 0.25 6\n"));
  ASSERT_EQ(mesh.regions.size(), 1u);
  EXPECT_EQ(mesh.regions[0].name, "attribute_6");
}

TEST(TextMeshes, Abaqus) {
  MeshFolder folder;
  const Mesh mesh = read_abaqus(folder.write("a.inp", abaqus_file));
  expect_consistent(mesh);
  ASSERT_EQ(mesh.vertices.rows(), 9);
  EXPECT_EQ(mesh.vertices.row(4), Eigen::RowVector3d(0, 0, -1));
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {0, 2, 1, 4}}));
  EXPECT_EQ(mesh.prisms, (std::vector<Prism>{{0, 2, 5, 3, 8, 7}}));
  ASSERT_EQ(mesh.regions.size(), 8u);
  EXPECT_EQ(region_of_dimension(mesh, "Body", 3).tetrahedra, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "Body", 3).prisms, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "low", 3).tetrahedra, Indices{1});
  EXPECT_EQ(region_of_dimension(mesh, "every one", 3).tetrahedra, (Indices{0, 1}));
  EXPECT_EQ(region_of_dimension(mesh, "every one", 3).prisms, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "all", 0).vertices, (Indices{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(region_of_dimension(mesh, "feet", 0).vertices, (Indices{0, 1, 2, 3, 4}));
  EXPECT_EQ(region_of_dimension(mesh, "more", 0).vertices, (Indices{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(region_of_dimension(mesh, "of_low", 0).vertices, (Indices{0, 1, 2, 4}));
  // S1 of 7: 10 30 20; of Body: S2 of 100: 10 40 20, of 101: 40 63 64; S3 of 100: 20 40 30, of 101: 10 40 64 30
  const Region& skin = region_of_dimension(mesh, "skin", 2);
  EXPECT_EQ(skin.triangles, (Indices{0, 1, 2, 3}));
  EXPECT_EQ(skin.quads, Indices{0});
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 2, 1}, {0, 3, 1}, {3, 7, 8}, {1, 3, 2}}));
  EXPECT_EQ(mesh.quads, (std::vector<Quad>{{0, 3, 8, 2}}));
}

/// A deck in pieces is the deck: keywords, data of a keyword that stands before, files in files and in folders.
TEST(TextMeshes, AbaqusIncludedFilesAreReadInTheirPlace) {
  MeshFolder whole, parts;
  const Mesh mesh = read_abaqus(whole.write("a.inp", abaqus_file));
  std::vector<std::string> lines;
  for (std::size_t begin = 0, end = 0; begin < abaqus_file.size(); begin = end + 1) {
    end = std::min(abaqus_file.find('\n', begin), abaqus_file.size());
    lines.push_back(abaqus_file.substr(begin, end - begin) + "\n");
  }
  std::filesystem::create_directory(parts / "mesh");
  for (std::size_t cut = 0; cut + 4 < lines.size(); ++cut) {
    const auto text = [&](std::size_t from, std::size_t to) {
      return std::accumulate(lines.begin() + static_cast<std::ptrdiff_t>(from),
                             lines.begin() + static_cast<std::ptrdiff_t>(to), std::string());
    };
    parts.write("mesh/in.inp", text(cut + 1, cut + 2));
    parts.write("mesh/out file.inp",
                text(cut, cut + 1) + "** comment\n*include,\n  Input = mesh/in.inp\n" + text(cut + 2, cut + 3));
    const auto deck =
        parts.write("a.inp", text(0, cut) + "*INCLUDE, INPUT=\"mesh\\out file.inp\"\n" + text(cut + 3, lines.size()));
    const Mesh read = read_abaqus(deck);
    ASSERT_EQ(read.vertices, mesh.vertices) << cut;
    ASSERT_EQ(read.tetrahedra, mesh.tetrahedra) << cut;
    ASSERT_EQ(read.prisms, mesh.prisms) << cut;
    ASSERT_EQ(read.regions.size(), mesh.regions.size()) << cut;
    for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
      EXPECT_EQ(read.regions[i].name, mesh.regions[i].name);
      EXPECT_EQ(read.regions[i].vertices, mesh.regions[i].vertices);
      EXPECT_EQ(read.regions[i].triangles, mesh.regions[i].triangles);
      EXPECT_EQ(read.regions[i].tetrahedra, mesh.regions[i].tetrahedra);
    }
  }
}

/// As sfepy's: sections are complete by their counts.
TEST(TextMeshes, MeditWithoutEnd) {
  MeshFolder folder;
  const Mesh whole = read_medit(folder.write("a.mesh", medit_file));
  const std::string text = medit_file.substr(0, medit_file.rfind("End"));
  for (const std::string& content : {text, text.substr(0, text.find_last_not_of(" \n") + 1)}) {
    const Mesh mesh = read_medit(folder.write("b.mesh", content));
    EXPECT_EQ(mesh.vertices, whole.vertices);
    EXPECT_EQ(mesh.tetrahedra, whole.tetrahedra);
    EXPECT_EQ(mesh.prisms, whole.prisms);
    EXPECT_EQ(mesh.regions.size(), whole.regions.size());
  }
}

/// For robots of layers alone.
TEST(TextMeshes, TrianglesAlone) {
  MeshFolder folder;
  const std::string corners = "0 0 0 0\n1 0 0 0\n0 1 0 0\n1 1 0 0\n";
  const Mesh medit = read_medit(folder.write(
      "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n" + corners + "Triangles\n2\n1 2 3 5\n2 4 3 6\n"));
  EXPECT_EQ(medit.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(region_of_dimension(medit, "surface_ref_6", 2).triangles, Indices{1});
  const Mesh abaqus = read_abaqus(folder.write("a.inp",
                                               "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,1,1,0\n*ELEMENT, TYPE=M3D3, "
                                               "ELSET=film\n1,1,2,3\n2,2,4,3\n"));
  EXPECT_EQ(abaqus.triangles, medit.triangles);
  EXPECT_EQ(region_of_dimension(abaqus, "film", 2).triangles, (Indices{0, 1}));
}

TEST(TextMeshes, AbaqusFacesAreTheFacesOfTheElement) {
  // every face leaves out the vertices that lie on one side of it, and all faces together close the element
  MeshFolder folder;
  const std::string head =
      "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,0,1\n6,0,1,1\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n"
      "*ELEMENT,TYPE=C3D6\n2,1,2,3,4,5,6\n";
  const Mesh tetrahedron = read_abaqus(folder.write("a.inp", head + "*SURFACE,NAME=s\n1,S1\n1,S2\n1,S3\n1,S4\n"));
  EXPECT_NEAR(enclosed_volume(tetrahedron.vertices, tetrahedron.triangles), -1.0 / 6, 1e-15);
  const Mesh prism = read_abaqus(folder.write("b.inp", head + "*SURFACE,NAME=s\n2,S1\n2,S2\n2,S3\n2,S4\n2,S5\n"));
  std::vector<Triangle> closed = prism.triangles;
  ASSERT_EQ(prism.quads.size(), 3u);
  for (const Quad& q : prism.quads) {
    closed.push_back({q[0], q[1], q[2]});
    closed.push_back({q[0], q[2], q[3]});
  }
  EXPECT_NEAR(enclosed_volume(prism.vertices, closed), -0.5, 1e-15);
}

TEST(TextMeshes, AbaqusSurfacesShareFaces) {
  MeshFolder folder;
  const Mesh mesh =
      read_abaqus(folder.write("a.inp",
                               "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n"
                               "*SURFACE,NAME=a\n1,S1\n1,S2\n*SURFACE,NAME=b\n1,S3\n1,S1\n1,S1\n"));
  EXPECT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(region_of_dimension(mesh, "a", 2).triangles, (Indices{0, 1}));
  EXPECT_EQ(region_of_dimension(mesh, "b", 2).triangles, (Indices{0, 2}));
}

TEST(TextMeshes, AbaqusPartAndInstance) {
  MeshFolder folder;
  const Mesh mesh = read_abaqus(folder.write(
      "a.inp",
      "*Heading\n*Part, name=Part-1\n*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4\n1, 1,2,3,4\n"
      "*Nset, nset=inner, generate\n1, 3, 1\n*Solid Section, elset=inner, material=rubber\n,\n*End Part\n"
      "*Assembly, name=Assembly\n*Instance, name=Part-1-1, part=PART-1\n0., 0., 0.\n*End Instance\n"
      "*Nset, nset=tip, instance=Part-1-1\n 4,\n*Elset, elset=_skin_S2, internal, instance=part-1-1\n 1,\n"
      "*Nset, nset=mixed\n part-1-1.2, Part-1-1.inner\n"
      "*Surface, type=ELEMENT, name=skin\n_skin_S2, S2\n*End Assembly\n*Material, name=rubber\n"));
  expect_consistent(mesh);
  EXPECT_EQ(mesh.tetrahedra.size(), 1u);
  EXPECT_EQ(region_of_dimension(mesh, "inner", 0).vertices, (Indices{0, 1, 2}));
  EXPECT_EQ(region_of_dimension(mesh, "tip", 0).vertices, Indices{3});
  EXPECT_EQ(region_of_dimension(mesh, "mixed", 0).vertices, (Indices{0, 1, 2}));
  EXPECT_EQ(region_of_dimension(mesh, "_skin_S2", 3).tetrahedra, Indices{0});
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 3, 1}}));
}

/// As Gmsh writes all groups of a model, and meshio and CalculiX their own names of elements.
TEST(TextMeshes, AbaqusFlatElementsAndLinesAreRegions) {
  MeshFolder folder;
  const Mesh mesh = read_abaqus(
      folder.write("a.inp",
                   "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,0,1\n6,0,1,1\n"
                   "*ELEMENT, type=T3D2, ELSET=Line1\n1, 1, 2\n2, 2, 3\n"
                   "*ELEMENT, type=CPS3, ELSET=Surface1\n3, 1, 3, 2\n*ELEMENT, TYPE=S3R, ELSET=top\n4, 4, 5, 6\n"
                   "*ELEMENT, TYPE=R3D4, ELSET=side\n5, 1, 2, 5, 4\n"
                   "*ELEMENT, type=C3D6, ELSET=Volume1\n6, 1, 2, 3, 4, 5, 6\n"
                   "*ELSET, ELSET=both\nSurface1, Volume1\n*ELSET, ELSET=faces\ntop, side, Line1\n"
                   "*NSET, NSET=of_line, ELSET=Line1\n*SURFACE, NAME=lid\ntop, SPOS\n6, S1\n"
                   "*SURFACE, NAME=some, TYPE=NODE\nof_line, 1.\n4, 1.\n"));
  expect_consistent(mesh);
  EXPECT_EQ(mesh.prisms.size(), 1u);
  EXPECT_EQ(region_of_dimension(mesh, "Line1", 1).vertices, (Indices{0, 1, 2}));
  EXPECT_EQ(region_of_dimension(mesh, "Surface1", 2).triangles, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "side", 2).quads, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "both", 3).prisms, Indices{0});
  EXPECT_TRUE(region_of_dimension(mesh, "both", 3).triangles.empty());
  EXPECT_EQ(region_of_dimension(mesh, "faces", 2).triangles, Indices{1});
  EXPECT_EQ(region_of_dimension(mesh, "faces", 2).quads, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "lid", 2).triangles, (Indices{1, 2}));
  EXPECT_EQ(mesh.triangles[2], (Triangle{0, 1, 2}));
  EXPECT_EQ(region_of_dimension(mesh, "some", 0).vertices, (Indices{0, 1, 2, 3}));
}

TEST(TextMeshes, AbaqusFormulationsOfATetrahedronAreOneShape) {
  MeshFolder folder;
  std::string file = text_mesh_tests::quadratic_abaqus_file;
  const Mesh plain = read_abaqus(folder.write("a.inp", file));
  for (const char* type : {"C3D10M", "C3D10H", "C3D10MH", "C3D10T"}) {
    std::string other = file;
    for (std::size_t at = 0; (at = other.find("C3D10,", at)) != std::string::npos; at += 6) other.replace(at, 5, type);
    const Mesh mesh = read_abaqus(folder.write("b.inp", other));
    EXPECT_EQ(mesh.tetrahedra, plain.tetrahedra) << type;
    EXPECT_EQ(mesh.edge_nodes, plain.edge_nodes) << type;
  }
}

TEST(TextMeshes, AbaqusSetsOfSetsStaySmall) {
  // each set names its predecessor 30 times: without care 30^40 entries
  std::string deck = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n*NSET,NSET=s0\n1,3\n";
  for (int i = 1; i <= 40; ++i) {
    deck += "*NSET,NSET=s" + std::to_string(i) + "\n";
    for (int k = 0; k < 30; ++k) deck += "s" + std::to_string(i - 1) + ",";
    deck += "\n";
  }
  MeshFolder folder;
  const Mesh mesh = read_abaqus(folder.write("a.inp", deck));
  EXPECT_EQ(region_of_dimension(mesh, "s40", 0).vertices, (Indices{0, 2}));
}

TEST(TextMeshes, TetKeepsDoublesAndOrientation) {
  MeshFolder folder;
  const Mesh mesh = read_tet(folder.write("a.tet", tet_file));
  expect_consistent(mesh);
  ASSERT_EQ(mesh.vertices.rows(), 5);
  EXPECT_EQ(mesh.vertices(1, 0), 1.0000000000000002);
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {0, 1, 2, 4}}));
  EXPECT_GT(signed_volume(mesh.vertices, mesh.tetrahedra[0]), 0);
  EXPECT_LT(signed_volume(mesh.vertices, mesh.tetrahedra[1]), 0);
  EXPECT_TRUE(mesh.regions.empty());
}

TEST(TextMeshes, TetWithSidecars) {
  MeshFolder folder;
  const auto path = folder.write("a.tet", tet_file);
  folder.write("a_chamber.txt", "1:0:0:1:\n2:0:0:0:\n");
  folder.write("a_rigid_handle.txt", "0:1:0\n1:1:0\n2:0:0\n3:0:1\n4:1:1\n");
  const Mesh mesh = read_tet(path);
  ASSERT_EQ(mesh.regions.size(), 3u);
  EXPECT_EQ(region_of_dimension(mesh, "chamber3", 3).tetrahedra, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "handle", 0).vertices, (Indices{0, 1, 4}));
  EXPECT_EQ(region_of_dimension(mesh, "rigid", 0).vertices, (Indices{3, 4}));
  folder.write("a_chamber.txt", "0\r\n1\r\n\r\n");
  EXPECT_EQ(region_of_dimension(read_tet(path), "chamber", 3).tetrahedra, Indices{1});
}

TEST(TextMeshes, TetWithSidecarsAsPublished) {
  MeshFolder folder;
  const auto path = folder.write("soro_body.tet", tet_file);
  folder.write("soro_chamber.txt", "0:1:0:0:\n1:0:0:1:\n");
  folder.write("soro_rigid_handle.txt", "0:1:0:\n1:1:0:\n2:0:0:\n3:0:1:\n4:0:0:\n");
  const Mesh mesh = read_tet(path);
  EXPECT_EQ(region_of_dimension(mesh, "chamber1", 3).tetrahedra, Indices{0});
  EXPECT_EQ(region_of_dimension(mesh, "chamber3", 3).tetrahedra, Indices{1});
  EXPECT_EQ(region_of_dimension(mesh, "handle", 0).vertices, (Indices{0, 1}));
  EXPECT_EQ(region_of_dimension(mesh, "rigid", 0).vertices, Indices{3});
  EXPECT_TRUE(mesh.missing.empty());

  folder.write("soro_body_chamber.txt", "0\n1\n");
  try {
    (void)read_tet(path);
    ADD_FAILURE() << "one of two sidecars was taken";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(error.what(), path.string() + ": soro_body_chamber.txt and soro_chamber.txt are both there: remove one");
  }
  std::filesystem::remove(folder / "soro_chamber.txt");
  EXPECT_EQ(region_of_dimension(read_tet(path), "chamber", 3).tetrahedra, Indices{1});
}

TEST(TextMeshes, TetSaysWhichSidecarsItLookedFor) {
  MeshFolder folder;
  const auto plain = folder.write("finger.tet", tet_file), body = folder.write("soro_body.tet", tet_file);
  const Mesh alone = read_tet(plain);
  EXPECT_TRUE(alone.no_sidecars);
  EXPECT_EQ(alone.missing,
            (std::vector<std::string>{
                "no chambers of finger.tet are known: there is no finger_chamber.txt beside it",
                "no handle and rigid part of finger.tet are known: there is no finger_rigid_handle.txt beside it"}));
  EXPECT_EQ(
      read_tet(body).missing.at(0),
      "no chambers of soro_body.tet are known: there is no soro_body_chamber.txt and no soro_chamber.txt beside it");
  folder.write("soro_chamber.txt", "0\n1\n");
  EXPECT_FALSE(read_tet(body).no_sidecars);
  EXPECT_EQ(read_tet(body).missing.size(), 1u);
}

TEST(TextMeshes, Sidecar) {
  MeshFolder folder;
  const Sidecar numbered = read_sidecar(folder.write("a.txt", "0:0:1:\n1:1:1:\n2:0:0:\n"));
  EXPECT_EQ(numbered.rows, 3);
  EXPECT_FALSE(numbered.bare);
  EXPECT_EQ(numbered.columns, (std::vector<Indices>{{1}, {0, 1}}));
  const Sidecar bare = read_sidecar(folder.write("b.txt", "0\n0\n1"));
  EXPECT_EQ(bare.rows, 3);
  EXPECT_TRUE(bare.bare);
  EXPECT_EQ(bare.columns, (std::vector<Indices>{{2}}));
}

std::filesystem::path reference_folder() {
  const char* folder = std::getenv("SOFTKIN_REFERENCE");
  return folder ? std::filesystem::path(folder) : std::filesystem::path(SOFTKIN_SOURCE_DIR "/../shared/reference");
}

TEST(TextMeshes, ReferenceRobot) {
  const std::filesystem::path folder = reference_folder() / "target-shape";
  SKIP_WITHOUT_REFERENCE((folder / "robot3_s.tet").string());
  const Mesh mesh = read_tet(folder / "robot3_s.tet");
  expect_consistent(mesh);
  EXPECT_EQ(mesh.vertices.rows(), 4814);
  EXPECT_EQ(mesh.tetrahedra.size(), 24412u);

  std::ifstream stream(folder / "robot3_s.tet");
  std::string word;
  for (int i = 0; i < 4; ++i) stream >> word;
  for (Index i = 0; i < 4814; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      stream >> word;
      ASSERT_EQ(mesh.vertices(i, axis), std::strtod(word.c_str(), nullptr));
    }
  for (const Tetrahedron& element : mesh.tetrahedra) {
    stream >> word;
    for (const Index vertex : element) {
      Index expected = -1;
      stream >> expected;
      ASSERT_EQ(vertex, expected);
    }
  }

  std::size_t chambers[4] = {}, handles = 0, rigids = 0;
  std::ifstream chamber_rows(folder / "robot3_s_chamber.txt"), vertex_rows(folder / "robot3_s_rigid_handle.txt");
  for (std::string row; std::getline(chamber_rows, row);) {
    int id = 0, c[4] = {};
    ASSERT_EQ(std::sscanf(row.c_str(), "%d:%d:%d:%d:%d:", &id, &c[0], &c[1], &c[2], &c[3]), 5);
    for (int i = 0; i < 4; ++i) chambers[i] += c[i] == 1;
  }
  for (std::string row; std::getline(vertex_rows, row);) {
    int id = 0, handle = 0, rigid = 0;
    ASSERT_EQ(std::sscanf(row.c_str(), "%d:%d:%d:", &id, &handle, &rigid), 3);
    handles += handle == 1;
    rigids += rigid == 1;
  }
  ASSERT_EQ(chambers[3], 0u);
  ASSERT_EQ(mesh.regions.size(), 5u);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(region_of_dimension(mesh, "chamber" + std::to_string(i + 1), 3).tetrahedra.size(), chambers[i]);
  EXPECT_EQ(region_of_dimension(mesh, "handle", 0).vertices.size(), handles);
  EXPECT_EQ(region_of_dimension(mesh, "rigid", 0).vertices.size(), rigids);
}

}  // namespace
}  // namespace softkin
