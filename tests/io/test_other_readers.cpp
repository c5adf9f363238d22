#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <random>
#include <set>
#include <softkin/io/mesh/mesh_io.hpp>
#include <sstream>

#include "io/shape_hashes.hpp"
#include "io/vtk_files.hpp"
#include "model/block_mesh.hpp"
#include "model/quadratic_mesh.hpp"
#include "support/skips.hpp"

/// Files of softkin's as meshio and PyVista read them, and as softkin reads what these write of it.

namespace softkin {
namespace {

using vtk_files::TempFolder;

/// What a command prints; empty where it fails.
std::string output_of(const std::string& command) {
  std::string text;
  FILE* stream = ::popen(command.c_str(), "r");
  for (int c = std::fgetc(stream); c != EOF; c = std::fgetc(stream)) text += static_cast<char>(c);
  const int status = ::pclose(stream);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? text : "";
}

/// What a script of this folder prints.
std::string printed_by(const std::string& script, const std::string& arguments) {
  return output_of("'" + testing::test_python() + "' '" SOFTKIN_SOURCE_DIR "/tests/io/" + script + "' " + arguments);
}

std::string read_by(const std::string& reader, const std::filesystem::path& in, const std::filesystem::path& out) {
  return printed_by("other_readers.py", reader + " '" + in.string() + "' '" + out.string() + "'");
}

template <class Cells>
void print_cells(std::ostringstream& out, const char* kind, const Cells& cells, const std::vector<EdgeNodes>& edges) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    out << kind;
    for (const Index node : cells[i]) out << ' ' << node;
    for (std::size_t k = 0; !edges.empty() && k < edges[i].size(); ++k) out << ' ' << edges[i][k];
    out << '\n';
  }
}

/// As other_readers.py prints a mesh; the points of its regions are cells.
std::string printed(const Mesh& mesh) {
  std::set<Index> single;
  for (const Region& region : mesh.regions)
    if (region.dimension == 0) single.insert(region.vertices.begin(), region.vertices.end());
  const std::vector<Index> points(single.begin(), single.end());
  std::ostringstream out;
  char text[128];
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    std::snprintf(text, sizeof(text), "point %.17g %.17g %.17g\n", mesh.vertices(v, 0), mesh.vertices(v, 1),
                  mesh.vertices(v, 2));
    out << text;
  }
  const char* tetrahedron = mesh.edge_nodes.empty() ? "tetra" : "tetra10";
  for (const Index point : points) out << "vertex " << point << '\n';
  print_cells(out, "triangle", mesh.triangles, {});
  print_cells(out, tetrahedron, mesh.tetrahedra, mesh.edge_nodes);
  print_cells(out, "wedge", mesh.prisms, {});
  std::vector<Region> regions = mesh.regions;
  std::sort(regions.begin(), regions.end(), [](const Region& a, const Region& b) { return a.name < b.name; });
  for (const Region& region : regions) {
    out << "region " << region.name;
    for (const Index v : region.dimension == 0 ? region.vertices : std::vector<Index>())
      out << " vertex:" << std::find(points.begin(), points.end(), v) - points.begin();
    for (const Index t : region.triangles) out << " triangle:" << t;
    for (const Index t : region.tetrahedra) out << ' ' << tetrahedron << ':' << t;
    for (const Index p : region.prisms) out << " wedge:" << p;
    out << '\n';
  }
  return out.str();
}

Region region_of(const char* name, int dimension, std::vector<Index> Region::*list, std::vector<Index> members) {
  Region region;
  region.name = name;
  region.dimension = dimension;
  region.*list = std::move(members);
  return region;
}

