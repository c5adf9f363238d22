#include <array>
#include <cstdlib>
#include <functional>
#include <limits>
#include <random>
#include <set>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>

#include "gmsh_samples.hpp"
#include "support/skips.hpp"

namespace {

using namespace softkin;
using namespace gmsh_samples;
namespace fs = std::filesystem;
using List = std::vector<Index>;

const Region& region(const Mesh& mesh, const std::string& name) {
  for (const Region& candidate : mesh.regions)
    if (candidate.name == name) return candidate;
  throw std::logic_error("no region " + name);
}

std::vector<std::string> names(const Mesh& mesh) {
  std::vector<std::string> result;
  for (const Region& candidate : mesh.regions) result.push_back(candidate.name);
  return result;
}

Region volume_region(const std::string& name, const List& tetrahedra = {}, const List& prisms = {}) {
  return {name, 3, tetrahedra, prisms, {}, {}, {}};
}

Region surface_region(const std::string& name, const List& triangles = {}, const List& quads = {}) {
  return {name, 2, {}, {}, triangles, quads, {}};
}

Region vertex_region(const std::string& name, int dimension, const List& vertices) {
  return {name, dimension, {}, {}, {}, {}, vertices};
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const Tetrahedron& element : mesh.tetrahedra) sum += signed_volume(mesh.vertices, element);
  for (const Prism& element : mesh.prisms) sum += signed_volume(mesh.vertices, element);
  return sum;
}

void expect_region(const Mesh& mesh, const Region& expected) {
  const Region& found = region(mesh, expected.name);
  EXPECT_EQ(found.dimension, expected.dimension) << expected.name;
  EXPECT_EQ(found.tetrahedra, expected.tetrahedra) << expected.name;
  EXPECT_EQ(found.prisms, expected.prisms) << expected.name;
  EXPECT_EQ(found.triangles, expected.triangles) << expected.name;
  EXPECT_EQ(found.quads, expected.quads) << expected.name;
  EXPECT_EQ(found.vertices, expected.vertices) << expected.name;
}

void expect_same(const Mesh& found, const Mesh& expected) {
  ASSERT_EQ(found.vertices.rows(), expected.vertices.rows());
  EXPECT_EQ(std::memcmp(found.vertices.data(), expected.vertices.data(),
                        sizeof(double) * static_cast<std::size_t>(expected.vertices.size())),
            0);
  EXPECT_EQ(found.tetrahedra, expected.tetrahedra);
  EXPECT_EQ(found.prisms, expected.prisms);
  EXPECT_EQ(found.triangles, expected.triangles);
  EXPECT_EQ(found.quads, expected.quads);
  EXPECT_EQ(names(found), names(expected));
  for (const Region& r : expected.regions) expect_region(found, r);
}

void expect_sample(const Mesh& mesh) {
  Points vertices(8, 3);
  vertices << 1, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 9, 9, 9;
  EXPECT_EQ(mesh.vertices, vertices);
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{4, 0, 5, 6}}));
  EXPECT_EQ(mesh.prisms, (std::vector<Prism>{{1, 2, 3, 4, 0, 5}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{3, 2, 1}}));
  EXPECT_EQ(mesh.quads, (std::vector<Quad>{{1, 2, 0, 4}}));
  EXPECT_NEAR(volume(mesh), 0.5 + 1.0 / 6, 1e-15);
  EXPECT_EQ(names(mesh),
            (std::vector<std::string>{"tip", "edge", "base", "body_2d", "body", "soft part", "physical_2_9"}));
  expect_region(mesh, vertex_region("tip", 0, {6}));
  expect_region(mesh, vertex_region("edge", 1, {1, 4, 6}));
  expect_region(mesh, surface_region("base", {0}));
  expect_region(mesh, surface_region("body_2d", {}, {0}));
  expect_region(mesh, volume_region("body", {0}, {0}));
  expect_region(mesh, volume_region("soft part", {0}));
  expect_region(mesh, surface_region("physical_2_9", {0}, {0}));
}

class Gmsh : public ::testing::Test {
 protected:
  Mesh read(const std::string& content) { return read_gmsh(folder_.put("sample.msh", content)); }
  Folder folder_;
};

TEST_F(Gmsh, ReadsText) {
  expect_sample(read(kText2));
  expect_sample(read(kText4));
}

TEST_F(Gmsh, ReadsBinaryOfBothByteOrders) {
  for (const bool swapped : {false, true}) {
    expect_sample(read(binary_2(swapped)));
    expect_sample(read(binary_4(swapped)));
  }
}

TEST_F(Gmsh, ReadsLinesThatEndInCarriageReturns) {
  for (std::string text : {kText2, kText4}) {
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
    expect_sample(read(text));
  }
}

