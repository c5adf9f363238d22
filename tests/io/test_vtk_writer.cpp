#include <cmath>
#include <limits>
#include <random>
#include <softkin/io/base64.hpp>
#include <softkin/io/mesh/vtk.hpp>

#include "io/vtk_files.hpp"

namespace softkin {
namespace {

using namespace vtk_files;

VtuContent sample_content() {
  VtuContent content;
  content.points = Eigen::Map<const Points>(kPoints.data(), 8, 3);
  content.tetrahedra = {{0, 2, 1, 6}, {3, 4, 5, 7}};
  content.prisms = {{0, 1, 2, 3, 4, 5}};
  content.point_fields = {{"displacement", 3, std::vector<double>(24, 0.25)},
                          {"a<b> & \"c\"", 1, std::vector<double>(8)}};
  content.cell_fields = {{"volume ratio", 1, {1, 1.5, 0.75}}};
  content.cell_regions = {1, -1, 0};
  content.region_names = {"body", "soft \xC3\xA4 part"};
  return content;
}

TEST(VtkWriter, ReaderRecoversMeshAndRegions) {
  const TempFolder folder;
  const VtuContent content = sample_content();
  write_vtu(folder.file("a.vtu"), content);
  const Mesh mesh = read_vtu(folder.file("a.vtu"));
  EXPECT_EQ(mesh.vertices, content.points);
  EXPECT_EQ(mesh.tetrahedra, content.tetrahedra);
  EXPECT_EQ(mesh.prisms, content.prisms);
  EXPECT_EQ(region_names(mesh), content.region_names);
  EXPECT_EQ(region(mesh, "body").prisms, std::vector<Index>{0});
  EXPECT_EQ(region(mesh, "soft \xC3\xA4 part").tetrahedra, std::vector<Index>{0});
  EXPECT_EQ(read_vtu_points(folder.file("a.vtu")), content.points);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.file("")), {}), 1) << "a temporary file was left";
}

TEST(VtkWriter, ReaderFindsNoRegionWhereNoCellIsInOne) {
  const TempFolder folder;
  VtuContent content = sample_content();
  content.cell_regions = {-1, -1, -1};
  for (const std::size_t names : {2u, 0u}) {
    content.region_names.resize(names);
    write_vtu(folder.file("a.vtu"), content);
    EXPECT_TRUE(read_vtu(folder.file("a.vtu")).regions.empty());
  }
}

/// The array's bytes, taken from the file by hand: a text of base64 with the header, then one with the blocks.
std::string stored(const std::string& file, const std::string& name) {
  const std::string before = "format=\"binary\">\n";
  const std::size_t begin = file.find(before, file.find("Name=\"" + name + "\"")) + before.size();
  const std::string text = file.substr(begin, file.find("\n</DataArray>", begin) - begin);
  const auto words = [](const std::string& bytes) {
    std::vector<std::uint64_t> values(bytes.size() / 8);
    std::memcpy(values.data(), bytes.data(), 8 * values.size());
    return values;
  };
  const std::uint64_t blocks = words(from_base64(text.substr(0, 12)))[0];
  const std::size_t header_end = (8 * (3 + blocks) + 2) / 3 * 4;
  const std::vector<std::uint64_t> header = words(from_base64(text.substr(0, header_end)));
  const std::string compressed = from_base64(text.substr(header_end));
  std::string data;
  std::size_t at = 0;
  for (std::size_t i = 0; i < blocks; ++i) {
    uLongf bytes = i + 1 < blocks || header[2] == 0 ? header[1] : header[2];
    std::string block(bytes, '\0');
    EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(block.data()), &bytes,
                         reinterpret_cast<const Bytef*>(compressed.data() + at), header[3 + i]),
              Z_OK);
    at += header[3 + i];
    data += block;
  }
  EXPECT_EQ(at, compressed.size());
  return data;
}

