#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <vector>

#include "text_mesh_files.hpp"

namespace softkin {
namespace {

using namespace text_mesh_tests;

using Reader = Mesh (*)(const std::filesystem::path&);

/// A file, the start of its refusal ("NAME:LINE:", or "NAME:" where it concerns the whole file), and its message.
struct BadText {
  Files files;
  std::string at, says;
};

void expect_refused(Reader read, const std::string& name, const BadText& bad) {
  MeshFolder folder;
  for (const auto& [file, content] : bad.files) folder.write(file, content);
  try {
    (void)read(folder / name);
    ADD_FAILURE() << "accepted; expected " << bad.at << " " << bad.says;
  } catch (const InvalidInput& error) {
    const std::string what = error.what(), begin = (folder / bad.at).string() + ": ";
    EXPECT_TRUE(what.starts_with(begin)) << what << "\n  expected at " << bad.at << ": " << bad.says;
    EXPECT_NE(what.find(bad.says), std::string::npos) << what << "\n  expected " << bad.says;
  }
}

TEST(TextRefusals, Medit) {
  const std::string head = "MeshVersionFormatted 2\nDimension 3\n";
  const std::string four = "Vertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";  // lines 3 to 8
  const std::string one = "Tetrahedra\n1\n1 2 3 4 0\n";                          // lines 9 to 11
  const std::vector<BadText> corpus = {
      {{{"a.mesh", ""}}, "a.mesh:1", "file ends before MeshVersionFormatted"},
      {{{"a.mesh", "MeshVersion 2\n"}}, "a.mesh:1", "expected 'MeshVersionFormatted', found 'MeshVersion'"},
      {{{"a.mesh", "MeshVersionFormatted x\n"}}, "a.mesh:1", "must be an integer, not 'x'"},
      {{{"a.mesh", "MeshVersionFormatted 2\nDimension\n2\n"}}, "a.mesh:3", "only meshes of Dimension 3"},
      {{{"a.mesh", "MeshVersionFormatted 2\n" + four}}, "a.mesh:2", "Dimension must stand before Vertices"},
      {{{"a.mesh", head + one}}, "a.mesh:3", "Vertices must stand before tetrahedra"},
      {{{"a.mesh", head + "Vertices\n1000000000\n0 0 0 0\n"}}, "a.mesh:4", "announces 1000000000 vertices"},
      {{{"a.mesh", head + "Vertices\n0\n"}}, "a.mesh:4", "number of vertices is 0"},
      {{{"a.mesh", head + "Vertices\n1\n0 nan 0 0\n"}}, "a.mesh:5", "coordinate must be a finite number, not 'nan'"},
      {{{"a.mesh", head + "Vertices\n1\n0 inf 0 0\n"}}, "a.mesh:5", "must be a finite number, not 'inf'"},
      {{{"a.mesh", head + "Vertices\n1\n0 1e999 0 0\n"}}, "a.mesh:5", "must be a finite number, not '1e999'"},
      {{{"a.mesh", head + four + "Tetrahedra\n1\n1 2 3 5 0\nEnd\n"}}, "a.mesh:11", "is 5, outside 1 to 4"},
      {{{"a.mesh", head + four + "Tetrahedra\n1\n0 1 2 3 0\nEnd\n"}}, "a.mesh:11", "is 0, outside 1 to 4"},
      {{{"a.mesh", head + four + "Tetrahedra\n1\n1 2 3 4.0 0\n"}}, "a.mesh:11", "must be an integer, not '4.0'"},
      {{{"a.mesh", head + four + "Tetrahedra\n-1\n"}}, "a.mesh:10", "is -1, outside 0"},
      {{{"a.mesh", head + four + "End\n"}}, "a.mesh:9", "no volume element and no triangle: mesh it in three"},
      {{{"a.mesh", head + four + one + one}}, "a.mesh:12", "section Tetrahedra appears a second time"},
      {{{"a.mesh", head + four + one + "End\n7\n"}}, "a.mesh:13", "unexpected '7' where the file should end"},
      {{{"a.mesh", head + four + "Hexahedra\n1\n1 2 3 4 1 2 3 4 0\n"}}, "a.mesh:9", "Hexahedra are not supported"},
      {{{"a.mesh", head + four + "TetrahedraP3\n1\n"}}, "a.mesh:9", "elements of this order"},
      {{{"a.mesh", head + four + "TetrahedraP2\n1\n1 2 3 4 1 2 3 4 1 5 0\n"}}, "a.mesh:11", "is 5, outside 1 to 4"},
      {{{"a.mesh", head + four + "TetrahedraP2Ordering\n10\n"}}, "a.mesh:9", "edge nodes are read in the usual order"},
      {{{"a.mesh", head + four + one + "TetrahedraP2\n1\n1 2 3 4 1 2 3 4 1 2 0\nEnd\n"}},
       "a.mesh:15",
       "tetrahedra of order 1 and of order 2 in one mesh"},
      {{{"a.mesh", head + four + "TetrahedraP2\n1\n1 2 3 4 1 2 3 4 1 2 0\nPrisms\n1\n1 2 3 4 1 2 0\nEnd\n"}},
       "a.mesh:15",
       "tetrahedra of order 2 beside prisms"},
      {{{"a.mesh", head + four + "Tetraedra\n1\n"}}, "a.mesh:9", "did you mean 'Tetrahedra'?"},
      {{{"a.mesh", head + four + "Corners\n99\n1\n"}}, "a.mesh:10", "announces 99 Corners"},
      {{{"a.mesh", head + four + "Edges\n1\n1 x 0\n"}}, "a.mesh:11", "must be a finite number, not 'x'"},
      {{}, "a.mesh", "no such file"},
  };
  for (const BadText& bad : corpus) expect_refused(read_medit, "a.mesh", bad);
}

TEST(TextRefusals, Tetgen) {
  const std::string node = "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n", ele = "1 4 0\n0 0 1 2 3\n";
  const std::vector<BadText> corpus = {
      {{{"a.node", node}}, "a.ele", "no such file"},
      {{{"a.ele", ele}}, "a.node", "no such file"},
      {{{"a.node", "0 3 0 0\n"}, {"a.ele", ele}}, "a.node:1", "number of vertices is 0"},
      {{{"a.node", "4 2 0 0\n" + node}, {"a.ele", ele}}, "a.node:1", "dimension 3"},
      {{{"a.node", "4 3 0 0 9\n" + node}, {"a.ele", ele}}, "a.node:1", "unexpected '9'"},
      {{{"a.node", "99999999 3 0 0\n0 0 0 0\n"}, {"a.ele", ele}}, "a.node:1", "announces 99999999 vertices"},
      {{{"a.node", "1 3 0 0\n2 0 0 0\n"}, {"a.ele", ele}}, "a.node:2", "first vertex number is 2, outside 0 to 1"},
      {{{"a.node", "2 3 0 0\n0 0 0 0\n# comment\n2 0 0 0\n"}, {"a.ele", ele}}, "a.node:4", "2 where 1 is due"},
      {{{"a.node", "2 3 0 0\n0 0 0\n1 0 0 0\n"}, {"a.ele", ele}}, "a.node:2", "the line ends before coordinate"},
      {{{"a.node", "2 3 0 0\n0 0 0 -nan\n1 0 0 0\n"}, {"a.ele", ele}}, "a.node:2", "must be a finite number"},
      {{{"a.node", "2 3 0 0\n0 0 0 0 1\n1 0 0 0\n"}, {"a.ele", ele}}, "a.node:2", "unexpected '1'"},
      {{{"a.node", "2 3 0 1\n0 0 0 0\n1 0 0 0\n"}, {"a.ele", ele}}, "a.node:2", "the line ends before boundary"},
      {{{"a.node", "2 3 0 0\n0 0 0 0\n"}, {"a.ele", ele}}, "a.node:3", "file ends before entry number"},
      {{{"a.node", node + "4 1 1 1\n"}, {"a.ele", ele}}, "a.node:6", "unexpected '4' where the file should end"},
      {{{"a.node", node}, {"a.ele", "1 10 0\n0 0 1 2 3 0 1 2 3 0\n"}}, "a.ele:2", "the line ends before vertex number"},
      {{{"a.node", node}, {"a.ele", "1 10 0\n0 0 1 2 3 0 0 0 0 0 9\n"}}, "a.ele:2", "is 9, outside 0 to 3"},
      {{{"a.node", quadratic_tetgen_files.at("q.node")}, {"a.ele", "1 10 0\n1 1 3 4 2 7 10 8 5 6 9\n"}},
       "a.ele:2",
       "the edge nodes are not in the order of TetGen 1.5 and 1.6"},
      {{{"a.node", node}, {"a.ele", "1 8 0\n"}}, "a.ele:1", "8 nodes, not 4 or 10"},
      {{{"a.node", node}, {"a.ele", "1 4 0\n0 0 1 2 4\n"}}, "a.ele:2", "vertex number is 4, outside 0 to 3"},
      {{{"a.node", node}, {"a.ele", "1 4 0\n1 0 1 2 3\n"}}, "a.ele:2", "entry number 1 where 0 is due"},
      {{{"a.node", node}, {"a.ele", "1 4 1\n0 0 1 2 3\n"}}, "a.ele:2", "the line ends before attribute"},
      {{{"a.node", node}, {"a.ele", "1 4 1\n0 0 1 2 3 0.5\n"}}, "a.ele:2", "must be a whole number"},
      {{{"a.node", node}, {"a.ele", "1 4 1\n0 0 1 2 3 1e12\n"}}, "a.ele:2", "must be a whole number"},
      {{{"a.node", node}, {"a.ele", ele}, {"a.face", "1 2\n"}}, "a.face:1", "flag is 2, outside 0 to 1"},
      {{{"a.node", node}, {"a.ele", ele}, {"a.face", "1 1\n0 0 1 7 1\n"}}, "a.face:2", "is 7, outside 0 to 3"},
      {{{"a.node", node}, {"a.ele", ele}, {"a.face", "1 1\n0 0 1 2 1 4\n"}},
       "a.face:2",
       "a face has 2 numbers after its vertices"},
      {{{"a.node", node}, {"a.ele", ele}, {"a.face", "1 1\n0 0 1 2 1 2 3 4\n"}},
       "a.face:2",
       "a face has 4 numbers after its vertices"},
      {{{"a.node", node}, {"a.ele", ele}, {"a.face", "1 1\n0 0 1 2 1 2 3 4 5 6 7\n"}}, "a.face:2", "a face has 6"},
  };
  for (const BadText& bad : corpus) expect_refused(read_tetgen, "a.node", bad);
}

const std::string nodes = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n";     // lines 1 to 5
const std::string deck = nodes + "*ELEMENT,TYPE=C3D4,ELSET=e\n1,1,2,3,4\n";  // lines 6 and 7

BadText inp(const std::string& content, int line, const std::string& says) {
  return {{{"a.inp", content}}, "a.inp:" + std::to_string(line), says};
}

TEST(TextRefusals, AbaqusNodesAndElements) {
  const std::vector<BadText> corpus = {
      {{{"a.inp", ""}}, "a.inp", "the mesh has no volume element and no triangle"},
      inp("1,2,3\n", 1, "data before the first keyword"),
      inp(nodes, 5, "the mesh has no volume element and no triangle"),
      inp("*NODE\n1,0,0\n", 2, "its number and 3 coordinates, here are 3"),
      inp("*NODE\n1,0,0,0,1\n", 2, "here are 5 values"),
      inp("*NODE\n1,0,,0\n", 2, "coordinate must be a finite number, not ''"),
      inp("*NODE\n1,0,NaN,0\n", 2, "must be a finite number, not 'NaN'"),
      inp("*NODE\n0,0,0,0\n", 2, "node number must be a whole number from 1, not '0'"),
      inp("*NODE\n99999999999,0,0,0\n", 2, "node number must be a whole number from 1"),
      inp("*NODE,SYSTEM=C\n1,0,0,0\n", 1, "parameter 'SYSTEM' of *NODE is not supported"),
      inp("*NODE,NSET=\n1,0,0,0\n", 1, "*NODE needs NSET="),
      inp("*NODE,\n1,0,0,0\n", 1, "parameter '0' of *NODE"),
      inp("*NODE,NSET=a,NSET=b\n", 1, "parameter NSET stands twice"),
      inp("*NODE,NSET=a\n*STEP\n", 1, "'a' has no members"),
      inp(deck + "*NODE\n** again\n2,0,0,0\n", 10, "node 2 is defined a second time"),
      inp(nodes + "*ELEMENT\n1,1,2,3,4\n", 6, "*ELEMENT needs TYPE="),
      inp(nodes + "*ELEMENT,TYPE=C3D4\n1,1,2,3\n", 7, "element has 3 nodes, needs 4"),
      inp(nodes + "*ELEMENT,TYPE=C3D4\n1,1,2,3,\n", 7, "element has 3 nodes, needs 4"),
      inp(nodes + "*ELEMENT,TYPE=C3D4\n1,1,2,3,4,1\n", 7, "more than 4 nodes"),
      inp(nodes + "*ELEMENT,TYPE=C3D4\n1,1,2,3,5\n", 7, "element 1 refers to the unknown node 5"),
      inp(nodes + "*ELEMENT,TYPE=C3D4\n1,1,2,3,x\n", 7, "not 'x'"),
      inp(deck + "1,1,2,3,4\n", 8, "element 1 is defined a second time"),
      inp(nodes + "*Element, type=C3D10\n1, 1, 2, 3, 4\n", 7, "element has 4 nodes, needs 10"),
      inp(nodes + "*Element, type=C3D4\n1, 1, 2, 3, 4\n*Element, type=C3D10\n2, 1, 2, 3, 4, 1, 1, 1, 1, 1, 1\n", 9,
          "tetrahedra of order 1 and of order 2 in one mesh are not supported"),
      inp(nodes + "*Element, type=C3D10\n2, 1, 2, 3, 4, 1, 1, 1, 1, 1, 1\n*Element, type=C3D6\n3, 1, 2, 3, 4, 1, 2\n",
          9, "tetrahedra of order 2 beside prisms are not supported"),
      inp(nodes + "*Element, type=C3D20R\n", 6, "element type C3D20R is not supported"),
      inp(nodes + "*Element, type=C3D8\n", 6, "element type C3D8 is not supported"),
      inp(nodes + "*Element, type=S9R5\n", 6, "element type S9R5 is not supported; read are the solids C3D4"),
      inp(nodes + "*Element, type=T3D2\n1,1,2\n", 7, "the mesh has no volume element and no triangle"),
      inp(deck + "*Element, type=T3D2, elset=rope\n2,1,2\n*Surface, name=s\nrope\n", 11, "a truss or beam has no face"),
      inp(deck + "*Surface, name=s\ne, SPOS\n", 9, "a solid's face must be S1 to S5"),
  };
  for (const BadText& bad : corpus) expect_refused(read_abaqus, "a.inp", bad);
}

TEST(TextRefusals, AbaqusSetsAndSurfaces) {
  const std::vector<BadText> corpus = {
      inp(deck + "*NSET\n1\n", 8, "*NSET needs NSET="),
      inp(deck + "*NSET,NSET=a\n1,2,\n3,9\n", 10, "unknown node 9"),
      inp(deck + "*NSET,NSET=a\n1,,2\n", 9, "an entry of the list is empty"),
      inp(deck + "*NSET,NSET=base\n1\n*NSET,NSET=b\nbse\n", 11, "unknown node set 'bse'; did you mean 'base'?"),
      inp(deck + "*NSET,NSET=a,ELSET=f\n", 8, "unknown element set 'f'; did you mean 'e'?"),
      inp(deck + "*NSET,NSET=a,GENERTE\n1,2,1\n", 8, "did you mean 'GENERATE'?"),
      inp(deck + "*NSET,NSET=a,GENERATE\n1\n", 9, "GENERATE needs first, last and step"),
      inp(deck + "*NSET,NSET=a,GENERATE\n4,1,1\n", 9, "the last number is below the first"),
      inp(deck + "*NSET,NSET=a,GENERATE\n1,4,2\n", 9, "the step does not lead"),
      inp(deck + "*NSET,NSET=a,GENERATE\n1,4,0\n", 9, "step must be a whole number from 1"),
      inp(deck + "*NSET,NSET=a,GENERATE\n1,2000000000\n", 9, "unknown node 5"),
      inp(deck + "*ELSET,ELSET=a\n1,2\n", 9, "unknown element 2"),
      inp(deck + "*ELSET,ELSET=a\na\n", 9, "unknown element set 'a'"),
      inp(deck + "*SURFACE\n1,S1\n", 8, "*SURFACE needs NAME="),
      inp(deck + "*SURFACE,NAME=a,TYPE=CUTTING SURFACE\n1\n", 8, "only TYPE=ELEMENT"),
      inp(deck + "*SURFACE,NAME=a\n1\n", 9, "a solid's face must be S1 to S5"),
      inp(deck + "*SURFACE,NAME=a\n1,SPOS\n", 9, "a solid's face must be S1 to S5"),
      inp(deck + "*SURFACE,NAME=a\n1,S5\n", 9, "a tetrahedron has no face S5"),
      inp(deck + "*SURFACE,NAME=a\n2,S1\n", 9, "unknown element 2"),
      inp(deck + "*SURFACE,NAME=a\nf,S1\n", 9, "unknown element set 'f'"),
  };
  for (const BadText& bad : corpus) expect_refused(read_abaqus, "a.inp", bad);
}

TEST(TextRefusals, AbaqusPartsAndOtherKeywords) {
  const std::string part = "*PART,NAME=P\n" + deck + "*END PART\n*ASSEMBLY\n";  // lines 1 to 10
  const std::vector<BadText> corpus = {
      inp(deck + "*System\n1,0,0\n", 8, "*SYSTEM is not supported"),
      inp(deck + "*NGEN\n1,4\n", 8, "*NGEN is not supported"),
      inp(part + "*PART,NAME=Q\n", 11, "several parts are not supported"),
      inp(part + "*INSTANCE,NAME=A,PART=Q\n", 11, "unknown part 'Q'"),
      inp(part + "*INSTANCE,PART=P\n", 11, "*INSTANCE needs NAME="),
      inp(part + "*INSTANCE,NAME=A,PART=P\n*END INSTANCE\n*INSTANCE,NAME=B,PART=P\n", 13, "several instances"),
      inp(part + "*INSTANCE,NAME=A,PART=P\n0,0,1\n", 12, "an instance that is moved"),
      inp(part + "*INSTANCE,NAME=A,PART=P\n0,0,0\n0,0,0,1,0,0,90\n", 13, "an instance that is moved"),
      inp(part + "*INSTANCE,NAME=A,PART=P\n*END INSTANCE\n*NODE\n9,0,0,0\n", 13, "*NODE of the assembly itself"),
      inp(part + "*INSTANCE,NAME=A,PART=P\n*END INSTANCE\n*NSET,NSET=n,INSTANCE=B\n1\n", 13, "unknown instance 'B'"),
      inp(part + "*INSTANCE,NAME=A,PART=P\n*END INSTANCE\n*ELSET,ELSET=e,INSTANCE=A\n1\n", 13,
          "in the part and in the assembly"),
  };
  for (const BadText& bad : corpus) expect_refused(read_abaqus, "a.inp", bad);
}

/// The origin of a refusal is the file in which the line stands.
TEST(TextRefusals, AbaqusIncludedFiles) {
  const auto with = [](const Files& files, const std::string& at, const std::string& says) {
    return BadText{files, at, says};
  };
  const auto one = [&](const std::string& line, const std::string& says) {
    return with({{"a.inp", deck + line + "\n"}, {"b.inp", ""}}, "a.inp:8", says);
  };
  Files deep{{"a.inp", deck + "*INCLUDE, INPUT=0.inp\n"}};
  for (int i = 0; i < 30; ++i) deep[std::to_string(i) + ".inp"] = "*INCLUDE, INPUT=" + std::to_string(i + 1) + ".inp\n";
  Files wide{{"a.inp", ""}};
  for (int i = 0; i < 40; ++i) wide["a.inp"] += "*INCLUDE, INPUT=b.inp\n", wide["b.inp"] += "*INCLUDE, INPUT=c.inp\n";
  wide["c.inp"] = "** nothing\n";
  const std::vector<BadText> corpus = {
      one("*INCLUDE", "*INCLUDE needs INPUT="),
      one("*INCLUDE, INPUT=", "*INCLUDE needs INPUT="),
      one("*Include, input=b.inp, input=b.inp", "stands twice"),
      one("*INCLUDE, INPUT=b.inp, PASSWORD=x", "parameter 'PASSWORD' of *INCLUDE is not supported"),
      one("*INCLUDE, INPUT=absent.inp", "absent.inp: no such file"),
      one("*INCLUDE, INPUT=.", "is a folder, not a file"),
      one("*INCLUDE, INPUT=/etc/hostname", "the file '/etc/hostname' lies outside of the deck's folder"),
      one("*INCLUDE, INPUT=../b.inp", "lies outside of the deck's folder"),
      one("*INCLUDE, INPUT=sub/../../b.inp", "lies outside of the deck's folder"),
      one("*INCLUDE, INPUT=..\\b.inp", "lies outside of the deck's folder"),
      one("*INCLUDE, INPUT=C:\\b.inp", "lies outside of the deck's folder"),
      one("*INCLUDE, INPUT=a.inp", "the file 'a.inp' includes itself"),
      with({{"a.inp", "*INCLUDE, INPUT=b.inp\n"}, {"b.inp", "*INCLUDE, INPUT=./a.inp\n"}}, "b.inp:1",
           "the file './a.inp' includes itself"),
      with({{"a.inp", "*INCLUDE, INPUT=b.inp\n"}, {"b.inp", nodes + "*ELEMENT, TYPE=C3D4\n1,1,2,3,7\n"}}, "b.inp:7",
           "element 1 refers to the unknown node 7"),
      with({{"a.inp", nodes + "*INCLUDE, INPUT=b.inp\n"}, {"b.inp", "** a comment\n\n5, 0, x, 0\n"}}, "b.inp:3",
           "must be a finite number, not 'x'"),
      with({{"a.inp", deck + "*INCLUDE, INPUT=b.inp\n*NSET, NSET=n\n8\n"}, {"b.inp", "*STEP\n"}}, "a.inp:10",
           "unknown node 8"),
      with(deep, "19.inp:1", "more than 20 files include each other"),
      with(wide, "b.inp:16", "more than 1000 files are included")};
  for (const BadText& bad : corpus) expect_refused(read_abaqus, "a.inp", bad);
}

TEST(TextRefusals, AbaqusIncludedFilesBehindALink) {
  MeshFolder folder, other;
  other.write("b.inp", nodes);
  std::filesystem::create_symlink(other / "", folder / "link");
  try {
    (void)read_abaqus(folder.write("a.inp", "*INCLUDE, INPUT=link/b.inp\n"));
    ADD_FAILURE() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("lies outside of the deck's folder"), std::string::npos) << error.what();
  }
}

TEST(TextRefusals, Tet) {
  const std::string head = "4 vertices\n1 tets\n", four = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", one = "4 0 1 2 3\n";
  const std::string good = head + four + one;
  const auto chamber = [&](const std::string& text, const std::string& at, const std::string& says) {
    return BadText{{{"a.tet", good}, {"a_chamber.txt", text}}, "a_chamber.txt" + at, says};
  };
  const auto handle = [&](const std::string& text, const std::string& at, const std::string& says) {
    return BadText{{{"a.tet", good}, {"a_rigid_handle.txt", text}}, "a_rigid_handle.txt" + at, says};
  };
  const std::vector<BadText> corpus = {
      {{{"a.tet", ""}}, "a.tet:1", "file ends before number of vertices"},
      {{{"a.tet", "4\n1 tets\n" + four}}, "a.tet:1", "the line ends before vertices"},
      {{{"a.tet", "4 vertexes\n1 tets\n" + four}}, "a.tet:1", "expected 'vertices', found 'vertexes'"},
      {{{"a.tet", "4 vertices\n1 hexes\n" + four}}, "a.tet:2", "expected 'tets', found 'hexes'"},
      {{{"a.tet", "4 vertices 1 tets\n" + four}}, "a.tet:1", "unexpected '1'"},
      {{{"a.tet", "4000000000 vertices\n"}}, "a.tet:1", "outside 1 to 2147483647"},
      {{{"a.tet", "4000000 vertices\n"}}, "a.tet:1", "announces 4000000 vertices"},
      {{{"a.tet", "4 vertices\n4000000 tets\n" + four}}, "a.tet:2", "announces 4000000 tets"},
      {{{"a.tet", "4 vertices\n0 tets\n" + four}}, "a.tet:2", "number of tets is 0"},
      {{{"a.tet", head + "0 0\n1 0 0\n0 1 0\n0 0 1\n" + one}}, "a.tet:3", "the line ends before coordinate"},
      {{{"a.tet", head + "0 0 0 0\n1 0 0\n0 1 0\n0 0 1\n"}}, "a.tet:3", "unexpected '0'"},
      {{{"a.tet", head + "0 0 0x1\n1 0 0\n0 1 0\n0 0 1\n"}}, "a.tet:3", "must be a finite number, not '0x1'"},
      {{{"a.tet", head + four + "5 0 1 2 3\n"}}, "a.tet:7", "must have 4 vertices"},
      {{{"a.tet", head + four + "4 0 1 2 4\n"}}, "a.tet:7", "vertex number is 4, outside 0 to 3"},
      {{{"a.tet", head + four + "4 0 1 2 -1\n"}}, "a.tet:7", "vertex number is -1"},
      {{{"a.tet", head + four + "4 0 1 2\n"}}, "a.tet:7", "the line ends before vertex number"},
      {{{"a.tet", head + four + "0\n"}}, "a.tet:7", "must have 4 vertices"},
      {{{"a.tet", good + one}}, "a.tet:8", "unexpected '4' where the file should end"},
      chamber("", ":1", "has no rows"),
      chamber("1:0:\n2:0:\n", "", "has 2 rows for 1 tets"),
      chamber("1\n0\n", "", "has 2 rows for 1 tets"),
      chamber("1:2:\n", ":1", "column 1 must be 0 or 1, not '2'"),
      chamber("1:0::\n", ":1", "column 2 must be 0 or 1, not ''"),
      chamber("yes\n", ":1", "must be 0 or 1, not 'yes'"),
      chamber("1:\n", ":1", "row has no column"),
      chamber(":\n", ":1", "row number must be an integer, not ''"),
      chamber("2:0:\n", ":1", "rows must count from 0 or 1, not from 2"),
      chamber("1:0:\n3:0:\n", ":2", "row number 3 where 2 is due"),
      chamber("1:0:0:\n2:0:\n", ":2", "row has 1 columns, the first one has 2"),
      chamber("1:0:\n0\n", ":2", "with and without ':' are mixed"),
      handle("1:0:0:\n2:0:0:\n3:0:0:\n", "", "has 3 rows for 4 vertices"),
      handle("0\n0\n0\n1\n", ":1", "rows must be id:handle:rigid:"),
      handle("1:0:\n2:0:\n3:0:\n4:1:\n", ":1", "rows must be id:handle:rigid:"),
      handle("1:0:0:\n2:0:0:\n3:0:0:\n4:0:0.5:\n", ":4", "column 2 must be 0 or 1, not '0.5'"),
  };
  for (const BadText& bad : corpus) expect_refused(read_tet, "a.tet", bad);
}

/// A valid set of files of each form, in which one file is to be damaged.
struct Sample {
  const char* name;
  Reader read;
  Files files;
  std::string damaged;    // which of the files
  bool announces_counts;  // a shorter mesh cannot pass for a whole one, but where a section of Medit ends
};

std::vector<Sample> samples() {
  const Files sidecars = {{"a.tet", tet_file},
                          {"a_chamber.txt", "1:0:1:\n2:1:0:\n"},
                          {"a_rigid_handle.txt", "1:1:1:\n2:0:0:\n3:0:0:\n4:0:1:\n5:0:0:\n"}};
  return {{"a.mesh", read_medit, {{"a.mesh", medit_file}}, "a.mesh", true},
          {"a.node", read_tetgen, tetgen_files, "a.node", true},
          {"a.node", read_tetgen, tetgen_files, "a.ele", true},
          {"a.node", read_tetgen, tetgen_files, "a.face", true},
          {"a.inp", read_abaqus, {{"a.inp", abaqus_file}}, "a.inp", false},
          {"q.mesh", read_medit, {{"q.mesh", quadratic_medit_file}}, "q.mesh", true},
          {"q.node", read_tetgen, quadratic_tetgen_files, "q.node", true},
          {"q.node", read_tetgen, quadratic_tetgen_files, "q.ele", true},
          {"q.node", read_tetgen, quadratic_tetgen_files, "q.face", true},
          {"q.inp", read_abaqus, {{"q.inp", quadratic_abaqus_file}}, "q.inp", false},
          {"a.tet", read_tet, sidecars, "a.tet", true},
          {"a.tet", read_tet, sidecars, "a_chamber.txt", true},
          {"a.tet", read_tet, sidecars, "a_rigid_handle.txt", true}};
}

/// Reads after `content` has taken the place of the damaged file; a mesh that comes out must be consistent.
bool reads(const MeshFolder& folder, const Sample& sample, const std::string& content, Mesh& mesh) {
  folder.write(sample.damaged, content);
  try {
    mesh = sample.read(folder / sample.name);
  } catch (const InvalidInput& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with((folder / "").string())) << error.what();
    return false;
  }
  expect_consistent(mesh);
  return true;
}