/// Gmsh's window appends such lines; Gmsh passes over whatever stands between sections.
TEST_F(Gmsh, TextBetweenSectionsIsPassedOver) {
  const std::string text = "//+\nShow \"*\";\n//+\nHide { Volume{1}; }\n";
  for (const std::string& content :
       {kText2, kText4, binary_2(false), binary_2(true), binary_4(false), binary_4(true)}) {
    const Mesh mesh = read_gmsh("a.msh", content);
    expect_same(read_gmsh("a.msh", content + text), mesh);
    expect_same(read_gmsh("a.msh", content + "//+"), mesh);
    expect_same(read_gmsh("a.msh", text + content), mesh);
    expect_same(read_gmsh("a.msh", "\n" + text + "\r\n" + content + text), mesh);
    for (const char* section : {"$Nodes", "$Elements"})
      expect_same(read_gmsh("a.msh", replaced(content, std::string("\n") + section, "\n" + text + section)), mesh);
  }
}

TEST_F(Gmsh, ReadsWhatGmshWrote) {
  const Mesh mesh = read(written_by_gmsh());
  EXPECT_EQ(mesh.vertices.rows(), 4);
  EXPECT_EQ(mesh.tetrahedra.size(), 1u);
  EXPECT_NEAR(volume(mesh), 1.0 / 6, 1e-15);
  EXPECT_EQ(names(mesh), (std::vector<std::string>{"tip", "edge", "base", "body", "half", "physical_2_6"}));
  expect_region(mesh, vertex_region("tip", 0, {3}));
  expect_region(mesh, vertex_region("edge", 1, {0, 3}));
  expect_region(mesh, surface_region("base", {0}));
  expect_region(mesh, volume_region("body", {0}));
  expect_region(mesh, volume_region("half", {0}));
  expect_region(mesh, surface_region("physical_2_6", {0, 1}));
}

TEST_F(Gmsh, GroupsWithoutNamesAreNamedByDimensionAndTag) {
  for (const std::string& text : {kText2, kText4}) {
    const Mesh mesh = read(replaced(text, whole("PhysicalNames", body(text, "PhysicalNames")), ""));
    EXPECT_EQ(names(mesh), (std::vector<std::string>{"physical_0_7", "physical_1_4", "physical_2_1", "physical_2_3",
                                                     "physical_2_9", "physical_3_1", "physical_3_2"}));
    expect_region(mesh, volume_region("physical_3_1", {0}, {0}));
  }
}

TEST_F(Gmsh, ElementsInNoGroupAreInNoRegion) {
  const Mesh two = read(replaced(kText2, "9 6 4 1 1 1 2 ", "9 6 0 "));
  const Mesh four = read(replaced(kText4, "1 0 0 0 1 1 1 1 1 3", "1 0 0 0 1 1 1 0 3"));
  for (const Mesh& mesh : {two, four}) {
    EXPECT_EQ(mesh.prisms.size(), 1u);
    expect_region(mesh, volume_region("body", {0}));
  }
}

TEST_F(Gmsh, WithoutEntitiesNothingIsInARegion) {
  const Mesh mesh = read(replaced(kText4, whole("Entities", body(kText4, "Entities")), ""));
  EXPECT_EQ(mesh.tetrahedra.size(), 1u);
  EXPECT_TRUE(mesh.triangles.empty());
  expect_region(mesh, volume_region("body"));
}

TEST_F(Gmsh, NamesMayFollowTheElements) {
  const std::string section = whole("PhysicalNames", body(kText2, "PhysicalNames"));
  expect_sample(read(replaced(kText2, section, "") + section));
}

TEST_F(Gmsh, NodeNumbersMayBeHuge) {
  std::string text = kText4;
  for (const char* line : {"\n60\n", " 60 \n", " 60 \n", " 60 5 \n"}) {
    const std::string old = line;
    text = replaced(text, old, replaced(old, "60", "9000000000000000000"));
  }
  expect_sample(read(text));
}