/// meshio cannot read a compressed array of no blocks.
TEST(VtkWriter, ArraysWithoutValuesAreEmptyTexts) {
  const TempFolder folder;
  VtuContent content = sample_content();
  content.arrays = {{"anchors", 1, {}}, {"others", 1, {0.5}}};
  write_vtu(folder.file("a.vtu"), content);
  EXPECT_NE(slurp(folder.file("a.vtu"))
                .find("Name=\"anchors\" NumberOfComponents=\"1\" NumberOfTuples=\"0\" "
                      "format=\"ascii\">\n</DataArray>"),
            std::string::npos);
  const auto arrays = read_vtu_arrays(folder.file("a.vtu"));
  EXPECT_TRUE(arrays.at("anchors").empty());
  EXPECT_EQ(arrays.at("others"), std::vector<double>{0.5});
}

TEST(VtkWriter, StoresWhatTheFormatAsksFor) {
  const TempFolder folder;
  write_vtu(folder.file("a.vtu"), sample_content());
  const std::string file = slurp(folder.file("a.vtu"));
  EXPECT_EQ(stored(file, "Points"), packed(kPoints));
  EXPECT_EQ(stored(file, "displacement"), packed(std::vector<double>(24, 0.25)));
  EXPECT_EQ(stored(file, "a&lt;b&gt; &amp; &quot;c&quot;"), packed(std::vector<double>(8)));
  EXPECT_EQ(stored(file, "volume ratio"), packed<double>({1, 1.5, 0.75}));
  EXPECT_EQ(stored(file, "region"), packed<std::int32_t>({1, -1, 0}));
  EXPECT_EQ(stored(file, "connectivity"), packed<std::int32_t>({0, 2, 1, 6, 3, 4, 5, 7, 0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(stored(file, "offsets"), packed<std::int64_t>({4, 8, 14}));
  EXPECT_EQ(stored(file, "types"), packed<std::uint8_t>({10, 10, 13}));
  EXPECT_NE(file.find("Name=\"region_body\" NumberOfTuples=\"1\" format=\"ascii\">0<"), std::string::npos);
  EXPECT_NE(file.find("Name=\"region_soft \xC3\xA4 part\" NumberOfTuples=\"1\" format=\"ascii\">1<"),
            std::string::npos);
  EXPECT_EQ(file.find("type=\"String\""), std::string::npos) << "which other readers refuse";
}

TEST(VtkWriter, StoresTrianglesAndSinglePoints) {
  const TempFolder folder;
  VtuContent content;
  content.points = Eigen::Map<const Points>(kPoints.data(), 3, 3);
  content.triangles = {{0, 2, 1}};
  content.cloud = true;
  content.cell_fields = {{"area", 1, {1, 2, 3, 4}}};
  write_vtu(folder.file("a.vtu"), content);
  const std::string file = slurp(folder.file("a.vtu"));
  EXPECT_NE(file.find("NumberOfCells=\"4\""), std::string::npos);
  EXPECT_EQ(stored(file, "connectivity"), packed<std::int32_t>({0, 2, 1, 0, 1, 2}));
  EXPECT_EQ(stored(file, "offsets"), packed<std::int64_t>({3, 4, 5, 6}));
  EXPECT_EQ(stored(file, "types"), packed<std::uint8_t>({5, 1, 1, 1}));
}

TEST(VtkWriter, RoundTripOfManyBlocks) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> coordinate(-100, 100);
  VtuContent content;
  content.points.resize(100000, 3);  // 2.4 MB: two whole blocks and a partial one
  for (Index i = 0; i < 100000; ++i)
    for (int axis = 0; axis < 3; ++axis) content.points(i, axis) = coordinate(random);
  for (Index i = 0; i + 3 < 65539; ++i) content.tetrahedra.push_back({i, i + 1, i + 2, i + 3});  // 1 MiB exactly
  const TempFolder folder;
  write_vtu(folder.file("a.vtu"), content);
  const Mesh mesh = read_vtu(folder.file("a.vtu"));
  EXPECT_EQ(mesh.vertices, content.points);
  EXPECT_EQ(mesh.tetrahedra, content.tetrahedra);
  EXPECT_TRUE(mesh.regions.empty());
}

TEST(VtkWriter, PointsWithoutCells) {
  const TempFolder folder;
  VtuContent content;
  content.points = Points::Constant(1, 3, 2.5);
  write_vtu(folder.file("a.vtu"), content);
  EXPECT_EQ(read_vtu_points(folder.file("a.vtu")), content.points);
  EXPECT_NE(refusal([&] { (void)read_vtu(folder.file("a.vtu")); }).find("NumberOfCells"), std::string::npos);
}

struct BadContent {
  const char* message;
  void (*spoil)(VtuContent&);
};

TEST(VtkWriter, RefusesBadContent) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  const BadContent cases[] = {
      {"there are no points", [](VtuContent& c) { c.points.resize(0, 3); }},
      {"point 3 is not finite", [](VtuContent& c) { c.points(3, 1) = nan; }},
      {"point field 'displacement': value 5 is not finite",
       [](VtuContent& c) { c.point_fields[0].values[5] = infinite; }},
      {"cell field 'volume ratio': value 2 is not finite", [](VtuContent& c) { c.cell_fields[0].values[2] = nan; }},
      {"'displacement' has 23 values instead of 8 x 3", [](VtuContent& c) { c.point_fields[0].values.pop_back(); }},
      {"'displacement' has 0 components", [](VtuContent& c) { c.point_fields[0].components = 0; }},
      {"unprintable name", [](VtuContent& c) { c.point_fields[0].name = "a\nb"; }},
      {"empty or unprintable name", [](VtuContent& c) { c.cell_fields[0].name.clear(); }},
      {"point field 'displacement' stands twice",
       [](VtuContent& c) { c.point_fields.push_back(c.point_fields.front()); }},
      {"cell field 'region' stands twice", [](VtuContent& c) { c.cell_fields[0].name = "region"; }},
      {"tetrahedron 1 has the vertex 8, outside 0 to 7", [](VtuContent& c) { c.tetrahedra[1][2] = 8; }},
      {"prism 0 has the vertex -1", [](VtuContent& c) { c.prisms[0][5] = -1; }},
      {"triangle 1 has the vertex 8, outside 0 to 7",
       [](VtuContent& c) {
         c.triangles = {{0, 1, 2}, {0, 1, 8}};
       }},
      {"'volume ratio' has 3 values instead of 11 x 1", [](VtuContent& c) { c.cloud = true; }},
      {"2 cell regions for 3 cells", [](VtuContent& c) { c.cell_regions.pop_back(); }},
      {"cell 1 is of region 2, but there are 2", [](VtuContent& c) { c.cell_regions[1] = 2; }},
      {"cell 1 is of region -2", [](VtuContent& c) { c.cell_regions[1] = -2; }},
      {"cell 0 is of region 2147483647", [](VtuContent& c) { c.cell_regions[0] = std::numeric_limits<Index>::max(); }},
      {"region 'body' stands twice", [](VtuContent& c) { c.region_names[1] = "body"; }},
      {"region '' has an empty", [](VtuContent& c) { c.region_names[1] = ""; }},
  };
  const TempFolder folder;
  for (const BadContent& bad : cases) {
    VtuContent content = sample_content();
    bad.spoil(content);
    const std::string message = refusal([&] { write_vtu(folder.file("a.vtu"), content); });
    EXPECT_NE(message.find(bad.message), std::string::npos) << bad.message << "\n" << message;
    EXPECT_EQ(message.find(folder.file("a.vtu").string() + ": "), 0u) << message;
    EXPECT_FALSE(fs::exists(folder.file("a.vtu")));
  }
}

TEST(VtkWriter, Collection) {
  const TempFolder folder;
  write_pvd(folder.file("a.pvd"), {{0, "a_0.vtu"}, {0.1, "b&c.vtu"}});
  EXPECT_EQ(slurp(folder.file("a.pvd")),
            "<?xml version=\"1.0\"?>\n<!-- made by softkin -->\n<VTKFile type=\"Collection\" version=\"0.1\" "
            "byte_order=\"LittleEndian\">\n"
            "<Collection>\n<DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"a_0.vtu\"/>\n"
            "<DataSet timestep=\"0.1\" group=\"\" part=\"0\" file=\"b&amp;c.vtu\"/>\n</Collection>\n</VTKFile>\n");
  EXPECT_NE(refusal([&] {
              write_pvd(folder.file("b.pvd"), {{0, "x"}, {std::nan(""), "y"}});
            }).find("entry 1"),
            std::string::npos);
  EXPECT_NE(refusal([&] { write_pvd(folder.file("b.pvd"), {{0, ""}}); }).find("entry 0"), std::string::npos);
}

}  // namespace
}  // namespace softkin
