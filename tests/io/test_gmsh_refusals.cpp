#include <functional>
#include <limits>
#include <random>
#include <softkin/io/mesh/mesh_io.hpp>

#include "gmsh_samples.hpp"

namespace {

using namespace softkin;
using namespace gmsh_samples;

struct Refusal {
  std::string content;
  std::string where;    // the text after the path: ":LINE: ", ": byte N: " or ": " for the whole file
  std::string message;  // a part
};

Refusal in_2(const std::string& old, const std::string& fresh, int line, const std::string& message) {
  return {replaced(kText2, old, fresh), ":" + std::to_string(line) + ": ", message};
}

Refusal in_4(const std::string& old, const std::string& fresh, int line, const std::string& message) {
  return {replaced(kText4, old, fresh), ":" + std::to_string(line) + ": ", message};
}

/// kText4 up to the end of a fragment.
Refusal cut_4(const std::string& last, int line, const std::string& message) {
  return {kText4.substr(0, kText4.find(last) + last.size()), ":" + std::to_string(line) + ": ", message};
}

template <class T>
std::string bytes_of(T value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// A binary file with a value put over the bytes at a distance behind the line that opens a section.
template <class T>
Refusal patched(std::string content, const std::string& opening, std::size_t distance, T value,
                const std::string& message) {
  const std::size_t at = content.find(opening) + opening.size() + distance;
  content.replace(at, sizeof(T), bytes_of(value));
  return {content, ": byte " + std::to_string(at) + ": ", message};
}

void expect_refusals(const std::vector<Refusal>& refusals) {
  for (const Refusal& bad : refusals) {
    const std::string said = refusal(bad.content, "bad.msh");
    EXPECT_TRUE(said.starts_with("bad.msh" + bad.where)) << "'" << said << "' instead of " << bad.where;
    EXPECT_NE(said.find(bad.message), std::string::npos) << "'" << said << "' instead of " << bad.message;
  }
}

TEST(GmshRefusals, Header) {
  expect_refusals({
      {"", ":1: ", "file is empty"},
      {" \n\n", ":1: ", "file is empty"},
      {"solid robot\n", ": ", "not a Gmsh mesh: it has no section $MeshFormat"},
      {"$NOD\n1\n", ":1: ", "MSH version 1 is not supported"},
      {"$Comments\n$EndComments\n", ": ", "not a Gmsh mesh: it has no section $MeshFormat"},
      {"// text\n$ Nodes\n", ":2: ", "expected a section such as $Nodes, found '$'"},
      {"$Nodes x\n", ":1: ", "unexpected 'x' at the end of the line"},
      in_2("2.2 0 8", "3.0 0 8", 2, "MSH version 3.0 is not supported"),
      in_2("2.2 0 8", "two 0 8", 2, "version of the format must be a number, not 'two'"),
      in_2("2.2 0 8", "2.2 2 8", 2, "file type is 2, outside 0 to 1"),
      in_2("2.2 0 8", "2.2 0 4", 2, "data size 4 is not supported"),
      in_2("2.2 0 8", "2.2 0 8 9", 2, "unexpected '9' at the end of the line"),
      in_2("2.2 0 8", "2.2", 2, "line ends before file type"),
      in_2("$EndMeshFormat\n", "", 3, "expected '$EndMeshFormat', found '$Comments'"),
  });
}

TEST(GmshRefusals, Sections) {
  const std::string nodes = whole("Nodes", body(kText2, "Nodes"));
  const std::string elements = whole("Elements", body(kText2, "Elements"));
  const std::string entities = whole("Entities", body(kText4, "Entities"));
  expect_refusals({
      in_2(nodes, "", 16, "$Nodes must stand before $Elements"),
      {replaced(kText2, elements, ""), ": ", "has no section $Elements"},
      {replaced(replaced(kText2, elements, ""), nodes, ""), ": ", "has no section $Nodes"},
      {kText2 + nodes, ":41: ", "the file has a second section $Nodes"},
      {kText2 + "$EndRest\n", ":41: ", "'$EndRest' closes no section"},
      {kText2 + "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", ":41: ", "second section $MeshFormat"},
      {replaced(kText2, elements, whole("Elements", "1\n1 15 2 7 1 5\n")), ": ",
       "the mesh has no volume element and no triangle: mesh it in three dimensions"},
      in_2("$EndComments\n", "", 4, "section '$Comments' has no '$EndComments'"),
      in_2("$EndNodes\n", "", 26, "expected '$EndNodes', found '$Elements'"),
      in_2("$Nodes", "$ParametricNodes", 16, "parametric nodes are not supported"),
      in_4("$Nodes", "$PartitionedEntities", 23, "partitioned meshes are not supported"),
      in_4("$EndPeriodic\n", "", 45, "section '$Periodic' has no '$EndPeriodic'"),
      {replaced(kText4, entities, "") + entities, ":59: ", "$Entities must stand before $Elements"},
  });
}

TEST(GmshRefusals, PhysicalNames) {
  expect_refusals({
      in_2("0 7 \"tip\"", "0 7 tip", 9, "must stand in double quotes, not 'tip'"),
      in_2("0 7 \"tip\"", "0 7 \"tip", 9, "must stand in double quotes, not '\"tip'"),
      in_2("0 7 \"tip\"", "0 7", 9, "must stand in double quotes, not ''"),
      in_2("0 7 \"tip\"", "0 7 \"\"", 9, "name of a physical group is empty"),
      in_2("0 7 \"tip\"", "0 7 \"t\"ip\"", 9, "holds '\"' or a control character"),
      in_2("0 7 \"tip\"", "4 7 \"tip\"", 9, "dimension of a physical group is 4, outside 0 to 3"),
      in_2("0 7 \"tip\"", "0 0 \"tip\"", 9, "tag of a physical group is 0, outside 1 to 2147483647"),
      in_2("1 4 \"edge\"", "0 4 \"tip\"", 10, "two physical groups of dimension 0 have the name 'tip'"),
      in_2("1 4 \"edge\"", "0 7 \"edge\"", 10, "physical group 7 of dimension 0 has a name already: 'tip'"),
      {replaced(kText2, "\"base\"", "\"body_2d\""), ": ", "would become regions named 'body_2d'"},
      in_2("Names\n6", "Names\n7", 15, "must be an integer, not '$EndPhysicalNames'"),
      in_2("Names\n6", "Names\n5", 14, "expected '$EndPhysicalNames', found '3'"),
  });
}

TEST(GmshRefusals, Nodes) {
  expect_refusals({
      in_2("$Nodes\n8", "$Nodes\n9", 26, "number of a node must be an integer, not '$EndNodes'"),
      in_2("$Nodes\n8", "$Nodes\n7", 25, "expected '$EndNodes', found '7'"),
      in_2("$Nodes\n8", "$Nodes\n-1", 17, "number of nodes is -1, outside 0 to 2147483647"),
      in_2("$Nodes\n8", "$Nodes\n9223372036854775808", 17, "number of nodes must be an integer"),
      in_2("$Nodes\n8", "$Nodes\n2000000000", 17, "announces 2000000000 nodes, more than the rest"),
      in_2("20 1 0 0", "20 nan 0 0", 20, "x of a node must be a finite number, not 'nan'"),
      in_2("20 1 0 0", "20 1 -inf 0", 20, "y of a node must be a finite number, not '-inf'"),
      in_2("20 1 0 0", "20 1 0 1e999", 20, "z of a node must be a finite number, not '1e999'"),
      in_2("20 1 0 0", "20 1 0 0x1", 20, "z of a node must be a finite number, not '0x1'"),
      in_2("20 1 0 0", "0 1 0 0", 20, "number of a node is 0, outside 1 to"),
      in_2("20 1 0 0", "10 1 0 0", 20, "two nodes have the number 10"),
      in_2("20 1 0 0", "20 1 0", 20, "line ends before z of a node"),
      in_2("20 1 0 0", "20 1 0 0 0", 20, "unexpected '0' at the end of the line"),
      in_4("3 8 5 60", "3 9 5 60", 43, "the blocks hold fewer nodes than announced: 1 missing"),
      in_4("3 8 5 60", "3 7 5 60", 41, "number of nodes in the block is 1, more than the 0 that are left"),
      in_4("3 8 5 60", "2 8 5 60", 40, "the blocks hold fewer nodes than announced: 1 missing"),
      in_4("3 8 5 60", "4 8 5 60", 44, "dimension of an entity must be an integer, not '$EndNodes'"),
      in_4("3 8 5 60", "3 2000000000 5 60", 24, "announces 2000000000 nodes"),
      in_4("3 1 0 5", "3 1 0 -5", 25, "number of nodes in the block is -5, outside 0 to"),
      in_4("\n30\n", "\n10\n", 29, "two nodes have the number 10"),
      in_4("2 3 1 2", "2 3 2 2", 36, "mark of parametric nodes is 2, outside 0 to 1"),
      in_4("0 1 1 0.5 0.5", "0 1 1 0.5", 39, "line ends before parametric coordinate"),
      in_4("0 1 1 0.5 0.5", "0 nan 1 0.5 0.5", 39, "y of a node must be a finite number, not 'nan'"),
  });
}

TEST(GmshRefusals, Elements) {
  expect_refusals({
      in_2("Elements\n11", "Elements\n12", 40, "number of an element must be an integer, not '$EndElements'"),
      in_2("Elements\n11", "Elements\n10", 39, "expected '$EndElements', found '11'"),
      in_2("Elements\n11", "Elements\n2000000000", 28, "announces 2000000000 elements"),
      in_2("30 20 10\n", "30 20 11\n", 32, "element 4 names node 11, which does not exist"),
      in_2("30 20 10\n", "30 20 -10\n", 32, "node of an element is -10, outside 1 to"),
      in_2("30 20 10\n", "30 20\n", 32, "line ends before node of an element"),
      in_2("30 20 10\n", "30 20 10 40\n", 32, "unexpected '40' at the end of the line"),
      in_2("30 20 10\n", "30 20 1.5\n", 32, "node of an element must be an integer, not '1.5'"),
      in_2("10 4 2 1 2", "10 4 -2 1 2", 38, "number of tags of an element is -2, outside 0 to"),
      in_2("10 4 2 1 2", "10 29 2 1 2", 38,
           "third-order tetrahedra (type 29) are not supported: mesh with order 1 or 2"),
      in_2("10 4 2 1 2", "10 5 2 1 2", 38, "hexahedra (type 5) are not supported: mesh with tetrahedra or prisms"),
      in_2("10 4 2 1 2", "10 7 2 1 2", 38, "pyramids (type 7) are not supported: mesh with tetrahedra or prisms"),
      in_2("4 2 2 1 1", "4 21 2 1 1", 32, "third-order triangles (type 21) are not supported: mesh with order 1 or 2"),
      in_2("2 1 2 4 1", "2 26 2 4 1", 30, "third-order lines (type 26) are not supported: mesh with order 1 or 2"),
      in_2("10 4 2 1 2", "10 92 2 1 2", 38, "elements of type 92 are not supported: mesh with order 1 or 2"),
      in_2("10 4 2 1 2", "10 999 2 1 2", 38, "unknown element type 999"),
      in_2("10 4 2 1 2", "10 0 2 1 2", 38, "unknown element type 0"),
      in_4("3 2 4 1\n", "3 2 29 1\n", 66, "third-order tetrahedra (type 29) are not supported: mesh with order 1 or 2"),
      in_4("3 2 4 1\n", "3 5 4 1\n", 66, "elements of entity 5 of dimension 3, which is not in $Entities"),
      in_4("3 1 6 1\n", "2 1 6 1\n", 64, "elements of type 6 in an entity of dimension 2"),
      in_4("7 8 1 10", "8 8 1 10", 68, "dimension of an entity must be an integer, not '$EndElements'"),
      in_4("7 8 1 10", "6 8 1 10", 65, "the blocks hold fewer elements than announced: 1 missing"),
      in_4("7 8 1 10", "7 7 1 10", 66, "number of elements in the block is 1, more than the 0 that are left"),
      in_4("10 40 50 60 5", "10 40 50 60 6", 67, "element 10 names node 6, which does not exist"),
      in_4("10 40 50 60 5", "10 40 50 60 0", 67, "node of an element is 0, outside 1 to"),
  });
}

TEST(GmshRefusals, Entities) {
  expect_refusals({
      in_4("1 1 3 2\n", "9223372036854775808 1 3 2\n", 14, "number of entities must be an integer"),
      in_4("1 1 3 2\n", "1 1 3 9223372036854775807\n", 22, "tag of an entity must be an integer, not '$EndEntities'"),
      in_4("1 1 3 2\n", "1 1 3\n", 14, "line ends before number of entities"),
      in_4("2 0 0 0 1 0 1 2 3 9 0", "1 0 0 0 1 0 1 2 3 9 0", 18, "two entities of dimension 2 have the tag 1"),
      in_4("2 1 -9 0", "9000000 1 -9 0", 17, "announces 9000000 physical tags"),
      in_4("2 1 -9 0", "-1 1 -9 0", 17, "number of physical tags is -1, outside 0 to"),
      in_4("2 1 -9 0", "2 1 -9 1", 17, "line ends before bounding entity"),
  });
}

TEST(GmshRefusals, TextThatEndsInEverySection) {
  expect_refusals({
      cut_4("4.1 0 8", 2, "file ends before $EndMeshFormat"),
      cut_4("2 3 \"bo", 9, "must stand in double quotes, not '\"bo'"),
      cut_4("$EndPhysical", 12, "expected '$EndPhysicalNames', found '$EndPhysical'"),
      cut_4("0 0 0 1 1 0", 17, "file ends before number of physical tags"),
      cut_4("0 0 0 1 1 1 1 1 3", 20, "file ends before bounding entity"),
      cut_4("\n50\n10\n2", 24, "announces 8 nodes, more than the rest of the file can hold"),
      cut_4("0 0 2 0.5", 40, "file ends before parametric coordinate"),
      cut_4("2 0 1\n7", 42, "file ends before x of a node"),
      cut_4("2 0 1\n7\n9 9", 43, "file ends before z of a node"),
      cut_4("9 9 9", 43, "file ends before $EndNodes"),
      cut_4("8 40 50", 63, "file ends before node of an element"),
      cut_4("10 40 50 60 5 ", 67, "file ends before $EndElements"),
  });
}

TEST(GmshRefusals, Binary) {
  const std::string two = binary_2(false), four = binary_4(false);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t huge = std::uint64_t{1} << 63;
  const std::string mark = "$MeshFormat\n4.1 1 8\n", nodes = "$Nodes\n", elements = "$Elements\n";
  expect_refusals({
      patched(four, mark, 0, std::int32_t{2}, "the mark of the byte order is not the integer 1"),
      patched(four, nodes, 8, huge, "number of nodes is 9223372036854775808, outside 0 to 2147483647"),
      patched(four, nodes, 8, std::uint64_t{2000000000}, "announces 2000000000 nodes"),
      patched(four, nodes, 32, std::int32_t{-1}, "dimension of an entity is -1, outside 0 to 3"),
      patched(four, nodes, 52, std::uint64_t{0}, "number of a node is 0, outside 1 to"),
      patched(four, nodes, 60, std::uint64_t{50}, "two nodes have the number 50"),
      patched(four, nodes, 92, nan, "x of a node must be a finite number"),
      patched(four, elements, 40, std::int32_t{29}, "third-order tetrahedra (type 29) are not supported"),
      patched(four, elements, 36, std::int32_t{3}, "elements of entity 3 of dimension 0, which is not in"),
      patched(four, elements, 60, std::uint64_t{6}, "element 1 names node 6, which does not exist"),
      patched(four, "$Entities\n", 60, huge, "number of physical tags is 9223372036854775808, outside 0 to"),
      patched(two, "$Nodes\n8\n", 4, nan, "x of a node must be a finite number"),
      patched(two, "$Nodes\n8\n", 28, std::int32_t{50}, "two nodes have the number 50"),
      patched(two, "$Elements\n11\n", 0, std::int32_t{5}, "hexahedra (type 5) are not supported"),
      patched(two, "$Elements\n11\n", 4, std::int32_t{0}, "number of elements of one type is 0, outside 1 to 11"),
      patched(two, "$Elements\n11\n", 4, std::int32_t{12}, "number of elements of one type is 12, outside 1 to 11"),
      patched(two, "$Elements\n11\n", 24, std::int32_t{6}, "element 1 names node 6, which does not exist"),
  });
}

TEST(GmshRefusals, BinaryThatEndsWithinItsNodes) {
  const std::string two = binary_2(true), four = binary_4(false);
  const std::size_t at_2 = two.find("$Nodes\n8\n") + 9 + 7 * 28 + 4, at_4 = four.find("$Nodes\n") + 7 + 8;
  expect_refusals({
      {two.substr(0, at_2 + 3), ": byte " + std::to_string(at_2) + ": ", "file ends within x of a node"},
      {four.substr(0, at_4 + 80), ": byte " + std::to_string(at_4) + ": ", "announces 8 nodes, more than the rest"},
      {four.substr(0, at_4 + 5), ": byte " + std::to_string(at_4) + ": ", "file ends within number of nodes"},
  });
}

TEST(GmshRefusals, NoFile) {
  const Folder folder;
  std::filesystem::create_directory(folder / "folder");
  const auto expect_message = [](const std::filesystem::path& path, const std::string& message) {
    try {
      (void)read_gmsh(path);
      ADD_FAILURE() << "read: " << path;
    } catch (const InvalidInput& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(path.string() + message)) << error.what();
    }
  };
  expect_message(folder / "absent.msh", ": no such file");
  expect_message(folder / "folder", ": is a folder, not a file");
  expect_message(folder.put("empty.msh", ""), ":1: file is empty");
}

std::vector<std::string> samples() {
  return {kText2,
          kText4,
          binary_2(false),
          binary_2(true),
          binary_4(false),
          binary_4(true),
          written_by_gmsh(),
          kQuadratic2,
          kQuadratic4,
          binary_2(false, kQuadratic2),
          binary_4(true, kQuadratic4)};
}

TEST(GmshRefusals, FilesThatEndAnywhere) {
  for (const std::string& content : samples())
    for (std::size_t size = 0; size < content.size(); ++size) {
      const bool only_blanks_cut = content.find_first_not_of(" \r\n", size) == std::string::npos;
      const std::string said = refusal(content.substr(0, size), "cut.msh");
      ASSERT_EQ(said.empty(), only_blanks_cut) << size << " of " << content.size() << " bytes: " << said;
    }
}

void expect_consistent(const Mesh& mesh) {
  ASSERT_TRUE(mesh.vertices.allFinite());
  const auto check = [](const std::vector<Index>& list, std::size_t count) {
    ASSERT_TRUE(std::is_sorted(list.begin(), list.end(), std::less_equal<>()));
    for (const Index i : list) ASSERT_LT(static_cast<std::size_t>(i), count);
  };
  for (const Tetrahedron& cell : mesh.tetrahedra)
    for (const Index v : cell) ASSERT_LT(static_cast<std::size_t>(v), static_cast<std::size_t>(mesh.vertices.rows()));
  ASSERT_TRUE(mesh.edge_nodes.empty() || mesh.edge_nodes.size() == mesh.tetrahedra.size());
  for (const EdgeNodes& nodes : mesh.edge_nodes)
    for (const Index v : nodes) ASSERT_LT(static_cast<std::size_t>(v), static_cast<std::size_t>(mesh.vertices.rows()));
  for (const Prism& cell : mesh.prisms)
    for (const Index v : cell) ASSERT_LT(static_cast<std::size_t>(v), static_cast<std::size_t>(mesh.vertices.rows()));
  for (const Region& region : mesh.regions) {
    check(region.tetrahedra, mesh.tetrahedra.size());
    check(region.prisms, mesh.prisms.size());
    check(region.triangles, mesh.triangles.size());
    check(region.quads, mesh.quads.size());
    check(region.vertices, mesh.vertices.rows());
  }
}

TEST(GmshRefusals, BytesThatFlip) {
  std::mt19937 random(2020);
  const std::vector<std::string> files = samples();
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string content = files[static_cast<std::size_t>(i) % files.size()];
    const std::size_t at = random() % content.size();
    content[at] = static_cast<char>(content[at] ^ static_cast<char>(1 + random() % 255));
    try {
      expect_consistent(read_gmsh("flipped.msh", content));
    } catch (const InvalidInput& error) {
      ++refused;
      ASSERT_TRUE(std::string(error.what()).starts_with("flipped.msh:")) << error.what();
    } catch (const std::exception& error) {
      FAIL() << "byte " << at << " of file " << i << ": " << error.what();
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_LT(refused, 1900);
}

}  // namespace