Mesh random_mesh() {
  std::mt19937 random(7);
  Mesh mesh;
  mesh.vertices.resize(60, 3);
  std::uniform_real_distribution<double> coordinate(-100, 100);
  for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i) mesh.vertices.data()[i] = coordinate(random);
  mesh.vertices.row(0) << 0.1, -0.0, std::numeric_limits<double>::denorm_min();
  mesh.vertices.row(1) << std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest(), 1e-300;
  const auto fill = [&](auto& cells, std::size_t count) {
    std::set<std::set<Index>> known;
    while (cells.size() < count) {
      typename std::decay_t<decltype(cells)>::value_type cell;
      for (Index& v : cell) v = random() % 60;
      const std::set<Index> key(cell.begin(), cell.end());
      if (key.size() == cell.size() && known.insert(key).second) cells.push_back(cell);
    }
  };
  fill(mesh.tetrahedra, 70);
  fill(mesh.prisms, 40);
  fill(mesh.triangles, 30);
  fill(mesh.quads, 20);
  const auto some = [&](std::size_t count) {
    List list;
    for (std::size_t i = 0; i < count; ++i)
      if (random() % 3 == 0) list.push_back(i);
    return list;
  };
  for (const char* name : {"body", "soft part", "0", "\xc3\xa9l\xc3\xa9ment #3"})
    mesh.regions.push_back(volume_region(name, some(70), some(40)));
  mesh.regions.push_back(vertex_region("feet", 0, some(60)));
  for (const char* name : {"skin", "base_2d"}) mesh.regions.push_back(surface_region(name, some(30), some(20)));
  mesh.regions.push_back(surface_region("none"));
  mesh.regions.push_back(vertex_region("tip", 0, {3, 59}));
  Region all = surface_region("all sides");  // so that every side is in a region
  for (Index i = 0; i < 30; ++i) all.triangles.push_back(i);
  for (Index i = 0; i < 20; ++i) all.quads.push_back(i);
  mesh.regions.push_back(all);
  return mesh;
}

TEST_F(Gmsh, WrittenMeshesReadBackTheSame) {
  const Mesh mesh = random_mesh();
  for (const bool binary : {false, true}) {
    write_gmsh(folder_ / "mesh.msh", mesh, binary);
    expect_same(read_gmsh(folder_ / "mesh.msh"), mesh);
  }
}

TEST_F(Gmsh, LinesComeBackAsPoints) {
  Mesh mesh = read(kText2);
  write_gmsh(folder_ / "mesh.msh", mesh);
  mesh.regions[1].dimension = 0;
  expect_same(read_gmsh(folder_ / "mesh.msh"), mesh);
}

Mesh one_tetrahedron() {
  Mesh mesh;
  mesh.vertices.resize(4, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 0.1, 0, 0, 0, 1e-9;
  mesh.tetrahedra = {{0, 1, 2, 3}};
  mesh.triangles = {{0, 2, 1}};
  mesh.regions = {volume_region("body", {0}), surface_region("base", {0}), volume_region("all", {0}),
                  vertex_region("tip", 0, {3})};
  return mesh;
}

TEST_F(Gmsh, WritesTheFormat) {
  write_gmsh(folder_ / "mesh.msh", one_tetrahedron(), false);
  EXPECT_EQ(read_file(folder_ / "mesh.msh"),
            "$Comments\nmade by softkin\n$EndComments\n"
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
            "$PhysicalNames\n4\n3 1 \"body\"\n2 2 \"base\"\n3 3 \"all\"\n0 4 \"tip\"\n$EndPhysicalNames\n"
            "$Entities\n1 0 1 1\n"
            "1 0 0 1e-09 1 4\n"
            "1 0 0 0 1 0.1 0 1 2 0\n"
            "1 0 0 0 1 0.1 1e-09 2 1 3 0\n"
            "$EndEntities\n"
            "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 0.1 0\n0 0 1e-09\n$EndNodes\n"
            "$Elements\n3 3 1 3\n0 1 15 1\n1 4\n2 1 2 1\n2 1 3 2\n3 1 4 1\n3 1 2 3 4\n$EndElements\n");
}

TEST_F(Gmsh, CellsOfNoRegionAreOfGroup0BesideRegions) {
  Mesh mesh = one_tetrahedron();
  mesh.regions = {vertex_region("tip", 0, {3})};
  write_gmsh(folder_ / "mesh.msh", mesh, false);
  EXPECT_NE(read_file(folder_ / "mesh.msh").find("\n1 0 0 0 1 0.1 1e-09 1 0 0\n"), std::string::npos);
  mesh.triangles.clear();
  expect_same(read_gmsh(folder_ / "mesh.msh"), mesh);
  mesh.regions.clear();
  write_gmsh(folder_ / "mesh.msh", mesh, false);
  EXPECT_NE(read_file(folder_ / "mesh.msh").find("\n1 0 0 0 1 0.1 1e-09 0 0\n"), std::string::npos);
  expect_same(read_gmsh(folder_ / "mesh.msh"), mesh);
}

TEST_F(Gmsh, RefusesToWriteWhatItCouldNotRead) {
  const std::vector<std::pair<std::string, std::function<void(Mesh&)>>> changes = {
      {"no volume elements", [](Mesh& m) { m.tetrahedra.clear(), m.triangles.clear(); }},
      {"'body' of dimension 3 lists number 0 of 0 tetrahedra", [](Mesh& m) { m.tetrahedra.clear(); }},
      {"not finite", [](Mesh& m) { m.vertices(2, 1) = std::numeric_limits<double>::infinity(); }},
      {"tetrahedron 0 has vertex 4 of 4", [](Mesh& m) { m.tetrahedra[0][2] = 4; }},
      {"triangle 0 has vertex -1 of 4", [](Mesh& m) { m.triangles[0][0] = -1; }},
      {"no name", [](Mesh& m) { m.regions[0].name = ""; }},
      {"control character", [](Mesh& m) { m.regions[0].name = "a\nb"; }},
      {"holds '\"'", [](Mesh& m) { m.regions[0].name = "a\"b"; }},
      {"127 bytes", [](Mesh& m) { m.regions[0].name = std::string(128, 'a'); }},
      {"two regions have the name 'base'", [](Mesh& m) { m.regions[0].name = "base"; }},
      {"'body' has dimension 4", [](Mesh& m) { m.regions[0].dimension = 4; }},
      {"'body' of dimension 2 cannot list tetrahedra", [](Mesh& m) { m.regions[0].dimension = 2; }},
      {"'body' of dimension 3 lists number 1 of 1 tetrahedra",
       [](Mesh& m) {
         m.regions[0].tetrahedra = {0, 1};
       }},
      {"'tip' of dimension 0 must list vertices in ascending order",
       [](Mesh& m) {
         m.regions[3].vertices = {1, 1};
       }},
  };
  for (const auto& [message, change] : changes) {
    Mesh mesh = one_tetrahedron();
    change(mesh);
    try {
      write_gmsh(folder_ / "refused.msh", mesh);
      ADD_FAILURE() << "written: " << message;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("refused.msh: "), std::string::npos) << error.what();
    }
    EXPECT_FALSE(fs::exists(folder_ / "refused.msh"));
  }
}

