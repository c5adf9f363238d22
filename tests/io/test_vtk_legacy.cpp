#include <softkin/io/mesh/vtk.hpp>

#include "io/vtk_files.hpp"

namespace softkin {
namespace {

using namespace vtk_files;
using Indices = std::vector<Index>;

Mesh read_legacy(const std::string& content) {
  const TempFolder folder;
  return read_vtk(folder.write("mesh.vtk", content));
}

// Two tetrahedra that share a face.
const std::string kTwo =
    "# vtk DataFile Version 2.0\r\nsome title\r\nASCII\r\nDATASET UNSTRUCTURED_GRID\r\n"
    "POINTS 5 float\r\n0 0 0  1 0 0  0 1 0  0 0 1\r\n1 1 1e0\r\n"
    "CELLS 2 10\r\n4 0 1 2 3\r\n4 1 2 3 4\r\nCELL_TYPES 2\r\n10\r\n10\r\n";

TEST(VtkLegacy, ReadsEveryForm) {
  for (const bool binary : {false, true})
    for (const bool offsets : {false, true}) {
      SCOPED_TRACE(std::string(binary ? "binary" : "ascii") + (offsets ? " 5.1" : " 3.0"));
      expect_reference_mesh(read_legacy(legacy_file(binary, offsets)));
    }
}

TEST(VtkLegacy, KeepsSurfaceCellsOnlyWhereARegionNamesThem) {
  const std::string file = legacy_file(false, false);
  const Mesh mesh = read_legacy(file.substr(0, file.find("CELL_DATA")));
  EXPECT_EQ(mesh.tetrahedra.size(), 2u);
  EXPECT_EQ(mesh.prisms.size(), 1u);
  EXPECT_TRUE(mesh.triangles.empty() && mesh.quads.empty() && mesh.regions.empty());
}

TEST(VtkLegacy, ReadsCarriageReturnsAndVersion2) {
  const Mesh mesh = read_legacy(kTwo);
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
  EXPECT_EQ(mesh.vertices(4, 2), 1.0);
}

TEST(VtkLegacy, ReadsIntegerPoints) {
  const Mesh mesh = read_legacy(replaced(replaced(kTwo, "float", "int"), "1e0", "-7"));
  EXPECT_EQ(mesh.vertices(4, 2), -7.0);
}

TEST(VtkLegacy, TakesIntegerArraysAndSkipsTheRest) {
  const Mesh mesh = read_legacy(kTwo +
                                "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1 \n\n"
                                "POINT_DATA 5\n"
                                "SCALARS point_id int\nLOOKUP_TABLE mine\n1 2 3 4 5\n"
                                "LOOKUP_TABLE mine 1\n0 0.5 1 1\n"
                                "VECTORS move float\n0 0 0 1 1 1 2 2 2 nan 3 3 4 4 4\n"
                                "CELL_DATA 2\n"
                                "SCALARS stress float 1\nLOOKUP_TABLE default\nnan 1.5\n"
                                "COLOR_SCALARS paint 3\n0 0 1 1 0 0\n"
                                "NORMALS up double\n0 0 1 0 0 1\n"
                                "TEXTURE_COORDINATES where 2 float\n0 0 1 1\n"
                                "TENSORS strain float\n1 2 3 4 5 6 7 8 9\n1 2 3 4 5 6 7 8 9\n"
                                "GLOBAL_IDS ids vtkIdType\n7 8\n"
                                "FIELD FieldData 5\n"
                                "my%20part 1 2 unsigned_char\n255 3\n"
                                "METADATA\nCOMPONENT_NAMES\nx\n\n"
                                "pair 2 2 int\n1 2 3 4\n"
                                "METADATA\nCOMPONENT_NAMES\n\ny\nINFORMATION 0\n\n"
                                "comment 1 2 string\nfirst line\n\n"
                                "NULL_ARRAY\n"
                                "flag 1 2 bit\n0 1\n");
  EXPECT_EQ(region_names(mesh), (std::vector<std::string>{"flag_0", "flag_1", "my part_255", "my part_3"}));
  EXPECT_EQ(region(mesh, "my part_255").tetrahedra, Indices{0});
  EXPECT_EQ(region(mesh, "flag_1").tetrahedra, Indices{1});
}

TEST(VtkLegacy, SkipsAndReadsBinaryArrays) {
  const auto text = [](const std::string& bytes) { return bytes + "\n"; };
  const std::string file =
      "# vtk DataFile Version 4.2\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 2\n"
      "TIME 1 1 double\n" +
      text(packed<double>({0.5}, true)) + "note 1 2 string\n" +
      text(std::string("\xC3", 1) + "abc" + std::string("\x80\x02", 2) + "de") + "POINTS 4 short\n" +
      text(packed<std::int16_t>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 300}, true)) +
      "METADATA\nINFORMATION 0\n\n"
      "CELLS 2 10\n" +
      text(packed<int>({4, 0, 1, 2, 3, 4, 0, 2, 1, 3}, true)) + "CELL_TYPES 2\n" + text(packed<int>({10, 10}, true)) +
      "CELL_DATA 2\nSCALARS on bit 1\nLOOKUP_TABLE default\n" + text(std::string(1, '\x40')) +
      "COLOR_SCALARS paint 3\n" + text("\x01\x02\x03\x04\x05\x06") + "VECTORS v float\n" +
      text(packed<float>({1, 2, 3, 4, 5, 6}, true)) + "FIELD FieldData 2\nbig 1 2 vtktypeint64\n" +
      text(packed<std::int64_t>({-5, 1LL << 40}, true)) + "id 1 2 vtkIdType\n" + text(packed<int>({9, 9}, true));
  const Mesh mesh = read_legacy(file);
  EXPECT_EQ(mesh.vertices(3, 2), 300.0);
  EXPECT_EQ(region_names(mesh), (std::vector<std::string>{"big_-5", "big_1099511627776", "id_9", "on_0", "on_1"}));
  EXPECT_EQ(region(mesh, "on_1").tetrahedra, Indices{1});
  EXPECT_EQ(region(mesh, "id_9").tetrahedra, (Indices{0, 1}));
}

TEST(VtkLegacy, LeavesOutArraysOfMoreThanAThousandValues) {
  for (const int values : {1000, 1001}) {
    std::string file =
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
        "0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1001 5005\n";
    for (int i = 0; i < 1001; ++i) file += "4 0 1 2 3\n";
    file += "CELL_TYPES 1001\n";
    for (int i = 0; i < 1001; ++i) file += "10\n";
    file += "CELL_DATA 1001\nSCALARS id int\nLOOKUP_TABLE default\n";
    for (int i = 0; i < 1001; ++i) file += std::to_string(i % values) + "\n";
    EXPECT_EQ(read_legacy(file).regions.size(), values == 1000 ? 1000u : 0u);
  }
}

}  // namespace
}  // namespace softkin