TEST(TextRefusals, TruncatedAnywhere) {
  for (const Sample& sample : samples()) {
    MeshFolder folder;
    for (const auto& [name, content] : sample.files) folder.write(name, content);
    const std::string& whole = sample.files.at(sample.damaged);
    Mesh full, mesh;
    ASSERT_TRUE(reads(folder, sample, whole, full)) << sample.damaged;
    std::size_t refused = 0;
    for (std::size_t length = 0; length < whole.size(); ++length) {
      if (!reads(folder, sample, whole.substr(0, length), mesh)) {
        ++refused;
        continue;
      }
      if (!sample.announces_counts) continue;
      if (sample.read == read_medit && (mesh.triangles.empty() || mesh.tetrahedra.empty()))
        continue;  // sections may be left out
      EXPECT_EQ(mesh.vertices.rows(), full.vertices.rows()) << sample.damaged << " cut at " << length;
      EXPECT_EQ(mesh.tetrahedra.size(), full.tetrahedra.size()) << sample.damaged << " cut at " << length;
      EXPECT_EQ(mesh.triangles.size(), full.triangles.size()) << sample.damaged << " cut at " << length;
    }
    EXPECT_GT(refused, whole.size() / 3) << sample.damaged;
  }
}

TEST(TextRefusals, FlippedBytes) {
  std::mt19937 random(20200801);
  for (const Sample& sample : samples()) {
    MeshFolder folder;
    for (const auto& [name, content] : sample.files) folder.write(name, content);
    const std::string& whole = sample.files.at(sample.damaged);
    std::size_t refused = 0;
    Mesh mesh;
    for (int round = 0; round < 2000; ++round) {
      std::string content = whole;
      for (unsigned flips = 1 + random() % 3; flips > 0; --flips)
        content[random() % content.size()] = static_cast<char>(random() % 4 ? random() % 96 + 32 : random() % 256);
      refused += !reads(folder, sample, content, mesh);
    }
    EXPECT_GT(refused, 500u) << sample.damaged;
  }
}

}  // namespace
}  // namespace softkin