struct Reference {
  const char* file;
  Eigen::Index vertices;
  std::size_t tetrahedra;
  std::size_t triangles;
  double volume;
  std::vector<std::pair<const char*, std::size_t>> regions;  // in the file's order, with their number of cells
};

class GmshReference : public ::testing::TestWithParam<Reference> {};

TEST_P(GmshReference, HasItsCountsAndVolume) {
  const char* given = std::getenv("SOFTKIN_REFERENCE");
  const fs::path file = fs::path(given ? given : SOFTKIN_SOURCE_DIR "/../shared/reference") / "fem" / GetParam().file;
  SKIP_WITHOUT_REFERENCE(file.string());
  const Mesh mesh = read_gmsh(file);
  EXPECT_EQ(mesh.vertices.rows(), GetParam().vertices);
  EXPECT_EQ(mesh.tetrahedra.size(), GetParam().tetrahedra);
  EXPECT_EQ(mesh.triangles.size(), GetParam().triangles);
  EXPECT_NEAR(volume(mesh), GetParam().volume, 1e-4 * GetParam().volume);
  std::vector<std::pair<std::string, std::size_t>> found;
  for (const Region& r : mesh.regions)
    found.emplace_back(r.name, r.tetrahedra.size() + r.triangles.size() + r.vertices.size());
  ASSERT_GE(found.size(), GetParam().regions.size());
  for (const auto& [name, cells] : GetParam().regions)
    EXPECT_EQ(std::count(found.begin(), found.end(), std::pair<std::string, std::size_t>(name, cells)), 1) << name;
}

// Counts by grep from the files; volumes from the dimensions of the bars, the fingers' by a sum in another program.
INSTANTIATE_TEST_SUITE_P(
    All, GmshReference,
    ::testing::Values(
        Reference{"bar_L1_50.msh",
                  903,
                  2972,
                  150,
                  100 * 20 * 10,
                  {{"fixed", 50}, {"interface", 50}, {"body_A", 1435}, {"body_B", 1537}}},
        Reference{"cantilever_medium.msh", 713, 2209, 82, 100 * 10 * 10, {{"fixed", 44}, {"tip", 38}, {"body", 2209}}},
        Reference{"cable_5k.msh", 1517, 5008, 272, 45300, {{"cable_pt0", 1}, {"eyelet7", 16}, {"body", 5008}}},
        Reference{"finger_5k.msh",
                  1851,
                  7319,
                  1488,
                  43826.2,
                  {{"tip_marker", 1}, {"cavity_wall", 1348}, {"body", 5556}, {"chamber", 1763}}},
        Reference{"finger_15k.msh",
                  5132,
                  21578,
                  4148,
                  43826.2,
                  {{"tip_marker", 1}, {"cavity_wall", 3824}, {"body", 14822}, {"chamber", 6756}}}),
    [](const auto& test) { return fs::path(test.param.file).stem().string(); });

}  // namespace
