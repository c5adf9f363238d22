#include <cmath>
#include <numeric>
#include <random>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/surface_files.hpp>
#include <softkin/model/mesh/shells.hpp>

#include "io/vtk_files.hpp"

namespace softkin {
namespace {

using namespace vtk_files;

// A box of 1 x 2 x 4 mm, normals outwards, as polygons.
const std::vector<std::vector<double>> box_points{{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0},
                                                  {0, 0, 4}, {1, 0, 4}, {1, 2, 4}, {0, 2, 4}};
const std::vector<std::vector<int>> box_faces{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                              {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

std::string digits(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string obj_box(bool negative = false, const std::string& rest = "") {
  std::string text = "# a box\nmtllib box.mtl\no box\n";
  for (const auto& p : box_points) text += "v " + digits(p[0]) + " " + digits(p[1]) + " " + digits(p[2]) + "\n";
  text += "vn 0 0 1\nvt 0 0\ns off\n";
  for (const auto& face : box_faces) {
    text += "f";
    for (const int v : face) text += " " + std::to_string(negative ? v - 8 : v + 1) + rest;
    text += "\n";
  }
  return text;
}

std::string off_box(const std::string& head, const std::string& of_vertex = "", const std::string& of_face = "") {
  std::string text = head;
  for (const auto& p : box_points) text += digits(p[0]) + " " + digits(p[1]) + " " + digits(p[2]) + of_vertex + "\n";
  for (const auto& face : box_faces) {
    text += "4";
    for (const int v : face) text += " " + std::to_string(v);
    text += of_face + "\n";
  }
  return text;
}

/// With properties and elements that a surface does not need. count, index: types of the list.
template <class Count, class Value>
std::string ply_box(const std::string& form, const char* count, const char* index,
                    const char* list = "vertex_indices") {
  std::string text =
      "ply\nformat " + form +
      " 1.0\ncomment by hand\nobj_info none\nelement camera 1\nproperty float64 f\n"
      "property list uchar short s\nelement vertex 8\nproperty uchar red\nproperty double z\nproperty float x\n"
      "property double y\nelement face 6\nproperty list uint8 float texcoord\nproperty list " +
      std::string(count) + " " + index + " " + list + "\nproperty int flags\nend_header\n";
  const bool ascii = form == "ascii", big = form == "binary_big_endian";
  if (ascii) text += "0.5 2 -1 7\n";
  if (!ascii) text += packed<double>({0.5}, big) + packed<std::uint8_t>({2}) + packed<std::int16_t>({-1, 7}, big);
  for (const auto& p : box_points) {
    if (ascii) text += "255 " + digits(p[2]) + " " + digits(p[0]) + " " + digits(p[1]) + "\n";
    if (!ascii)
      text += packed<std::uint8_t>({255}) + packed<double>({p[2]}, big) +
              packed<float>({static_cast<float>(p[0])}, big) + packed<double>({p[1]}, big);
  }
  for (const auto& face : box_faces) {
    if (ascii) text += "1 0.5 4 ";
    for (const int v : face)
      if (ascii) text += std::to_string(v) + " ";
    if (ascii) text += "9\n";
    if (ascii) continue;
    text += packed<std::uint8_t>({1}) + packed<float>({0.5}, big) + packed<Count>({4}, big);
    for (const int v : face) text += packed<Value>({static_cast<Value>(v)}, big);
    text += packed<std::int32_t>({9}, big);
  }
  return text;
}

TriangleSurface read(const std::string& content, const std::string& name = "a.any") {
  const TempFolder folder;
  return read_surface(folder.write(name, content));
}

double area_of(const TriangleSurface& surface) {
  double area = 0;
  for (const auto& [a, b, c] : surface.triangles)
    area += (vertex_at(surface.vertices, b) - vertex_at(surface.vertices, a))
                .cross(vertex_at(surface.vertices, c) - vertex_at(surface.vertices, a))
                .norm() /
            2;
  return area;
}

void expect_box(const TriangleSurface& surface) {
  EXPECT_EQ(surface.vertices.rows(), 8);
  EXPECT_EQ(surface.triangles.size(), 12u);
  EXPECT_NEAR(enclosed_volume(surface.vertices, surface.triangles), 8, 1e-12);
  EXPECT_NEAR(area_of(surface), 28, 1e-12);
  EXPECT_NO_THROW((void)turned_outwards(surface.vertices, surface.triangles));  // closed
}

/// Whatever the file is called.
TEST(Surfaces, ABoxInEveryForm) {
  for (const bool negative : {false, true})
    for (const char* rest : {"", "/1", "//1", "/1/1"}) expect_box(read(obj_box(negative, rest), "box.stl"));
  expect_box(read(replaced(obj_box(), "f 1 4 3 2", "f 1 4\\\n 3 \\\r\n2")));
  expect_box(read("\xef\xbb\xbf" + obj_box()));
  expect_box(read(replaced(obj_box(), "v 0 0 0\n", "v 0 0 0 1.0\nl 1 2\ng skin\nusemtl red\n")));
  expect_box(read(off_box("OFF\n8 6 12\n"), "box.obj"));
  expect_box(read(off_box("OFF 8 6 12\n")));
  expect_box(read(off_box("# by hand\n\nOFF # a box\n\n8 6\n")));
  expect_box(read(off_box("COFF\n8 6 0\n", " 255 0 0 255", " 0.5 0.5 0.5")));
  expect_box(read(off_box("NOFF\n8 6 0\n", " 0 0 1", " 3")));
  expect_box(read(off_box("STCNOFF\n8 6 0\n", " 0 0 1 0.1 0.2 0.3 1 0.5 0.5")));
  expect_box(read(off_box("8 6 12\n"), "box.off"));
  for (const char* form : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    expect_box(read(ply_box<std::uint8_t, std::int32_t>(form, "uchar", "int"), "box.stl"));
    expect_box(read(ply_box<std::int32_t, std::uint8_t>(form, "int32", "uint8", "vertex_index")));
    expect_box(read(ply_box<std::uint16_t, std::uint16_t>(form, "ushort", "uint16")));
    expect_box(read(ply_box<std::uint32_t, std::int8_t>(form, "uint", "char")));
    expect_box(read(ply_box<std::int16_t, std::uint32_t>(form, "short", "uint32")));
  }
  const TriangleSurface box = read(obj_box());
  const TempFolder folder;
  write_stl(folder.file("box.ply"), box.vertices, box.triangles);
  expect_box(read_surface(folder.file("box.ply")));
}

TEST(Surfaces, CornersAtOnePlaceAreOneVertex) {
  std::string text;
  int next = 1;
  for (const auto& face : box_faces) {  // every face has corners of its own
    std::string line = "f";
    for (const int v : face) {
      const auto& p = box_points[static_cast<std::size_t>(v)];
      text += "v " + digits(p[0]) + " " + digits(p[1]) + " " + (p[2] == 0 ? "-0.0" : digits(p[2])) + "\n";
      line += " " + std::to_string(next++);
    }
    text += line + "\n";
  }
  expect_box(read(text));
  expect_box(read(obj_box() + "f 1 1 2\nf 3 4 4 3\n"));  // faces without extent are left out
}

/// A comb: area by Gauss' formula, whichever corner comes first, and whatever plane it lies in.
TEST(Surfaces, PolygonsAreCutIntoTrianglesOfTheirArea) {
  const std::vector<std::pair<double, double>> comb{{0, 0}, {3, 0}, {6, 0}, {6, 4}, {5, 4}, {5, 1}, {4, 1},
                                                    {4, 4}, {2, 4}, {2, 1}, {1, 1}, {1, 4}, {0, 4}};
  for (std::size_t first = 0; first < comb.size(); ++first) {
    std::string text, face = "f";
    for (std::size_t i = 0; i < comb.size(); ++i) {
      const auto [x, y] = comb[(first + i) % comb.size()];
      text += "v " + digits(x) + " " + digits(y) + " " + digits(x - 2 * y) + "\n";
      face += " " + std::to_string(i + 1);
    }
    const TriangleSurface surface = read(text + face + "\n");
    EXPECT_EQ(surface.triangles.size(), comb.size() - 2);
    EXPECT_NEAR(area_of(surface), 18 * std::sqrt(6.0), 1e-10) << first;  // 24 - 2 * 3 in the plane x, y
    const Vec3 normal = Vec3(-1, 2, 1).normalized();
    for (const auto& [a, b, c] : surface.triangles) {
      const Vec3 p = vertex_at(surface.vertices, a);
      EXPECT_GT((vertex_at(surface.vertices, b) - p).cross(vertex_at(surface.vertices, c) - p).dot(normal), 0);
    }
  }
}

struct BadSurface {
  std::string content, message;
};

TEST(Surfaces, RefuseBadFilesWithTheirPlace) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n",
                    ply = ply_box<std::uint8_t, std::int32_t>("ascii", "uchar", "int"),
                    bytes = ply_box<std::uint8_t, std::int32_t>("binary_little_endian", "uchar", "int");
  const std::string at_end = std::to_string(bytes.size());
  const std::vector<BadSurface> cases{
      {"", "a.any: the file is empty"},
      {" \n", "a.any: the file is empty"},
      {"some text\n",
       "a.any: the file is of no form that softkin recognises, and a surface is read from STL, OBJ, PLY or OFF"},
      {corners, "a.any: the file has no faces"},
      {"v 1 2\n", "a.any:1: the line ends before coordinate of a vertex"},
      {"v 1 2 nan\n", "a.any:1: coordinate of a vertex must be a finite number, not 'nan'"},
      {corners + "f 1 2\n", "a.any:5: a face of 2 vertices"},
      {corners + "f 1 2 5\n", "a.any:5: the face has the vertex 5, but the file has 4"},
      {corners + "f 1 2 0\n", "a.any:5: vertex of a face must be a whole number from 1, or below 0, not '0'"},
      {corners + "f 1 2 -5\n", "a.any:5: vertex of a face is -5, but only 4 vertices stand before it"},
      {corners + "f 1 2 3.5\n", "not '3.5'"},
      {corners + "f 1 2 99999999999999999999\n", "not '99999999999999999999'"},
      {corners + "face 1 2 3\n", "a.any:5: unknown statement 'face'"},
      {corners + "cstype bspline\n", "a.any:5: 'cstype' is of free-form curves and surfaces"},
      {"v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n", "a.any:4: the face has no area"},
      {"v 0 0 0\nv 1 0 0\nv 1 1 0.3\nv 0 1 0\nf 1 2 3 4\n",
       "a.any:5: the face is not planar: a vertex lies 7.3 % of its size off its mean plane"},
      {"v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1.5 0\nf 1 2 3 4\n", "a.any:5: the face crosses itself"},
      {"OFF BINARY\n", "a.any:1: a binary OFF file is not read"},
      {"4OFF\n", "a.any:1: '4OFF' has coordinates of another number than three"},
      {"nOFF\n3\n", "a.any:1: 'nOFF' has"},
      {"OFF\n1 1 1 1\n0 0 0\n3 0 0 0\n", "a.any:2: unexpected '1' at the end of the line"},
      {"OFF\n1000000000 6 12\n", "a.any:2: announces 1000000000 vertices, more than"},
      {"OFF\n1 1000000000 12\n0 0 0\n", "a.any:2: announces 1000000000 faces"},
      {"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n", "a.any:4: the line ends before coordinate"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.any:6: vertex of a face is 3, outside 0 to 2"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "a.any:6: number of vertices of a face is 2, outside 3"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n7\n", "a.any:7: unexpected '7' where the file should end"},
      {"OFF\n0 0 0\n", "the file has no faces"},
      {replaced(ply, "format ascii 1.0", "format text 1.0"), "a.any:2: format 'text' is none of"},
      {replaced(ply, "ascii 1.0", "ascii 2.0"), "a.any:2: only PLY version 1.0"},
      {replaced(ply, "format ascii 1.0\n", ""), "the header ends without a line 'format'"},
      {replaced(ply, "element vertex 8", "element vertex -8"), "a.any:8: number of elements is -8, outside 0"},
      {replaced(ply, "element vertex 8", "element vertex 1000000000"), "announces 1000000000 elements, more than"},
      {replaced(ply, "property uchar red", "property byte red"), "a.any:9: unknown type 'byte' of a property"},
      {replaced(ply, "property double z\n", ""), "the element 'vertex' needs one property z"},
      {replaced(ply, "list uchar int vertex_indices", "list uchar float vertex_indices"), "of whole numbers"},
      {replaced(ply, "list uchar int vertex_indices", "list float int vertex_indices"),
       "must be of a whole number's type"},
      {replaced(ply, "int vertex_indices", "int corners"), "the element 'face' needs one list 'vertex_indices'"},
      {replaced(ply, "element face 6", "element face 0"), "the file has no faces"},
      {replaced(ply, "element face 6", "element tristrips 6"), "the faces are triangle strips"},
      {replaced(ply, "element camera 1", "element vertex 1"), "the header has a second element 'vertex'"},
      {replaced(ply, "obj_info none", "texture none"), "a.any:4: unknown line 'texture' in the header"},
      {replaced(ply, "1 0.5 4 0 3 2 1", "1 0.5 4 0 3 2 8"), "the face has the vertex 8 (from 0), but the file has 8"},
      {replaced(ply, "1 0.5 4 0 3 2 1", "1 0.5 2 0 3 2 1"), "a face of 2 vertices"},
      {replaced(ply, "1 0.5 4 0 3 2 1", "1 0.5 -4 0 3 2 1"), "the length of a list is -4"},
      {replaced(ply, "1 0.5 4 0 3 2 1", "1 0.5 4000000000 0 3 2 1"), "announces 4000000000 values of a list"},
      {ply + "x", "unexpected 'x' where the file should end"},
      {bytes + "x", "a.any: byte " + at_end + ": 1 bytes follow after the last element"},
      {bytes.substr(0, bytes.size() - 2), "file ends within a value of a property"},
  };
  for (const BadSurface& bad : cases) {
    const std::string message = refusal([&] { (void)read(bad.content); });
    EXPECT_NE(message.find(bad.message), std::string::npos) << "wanted: " << bad.message << "\ngot: " << message;
  }
}

/// What else people have is named.
TEST(Surfaces, OtherFilesAreNamed) {
  std::string iges(72, ' ');
  iges += "S      1\n";
  const std::vector<BadSurface> cases{{"$MeshFormat\n2.2 0 8\n", "a Gmsh mesh"},
                                      {"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n", "a legacy VTK file"},
                                      {"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">", "a VTK XML file"},
                                      {"MeshVersionFormatted 2\nDimension 3\n", "a Medit mesh"},
                                      {"** x\n*NODE\n1,0,0,0\n", "an Abaqus input file"},
                                      {"ISO-10303-21;\nHEADER;\n", "a STEP model"},
                                      {iges, "an IGES model"},
                                      {"glTF\x02", "a glTF scene"},
                                      {"{\n \"asset\": {\"version\": \"2.0\"}}", "a glTF scene"},
                                      {"PK\x03\x04 3D/3dmodel.model", "a zip archive, as 3MF models are"},
                                      {"\x89PNG\r\n", "a picture"}};
  for (const char* name : {"a.any", "a.stl", "a.obj"})
    for (const BadSurface& other : cases) {
      const std::string message = refusal([&] { (void)read(other.content, name); });
      EXPECT_NE(message.find(std::string(name) + ": the file is " + other.message +
                             ", and a surface is read from STL, OBJ, PLY or OFF: export it as one of these"),
                std::string::npos)
          << message;
    }
}

TEST(Surfaces, DamagedFilesAreReadOrRefused) {
  const TempFolder folder;
  std::mt19937_64 random(17);
  std::size_t refused = 0;
  const std::vector<std::string> samples{obj_box(true, "/1/1"), off_box("COFF\n8 6 0\n", " 1 0 0 1"),
                                         ply_box<std::uint8_t, std::int32_t>("ascii", "uchar", "int"),
                                         ply_box<std::int32_t, std::uint16_t>("binary_big_endian", "int", "ushort")};
  for (const std::string& whole : samples) {
    for (std::size_t size = 0; size < whole.size(); ++size)
      refused += !refusal([&] { (void)read_surface(folder.write("a.any", whole.substr(0, size))); }).empty();
    for (int i = 0; i < 500; ++i) {
      std::string damaged = whole;
      for (int flips = 1 + i % 3; flips > 0; --flips) damaged[random() % damaged.size()] = static_cast<char>(random());
      refused += !refusal([&] {
                    const TriangleSurface surface = read_surface(folder.write("a.any", damaged));
                    EXPECT_TRUE(surface.vertices.allFinite());
                    for (const Triangle& t : surface.triangles)
                      for (const Index v : t) EXPECT_TRUE(v >= 0 && v < surface.vertices.rows());
                  }).empty();
    }
  }
  EXPECT_GT(refused, 1000u);
}

}  // namespace
}  // namespace softkin