/// Tetrahedra and prisms, some of them in no region.
Mesh mixed() {
  Mesh mesh;
  mesh.vertices.resize(9, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.1, 1, 0, 1, 0, 1, 1, 0.3, 0.3, 2, 0, 0, 2, 1, 0, 2;
  mesh.tetrahedra = {{3, 4, 5, 6}, {3, 4, 7, 6}, {4, 7, 6, 8}};
  mesh.prisms = {{0, 1, 2, 3, 4, 5}, {3, 4, 5, 7, 8, 6}};
  mesh.regions = {region_of("my \xC3\xA4 (1)", 3, &Region::tetrahedra, {1}),
                  region_of("skin", 3, &Region::prisms, {0})};
  return mesh;
}

/// Surfaces, points and overlapping volumes besides.
Mesh with_surfaces(Mesh mesh) {
  mesh.triangles = {{mesh.tetrahedra[0][0], mesh.tetrahedra[0][1], mesh.tetrahedra[0][2]},
                    {mesh.tetrahedra[1][0], mesh.tetrahedra[1][1], mesh.tetrahedra[1][3]}};
  mesh.regions.push_back(region_of("wall", 2, &Region::triangles, {0, 1}));
  mesh.regions.push_back(region_of("half", 2, &Region::triangles, {1}));
  mesh.regions.push_back(region_of("tip", 0, &Region::vertices, {2, 5}));
  mesh.regions.push_back(region_of("whole", 3, &Region::tetrahedra, {0, 1}));
  return mesh;
}

Mesh quadratic() {
  Mesh mesh = elevated(testing::block_mesh({1, 1, 1}, {1, 2, 3}));
  mesh.triangles.clear();
  mesh.regions = {region_of("body", 3, &Region::tetrahedra, {0, 2, 3})};
  return mesh;
}

std::vector<double> random_values(std::size_t count, std::mt19937& generator) {
  std::uniform_real_distribution<double> anything(-100, 100);
  std::vector<double> values(count);
  for (double& value : values) value = anything(generator);
  return values;
}

/// A block of 1 to 4 cells of 5 tetrahedra, of order 1 or 2, with fields of random values as those of a shape.
VtuContent random_shape(std::mt19937& generator) {
  const auto below = [&](unsigned n) { return generator() % n; };
  Mesh mesh = testing::block_mesh({1 + static_cast<int>(below(2)), 1, 1 + static_cast<int>(below(2))}, {1, 2, 3});
  if (below(2) == 0) mesh = elevated(mesh);
  VtuContent content;
  content.points = mesh.vertices;
  for (Index i = 0; i < content.points.size(); ++i) content.points.data()[i] += random_values(1, generator)[0] / 1000;
  content.tetrahedra = mesh.tetrahedra;
  content.edge_nodes = mesh.edge_nodes;
  const std::size_t points = mesh.vertices.rows(), cells = mesh.tetrahedra.size();
  content.point_fields.push_back({"displacement_mm", 3, random_values(3 * points, generator)});
  content.cell_fields.push_back({"volume_ratio", 1, random_values(cells, generator)});
  for (unsigned i = below(4); i > 0; --i)
    content.cell_fields.push_back({"constant" + std::to_string(i), 1, std::vector<double>(cells, i)});
  if (below(2) == 0) {
    content.region_names = {"body", "tip"};
    content.cell_regions.resize(cells);
    for (Index& region : content.cell_regions) region = static_cast<Index>(below(3)) - 1;
  }
  for (unsigned i = below(3); i > 0; --i) content.constants.emplace_back("number" + std::to_string(i), 0.5 * i);
  if (below(2) == 0) content.arrays.push_back({"anchors", 1, random_values(below(4), generator)});
  return content;
}

class OtherReaders : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { SKIP_WITHOUT_PYTHON(GetParam()); }
};

}  // namespace

TEST_P(OtherReaders, ReadAVtuWithItsRegions) {
  const TempFolder folder;
  for (const Mesh& mesh : {mixed(), quadratic()}) {
    write_mesh(folder.file("a.vtu"), mesh);
    EXPECT_EQ(read_by(GetParam(), folder.file("a.vtu"), folder.file("b.vtu")), printed(mesh));
    Mesh again = read_mesh(folder.file("b.vtu"));
    if (std::string(GetParam()) == "meshio") again.regions = mesh.regions;  // it writes no field arrays
    EXPECT_EQ(printed(again), printed(mesh));
  }
}

/// Where arrays are found by offsets, meshio mistakes some of those of small files.
TEST_P(OtherReaders, ReadManySmallShapes) {
  const TempFolder folder;
  std::mt19937 generator(7);
  std::string expected;
  for (int i = 100; i < 400; ++i) {
    const VtuContent content = random_shape(generator);
    const std::string name = std::to_string(i) + ".vtu";
    write_vtu(folder.file(name), content);
    EXPECT_EQ(read_vtu_points(folder.file(name)), content.points);
    EXPECT_EQ(read_vtu(folder.file(name)).tetrahedra, content.tetrahedra);
    expected += testing::hash_lines(name, content);
  }
  EXPECT_EQ(printed_by("read_shapes.py", GetParam() + std::string(" '") + folder.file("").string() + "'"), expected);
}

INSTANTIATE_TEST_SUITE_P(Vtu, OtherReaders, ::testing::Values("meshio", "pyvista"),
                         [](const auto& test) { return std::string(test.param); });

TEST(OtherReaders, MeshioReadsAMshWithItsGroups) {
  SKIP_WITHOUT_PYTHON("meshio");
  const TempFolder folder;
  for (const bool binary : {true, false})
    for (const Mesh& mesh : {mixed(), with_surfaces(mixed()), quadratic(), with_surfaces(quadratic())}) {
      write_gmsh(folder.file("a.msh"), mesh, binary);
      EXPECT_EQ(read_by("meshio", folder.file("a.msh"), folder.file("b.msh")), printed(mesh));
      Mesh again = read_mesh(folder.file("b.msh"));
      if (mesh.regions.size() > 2) again.regions = mesh.regions;  // it writes the first group alone of every element
      EXPECT_EQ(printed(again), printed(mesh));
    }
}

}  // namespace softkin
