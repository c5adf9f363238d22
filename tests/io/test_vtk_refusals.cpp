#include <functional>
#include <limits>
#include <random>
#include <softkin/io/mesh/vtk.hpp>

#include "io/vtk_files.hpp"

namespace softkin {
namespace {

using namespace vtk_files;
using Format = XmlForm::Format;

struct BadVtk {
  std::string message;  // a part of what() that holds the place too
  std::string content;
};

void expect_refused(const std::vector<BadVtk>& cases, const std::string& name) {
  const TempFolder folder;
  for (const BadVtk& bad : cases) {
    const fs::path path = folder.write(name, bad.content);
    const std::string message = refusal([&] { (void)(name.ends_with(".vtk") ? read_vtk(path) : read_vtu(path)); });
    EXPECT_NE(message.find(bad.message), std::string::npos) << "expected " << bad.message << "\nfound    " << message;
    EXPECT_EQ(message.find(path.string()), 0u) << message;
  }
}

const std::string kLegacy =
    "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n"  // lines 1 to 4
    "POINTS 5 float\n0 0 0 1 0 0\n0 1 0 0 0 1\n1 1 1\n"                      // 5 to 8
    "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n"               // 9 to 14
    "CELL_DATA 2\nSCALARS part int 1\nLOOKUP_TABLE default\n1\n2\n";         // 15 to 19
const std::string kOffsets51 =
    "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
    "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 0 2 1 3\nCELL_TYPES 2\n10 10\n";

std::string changed(const std::string& from, const std::string& to) {
  return replaced(kLegacy, from, to);
}

/// A tetrahedron of order 2 and one of order 1 in its place.
std::string quadratic_and_linear() {
  std::string file = replaced(kQuadraticLegacy, "CELLS 4 24", "CELLS 5 29");
  file = replaced(file, "10 0 2 3 1", "4 0 1 2 3\n10 0 2 3 1");
  file = replaced(file, "CELL_TYPES 4\n1\n21\n22\n24\n", "CELL_TYPES 5\n1\n21\n22\n10\n24\n");
  return file.substr(0, file.find("CELL_DATA"));
}

TEST(VtkRefusals, Legacy) {
  expect_refused(
      {
          {"a.vtk:1: not a legacy VTK file", ""},
          {"a.vtk:1: not a legacy VTK file", "<VTKFile>"},
          {"a.vtk:1: VTK file version '1.0' is not one of 2.0 to 5.1", changed("3.0", "1.0")},
          {"a.vtk:1: VTK file version '6.2' is not", changed("3.0", "6.2")},
          {"a.vtk:3: expected ASCII or BINARY, found 'TEXT'", changed("ASCII", "TEXT")},
          {"a.vtk:4: the dataset is POLYDATA", changed("UNSTRUCTURED_GRID", "POLYDATA")},
          {"a.vtk:4: the dataset is STRUCTURED_POINTS", changed("UNSTRUCTURED_GRID", "STRUCTURED_POINTS")},
          {"a.vtk:4: expected DATASET", changed("DATASET", "FIELD")},
          {"a.vtk:5: unknown section 'PIONTS'", changed("POINTS", "PIONTS")},
          {"a.vtk:5: number of points is 0, outside", changed("POINTS 5", "POINTS 0")},
          {"a.vtk:5: announces 6000000000 coordinates, more than", changed("POINTS 5", "POINTS 2000000000")},
          {"a.vtk:5: number of points must be an integer", changed("POINTS 5", "POINTS 5.5")},
          {"a.vtk:5: arrays of type 'real' cannot be read", changed("float", "real")},
          {"a.vtk:6: coordinate must be a finite number, not 'nan'", changed("0 0 0 1", "0 0 nan 1")},
          {"a.vtk:7: coordinate must be a finite number, not '-inf'", changed("\n0 1 0 0", "\n0 -inf 0 0")},
          {"a.vtk:9: coordinate must be a finite number, not 'CELLS'", changed("\n1 1 1\n", "\n1 1\n")},
          {"a.vtk:10: vertex of a cell is 5, outside 0 to 4", changed("4 0 1 2 3", "4 0 1 2 5")},
          {"a.vtk:11: vertex of a cell is -1, outside 0 to 4", changed("4 1 2 3 4", "4 1 2 3 -1")},
          {"a.vtk:9: announces 1000000000 cells, more than", changed("CELLS 2 10", "CELLS 1000000000 10")},
          {"a.vtk:9: announces 9000000000000000000 values of CELLS",
           changed("CELLS 2 10", "CELLS 2 9000000000000000000")},
          {"a.vtk:10: cell 0 has 400 vertices, which does not fit", changed("4 0 1 2 3", "400 0 1 2 3")},
          {"a.vtk:11: the cells hold 10 values, but CELLS announces 11", changed("CELLS 2 10", "CELLS 2 11")},
          {"a.vtk:12: there are 3 cell types for 2 cells", changed("CELL_TYPES 2", "CELL_TYPES 3")},
          {"a.vtk:13: cell 0 has 4 vertices, but a second-order tetrahedron has 10", changed("10\n10\n", "24\n10\n")},
          {"a.vtk:13: cell 0 is a second-order hexahedron (VTK type 25)", changed("10\n10\n", "25\n10\n")},
          {"a.vtk:14: cell 1 is a hexahedron (VTK type 12)", changed("10\n10\n", "10\n12\n")},
          {"a.vtk:13: cell 0 is a pyramid (VTK type 14)", changed("10\n10\n", "14\n10\n")},
          {"a.vtk:13: cell 0 is a cell of a type that softkin does not know (VTK type 99)",
           changed("10\n10\n", "99\n10\n")},
          {"a.vtk:13: cell 0 has 4 vertices, but a wedge has 6", changed("10\n10\n", "13\n10\n")},
          {"a.vtk: tetrahedra of order 1 and of order 2 in one mesh", quadratic_and_linear()},
          {"a.vtk: the mesh has no volume element and no triangle", changed("10\n10\n", "9\n9\n")},
          {"a.vtk:15: CELL_DATA is for 3, but the file has 2 cells", changed("CELL_DATA 2", "CELL_DATA 3")},
          {"a.vtk:15: POINT_DATA is for 2, but the file has 5 points", changed("CELL_DATA 2", "POINT_DATA 2")},
          {"a.vtk:17: expected LOOKUP_TABLE", changed("LOOKUP_TABLE", "TABLE")},
          {"a.vtk:18: value of a cell must be an integer, not '1.5'", changed("default\n1\n", "default\n1.5\n")},
          {"a.vtk:18: value of a cell is 3000000000, outside", changed("default\n1\n", "default\n3000000000\n")},
          {"a.vtk:20: unknown section '3'", kLegacy + "3\n"},
          {"a.vtk:22: array 'x' has 1 tuples instead of 2", kLegacy + "\nFIELD FieldData 1\nx 1 1 int\n5\n"},
          {"a.vtk:21: array 'part' makes a second region 'part_1'", kLegacy + "FIELD FieldData 1\npart 1 2 int\n1 1\n"},
          {"a.vtk:5: CELLS stands before POINTS", changed("POINTS", "CELLS 1 1\n1 0\nPOINTS")},
          {"a.vtk:9: CELL_TYPES stands before CELLS", changed("CELLS", "CELL_TYPES 1\n10\nCELLS")},
          {"a.vtk:9: CELL_DATA stands before CELLS", changed("CELLS", "CELL_DATA 0\nCELLS")},
          {"a.vtk:9: POINTS stands twice", changed("CELLS", "POINTS 1 float\n0 0 0\nCELLS")},
          {"a.vtk:15: CELLS stands twice", changed("CELL_DATA", "CELLS 2 10\nCELL_DATA")},
          {"a.vtk:15: CELL_TYPES stands twice", changed("CELL_DATA", "CELL_TYPES 2\nCELL_DATA")},
          {"the file has no CELL_TYPES", kLegacy.substr(0, kLegacy.find("CELL_TYPES"))},
          {"the file has no CELLS", kLegacy.substr(0, kLegacy.find("CELLS"))},
          {"the file has no POINTS", kLegacy.substr(0, kLegacy.find("POINTS"))},
      },
      "a.vtk");
}

TEST(VtkRefusals, LegacyOffsets) {
  expect_refused(
      {
          {"a.vtk:9: OFFSETS must ascend: 4 after 4", replaced(kOffsets51, "0 4 8", "0 4 4")},
          {"a.vtk:9: OFFSETS must begin with 0", replaced(kOffsets51, "0 4 8", "1 4 8")},
          {"a.vtk:9: OFFSETS end with 9, but CONNECTIVITY has 8", replaced(kOffsets51, "0 4 8", "0 4 9")},
          {"a.vtk:8: expected OFFSETS", replaced(kOffsets51, "OFFSETS", "4 0 1 2 3")},
          {"a.vtk:8: OFFSETS must be of an integer type",
           replaced(kOffsets51, "OFFSETS vtktypeint64", "OFFSETS float")},
          {"a.vtk:10: expected CONNECTIVITY", replaced(kOffsets51, "CONNECTIVITY", "CELL_TYPES")},
          {"a.vtk:11: vertex of a cell is 4, outside 0 to 3", replaced(kOffsets51, "2 1 3", "2 1 4")},
          {"a.vtk:8: announces 900000000 offsets", replaced(kOffsets51, "CELLS 3", "CELLS 900000000")},
      },
      "a.vtk");
}

TEST(VtkRefusals, LegacyBinary) {
  const std::string file = legacy_file(true, false);
  const std::size_t points = file.find("double\n") + 7, cells = file.find("CELLS 7 31\n") + 11;
  const auto changed_at = [&](std::size_t at, const std::string& bytes) {
    std::string copy = file;
    return copy.replace(at, bytes.size(), bytes);
  };
  const std::string nan = packed<double>({std::numeric_limits<double>::quiet_NaN()}, true);
  expect_refused(
      {
          {"a.vtk: byte " + std::to_string(points + 16) + ": coordinate must be a finite number",
           changed_at(points + 16, nan)},
          {"a.vtk: byte " + std::to_string(cells + 4) + ": vertex of a cell is 8, outside 0 to 7",
           changed_at(cells + 4, packed<int>({8}, true))},
          {"a.vtk: byte " + std::to_string(cells) + ": cell 0 has -1 vertices",
           changed_at(cells, packed<int>({-1}, true))},
          {": file ends within value of a cell", file.substr(0, file.size() - 2)},
      },
      "a.vtk");
}

const std::string kXml =
    "<?xml version=\"1.0\"?>\n"
    "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
    "<UnstructuredGrid>\n<Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">\n<Points>\n"                     // 3 to 5
    "<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n"             // 6
    "0 0 0 1 0 0\n0 1 0 0 0 1\n</DataArray>\n</Points>\n<Cells>\n"                                         // 7 to 11
    "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n0 1 2 3 0 2 1 3\n</DataArray>\n"   // 12 to 14
    "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n4 8\n</DataArray>\n"                    // 15 to 17
    "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10 10</DataArray>\n</Cells>\n"              // 18, 19
    "<CellData>\n<DataArray type=\"Int32\" Name=\"part\" format=\"ascii\">1 2</DataArray>\n</CellData>\n"  // 20 to 22
    "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";

TEST(VtkRefusals, Xml) {
  const auto xml = [](const std::string& from, const std::string& to) { return replaced(kXml, from, to); };
  const std::string names =
      "<UnstructuredGrid><FieldData><Array type=\"String\" Name=\"region_names\" "
      "NumberOfTuples=\"1\" format=\"ascii\">";
  const auto named = [&](const std::string& codes) {
    return replaced(replaced(kXml, "<UnstructuredGrid>", names + codes + "</Array></FieldData>"), "\"part\"",
                    "\"region\"");
  };
  const auto numbered = [&](const char* first, const char* second) {
    const std::string array = "<DataArray type=\"Int32\" NumberOfTuples=\"1\" format=\"ascii\" Name=\"region_";
    return replaced(replaced(kXml, "<UnstructuredGrid>",
                             "<UnstructuredGrid><FieldData>" + array + "a\">" + first + "</DataArray>" + array +
                                 "b\">" + second + "</DataArray></FieldData>"),
                    "\"part\"", "\"region\"");
  };
  expect_refused(
      {
          {"a.vtu:1: the file is empty", " \n"},
          {"a.vtu:1: not well-formed XML", "solid"},
          {"a.vtu:18: not well-formed XML: ", xml("format=\"ascii\">10", "format=ascii>10")},
          {"a.vtu:19: not well-formed XML: Start-end tags mismatch", xml("</Cells>", "</Cell>")},
          {"not well-formed XML", kXml.substr(0, kXml.size() - 12)},
          {"a.vtu:1: not a VTK file", "<a/>"},
          {"a.vtu:2: the file is of type PolyData", xml("UnstructuredGrid", "PolyData")},
          {"a.vtu:2: VTKFile has no attribute type", xml("type=", "kind=")},
          {"a.vtu:2: byte_order must be LittleEndian or BigEndian, not 'Middle'", xml("LittleEndian", "Middle")},
          {"a.vtu:2: header_type must be UInt32 or UInt64, not 'UInt16'",
           xml("version=\"1.0\" byte", "header_type=\"UInt16\" byte")},
          {"a.vtu:2: compressor vtkLZ4DataCompressor is not supported",
           xml("version=\"1.0\" byte", "compressor=\"vtkLZ4DataCompressor\" byte")},
          {"a.vtu:2: compressor vtkLZMADataCompressor is not supported",
           xml("version=\"1.0\" byte", "compressor=\"vtkLZMADataCompressor\" byte")},
          {"a.vtu:2: VTKFile has no UnstructuredGrid",
           xml("<UnstructuredGrid>\n", "<UnstructuredGrid2/><UnstructuredGrid3>\n")
               .replace(kXml.find("</UnstructuredGrid>") + 21, 19, "</UnstructuredGrid3>")},
          {"a.vtu:24: the grid has several pieces", xml("</Piece>", "</Piece>\n<Piece/>")},
          {"a.vtu:4: NumberOfPoints must be an integer from 1", xml("NumberOfPoints=\"4\"", "NumberOfPoints=\"0\"")},
          {"a.vtu:4: NumberOfCells must be an integer from 1", xml("NumberOfCells=\"2\"", "NumberOfCells=\"3e9\"")},
          {"a.vtu:8: array 'Points' ends after 12 of 15 values", xml("NumberOfPoints=\"4\"", "NumberOfPoints=\"5\"")},
          {"a.vtu:8: array 'Points' has more than 9 values", xml("NumberOfPoints=\"4\"", "NumberOfPoints=\"3\"")},
          {"a.vtu:8: array 'Points' ends after 12 of 6000000000 values", xml("Points=\"4\"", "Points=\"2000000000\"")},
          {"a.vtu:7: value of array 'Points' must be a finite number, not 'nan'", xml("0 0 0 1 0 0", "0 nan 0 1 0 0")},
          {"a.vtu:8: value of array 'Points' must be a finite number, not 'inf'", xml("0 1 0 0 0 1", "0 1 0 0 0 inf")},
          {"a.vtu:6: Points must have NumberOfComponents=\"3\"",
           xml("NumberOfComponents=\"3\"", "NumberOfComponents=\"2\"")},
          {"a.vtu:6: arrays of type 'Float16' cannot be read", xml("Float64", "Float16")},
          {"a.vtu:6: format must be ascii, binary or appended, not 'hex'", xml("format=\"ascii\"", "format=\"hex\"")},
          {"a.vtu:6: appended data, but the file has no AppendedData",
           xml("format=\"ascii\"", "format=\"appended\" offset=\"0\"")},
          {"a.vtu:12: array 'connectivity': cell 1 has the vertex 4, outside 0 to 3", xml("0 2 1 3", "0 2 1 4")},
          {"a.vtu:12: array 'connectivity': cell 0 has the vertex -1", xml("0 1 2 3", "-1 1 2 3")},
          {"a.vtu:13: array 'connectivity' ends after 7 of 8", xml("0 2 1 3", "0 2 1")},
          {"a.vtu:12: array 'connectivity' must be of an integer type", xml("\"Int32\"", "\"Float32\"")},
          {"a.vtu:15: array 'offsets' must ascend: cell 1 ends at 4, the cell before at 4", xml("4 8", "4 4")},
          {"a.vtu:15: array 'offsets' must ascend: cell 0 ends at -4", xml("4 8", "-4 8")},
          {"a.vtu:18: cell 1 has 5 vertices, but a tetrahedron has 4", xml("4 8", "4 9")},
          {"a.vtu:18: cell 1 is a second-order wedge (VTK type 26)", xml("10 10", "10 26")},
          {"a.vtu:18: value of array 'types' is 256, outside 0 to 255", xml("10 10", "10 256")},
          {"a.vtu:11: Cells has no array 'types'", xml("\"types\"", "\"typos\"")},
          {"a.vtu:4: Piece has no Cells", xml("<Cells>", "<Zells>").replace(kXml.find("</Cells>"), 8, "</Zells>")},
          {"a.vtu:12: array 'connectivity' has no data", xml("0 1 2 3 0 2 1 3\n", "")},
          {"a.vtu:18: the data of an array must be one plain text", xml("10 10", "10 <!-- x --> 10")},
          {"a.vtu:21: array 'part' ends after 1 of 2", xml("1 2</", "1</")},
          {"a.vtu:21: DataArray has no attribute Name", xml("Name=\"part\"", "")},
          {"a.vtu:21: array 'region' has the value 1, outside the 1 names", named("98 0")},
          {"a.vtu:3: array 'region_names': the last string does not end with 0", named("98 0 98")},
          {"a.vtu:3: array 'region_names' holds 2 strings", named("98 0 98 0")},
          {"a.vtu:3: array 'region_names': 256 is no byte", named("256 0")},
          {"a.vtu:3: two regions have the number 1", numbered("1", "1")},
          {"a.vtu:3: the numbers of the regions must be 0 to 1", numbered("0", "2")},
          {"a.vtu:3: array 'region_b' has no data", numbered("0", "")},
          {"a.vtu:21: array 'region' has the value 2, outside the 2 names", numbered("1", "0")},
      },
      "a.vtu");
}

/// The reference mesh with one change in the bytes of the first array (Points) as they stand in the file.
std::string damaged(const XmlForm& form, std::size_t at, const std::string& bytes) {
  std::string file = xml_file(form);
  const std::size_t begin = form.format == Format::binary ? file.find("\">\n  ", file.find("format=\"binary\"")) + 5
                                                          : file.rfind("AppendedData encoding");
  const std::size_t start = form.format == Format::binary ? begin : file.find('_', begin) + 1;
  return file.replace(start + at, bytes.size(), bytes);
}

TEST(VtkRefusals, XmlBinary) {
  const XmlForm inlined{Format::binary}, raw{Format::raw}, zipped{Format::raw, false, true, true};
  const std::size_t raw_at = xml_file(raw).find("\n_") + 2, zip_at = xml_file(zipped).find("\n_") + 2;
  const std::string nan = packed<double>({std::numeric_limits<double>::quiet_NaN()});
  const auto word = [](std::uint64_t value) { return packed<std::uint64_t>({value}); };
  const auto byte = [](std::size_t at) { return "a.vtu: byte " + std::to_string(at) + ": array 'Points': "; };
  const std::string whole = xml_file(raw);
  expect_refused(
      {
          {"a.vtu:8: array 'Points': byte 42 is not base64 text here", damaged(inlined, 50, "*")},
          {"a.vtu:8: array 'Points': byte 61 is not base64 text here", damaged(inlined, 48, "=")},
          {"a.vtu:8: array 'Points': base64 padding within its data", damaged(inlined, 50, "==")},
          {"a.vtu:8: array 'Points': more data follows",
           replaced(xml_file(inlined), "\n</DataArray>", "AAAA\n</DataArray>")},
          {"a.vtu:7: decoded data: byte 8: value of array 'Points' must be a finite number", damaged(raw, 12, nan)},
          {byte(raw_at + 4) + "holds 191 bytes where the file's counts ask for 192", damaged(raw, 0, "\xBF")},
          {byte(zip_at + 24) + "announces 9000000000000 compressed blocks", damaged(zipped, 0, word(9000000000000))},
          {byte(zip_at + 24) + "announces blocks of 18446744073709551615 bytes", damaged(zipped, 8, word(~0ull))},
          {byte(zip_at + 24) + "announces blocks of", damaged(zipped, 16, word(~0ull))},
          {byte(zip_at + 24) + "holds 200 bytes where the file's counts ask for 192", damaged(zipped, 16, word(40))},
          {byte(zip_at + 32) + "announces compressed blocks that are longer", damaged(zipped, 24, word(~0ull))},
          {byte(zip_at + 64) + "compressed block 0 is damaged", damaged(zipped, 64, "\xFF")},
          {byte(zip_at + 64) + "compressed block 0 is damaged", damaged(zipped, 24, word(5))},
          {"a.vtu:7: offset 4000 lies outside the ", replaced(whole, "offset=\"0\"", "offset=\"4000\"")},
          {"a.vtu:7: offset must be an integer from 0", replaced(whole, "offset=\"0\"", "offset=\"-1\"")},
          {"a.vtu:7: DataArray has no attribute offset", replaced(whole, "offset=\"0\"", "")},
          {"a.vtu:7: binary data, but VTKFile has no attribute byte_order", replaced(whole, "byte_order", "order")},
          {": encoding must be raw or base64, not 'hex'", replaced(whole, "\"raw\"", "\"hex\"")},
          {": AppendedData must begin with '_'", replaced(whole, "\n_", "\n")},
          {": AppendedData does not end: the file is cut off", whole.substr(0, whole.size() - 30)},
          {": expected </VTKFile> and nothing else", whole.substr(0, whole.size() - 5)},
          {": not well-formed XML", replaced(whole, "</UnstructuredGrid>", "")},
      },
      "a.vtu");
}

TEST(VtkRefusals, MissingFile) {
  const TempFolder folder;
  EXPECT_NE(refusal([&] { (void)read_vtk(folder.file("none.vtk")); }).find("no such file"), std::string::npos);
  EXPECT_NE(refusal([&] { (void)read_vtu(folder.file("none.vtu")); }).find("no such file"), std::string::npos);
}

/// Every truncation and 2000 damaged bytes: read or refused with InvalidInput, and nothing else.
void damage(const std::string& whole, const std::string& name, std::uint64_t seed) {
  const TempFolder folder;
  const auto read = [&](const std::string& content) {
    const fs::path path = folder.write(name, content);
    return refusal([&] { (void)(name.ends_with(".vtk") ? read_vtk(path) : read_vtu(path)); });
  };
  ASSERT_EQ(read(whole), "");
  std::size_t refused = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) refused += !read(whole.substr(0, size)).empty();
  EXPECT_GT(refused, whole.size() / 2);
  std::mt19937_64 random(seed);
  for (int i = 0; i < 2000; ++i) {
    std::string copy = whole;
    copy[random() % copy.size()] = static_cast<char>(random());
    refused += !read(copy).empty();
  }
  EXPECT_GT(refused, whole.size() / 2 + 500);
}

TEST(VtkRefusals, DamagedLegacyAscii) {
  damage(kLegacy, "a.vtk", 1);
}
TEST(VtkRefusals, DamagedLegacyOfOrder2) {
  damage(kQuadraticLegacy, "a.vtk", 9);
}
TEST(VtkRefusals, DamagedLegacyBinary) {
  damage(legacy_file(true, false), "a.vtk", 2);
}
TEST(VtkRefusals, DamagedLegacyOffsets) {
  damage(legacy_file(true, true), "a.vtk", 3);
}
TEST(VtkRefusals, DamagedXmlAscii) {
  damage(kXml, "a.vtu", 4);
}
TEST(VtkRefusals, DamagedXmlInline) {
  damage(xml_file({Format::binary, false, false, true}), "a.vtu", 5);
}
TEST(VtkRefusals, DamagedXmlRaw) {
  damage(xml_file({Format::raw}), "a.vtu", 6);
}
TEST(VtkRefusals, DamagedXmlCompressed) {
  damage(xml_file({Format::raw, false, true, true}), "a.vtu", 7);
}
TEST(VtkRefusals, DamagedXmlBase64) {
  damage(xml_file({Format::base64, true, true}), "a.vtu", 8);
}

}  // namespace
}  // namespace softkin
