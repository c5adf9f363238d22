#include <cctype>
#include <cmath>
#include <limits>
#include <random>
#include <softkin/io/mesh/mesh_io.hpp>

#include "io/vtk_files.hpp"

namespace softkin {
namespace {

using namespace vtk_files;
using Facets = std::vector<std::vector<float>>;  // nine coordinates each

// A unit tetrahedron, normals outwards: volume 1/6.
const Facets kTetrahedron{
    {0, 0, 0, 0, 1, 0, 1, 0, 0}, {0, 0, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 1, 0, 1, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};

std::string ascii(const Facets& facets) {
  std::string text = "solid some name\n";
  for (const auto& facet : facets) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (int i = 0; i < 9; i += 3)
      text += "      vertex " + std::to_string(facet[i]) + " " + std::to_string(facet[i + 1]) + " " +
              std::to_string(facet[i + 2]) + "\n";
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid some name\n";
}

std::string binary(const Facets& facets, const std::string& title = "made by hand") {
  std::string bytes = title;
  bytes.resize(80, '\0');
  bytes += packed<std::uint32_t>({static_cast<std::uint32_t>(facets.size())});
  for (const auto& facet : facets) bytes += packed<float>({0, 0, 0}) + packed(facet) + std::string(2, '\x01');
  return bytes;
}

TriangleSurface read_text(const std::string& content) {
  const TempFolder folder;
  return read_stl(folder.write("a.stl", content));
}

void expect_tetrahedron(const TriangleSurface& surface) {
  ASSERT_EQ(surface.vertices.rows(), 4);
  EXPECT_EQ(surface.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {2, 1, 3}}));
  EXPECT_EQ(Vec3(surface.vertices.row(1)), Vec3(0, 1, 0));
  EXPECT_NEAR(enclosed_volume(surface.vertices, surface.triangles), 1.0 / 6, 1e-15);
}

TEST(Stl, ReadsBothForms) {
  expect_tetrahedron(read_text(ascii(kTetrahedron)));
  expect_tetrahedron(read_text(binary(kTetrahedron)));
}

TEST(Stl, ReadsBinaryThatBeginsWithSolid) {
  expect_tetrahedron(read_text(binary(kTetrahedron, "solid by a CAD program")));
  expect_tetrahedron(read_text(binary(kTetrahedron, std::string(80, ' ').replace(0, 6, "solid "))));
}

TEST(Stl, ReadsUpperCaseNegativeZeroAndSeveralSolids) {
  std::string text = ascii(kTetrahedron);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  expect_tetrahedron(read_text(text));
  expect_tetrahedron(read_text(replaced(ascii(kTetrahedron), "vertex 0.0", "vertex -0.0")));
  expect_tetrahedron(read_text(ascii({kTetrahedron[0], kTetrahedron[1]}) + ascii({kTetrahedron[2], kTetrahedron[3]})));
}

TEST(Stl, RoundTrip) {
  const TriangleSurface surface = read_text(ascii(kTetrahedron));
  const TempFolder folder;
  write_stl(folder.file("b.stl"), surface.vertices, surface.triangles);
  expect_tetrahedron(read_stl(folder.file("b.stl")));
  const std::string bytes = slurp(folder.file("b.stl"));
  ASSERT_EQ(bytes.size(), 84u + 4 * 50);
  EXPECT_EQ(bytes.substr(84, 12), packed<float>({0, 0, -1}));  // of the facet in z = 0
}

TEST(Stl, WriterRefuses) {
  const TempFolder folder;
  Points points = Eigen::Map<const Points>(kPoints.data(), 8, 3);
  const auto message = [&](const std::vector<Triangle>& triangles) {
    const std::string text = refusal([&] { write_stl(folder.file("a.stl"), points, triangles); });
    EXPECT_FALSE(fs::exists(folder.file("a.stl")));
    return text;
  };
  EXPECT_NE(message({}).find("no facets"), std::string::npos);
  EXPECT_NE(message({{0, 1, 8}}).find("facet 0 has the vertex 8"), std::string::npos);
  EXPECT_NE(message({{0, 1, 2}, {0, 1, 1}}).find("facet 1 has no area"), std::string::npos);
  points(2, 1) = 1e39;
  EXPECT_NE(message({{0, 1, 2}}).find("vertex 2 is not finite"), std::string::npos);
  points(2, 1) = std::nan("");
  EXPECT_NE(message({{0, 1, 2}}).find("vertex 2 is not finite"), std::string::npos);
}

struct Bad {
  const char* message;
  std::string content;
};

TEST(Stl, RefusesBadFiles) {
  const std::string text = ascii(kTetrahedron), bytes = binary(kTetrahedron);
  const auto with_floats = [&](std::size_t at, float value) {
    std::string copy = bytes;
    return copy.replace(at, 4, packed<float>({value}));
  };
  const Facets line{kTetrahedron[0], {0, 0, 0, 1, 1, 1, 3, 3, 3}};
  std::string many = bytes;
  many.replace(80, 4, packed<std::uint32_t>({4000000000u}));
  const std::vector<Bad> cases{
      {"a.stl:1: the file is empty", ""},
      {"a.stl:2: the file has no facets", "solid x\nendsolid x\n"},
      {"a.stl: byte 80: the file has no facets", binary({})},
      {"a.stl:5: coordinate must be a finite number, not 'nan'",
       replaced(text, "vertex 0.000000 1.000000", "vertex nan 1")},
      {"a.stl:4: coordinate must be a finite number, not '1e999'", replaced(text, "vertex 0.000000", "vertex 1e999")},
      {"a.stl:2: normal of a facet must be a finite number", replaced(text, "normal 0", "normal inf")},
      {"a.stl:7: expected 'endloop', found 'vertex'", replaced(text, "endloop", "vertex 0 0 0\nendloop")},
      {"a.stl:6: expected 'vertex', found 'endloop'", replaced(text, "      vertex 1.000000 0.000000 0.000000\n", "")},
      {"a.stl:9: expected 'facet' or 'endsolid', found 'faced'",
       replaced(text, "endfacet\n  facet", "endfacet\n  faced")},
      {"a.stl:15: facet 1 has no area", ascii(line)},
      {"a.stl: byte 178: facet 1 has no area", binary(line)},
      {"a.stl: byte 96: coordinate must be a finite number", with_floats(96, std::numeric_limits<float>::quiet_NaN())},
      {"a.stl: byte 84: normal of a facet must be", with_floats(84, std::numeric_limits<float>::infinity())},
      {"a.stl: byte 80: announces 4 facets, but the file ends after 3", bytes.substr(0, bytes.size() - 1)},
      {"a.stl: byte 80: announces 4000000000 facets, but the file ends after 4", many},
      {"a.stl: byte 284: 3 bytes follow after the last facet", bytes + "abc"},
      {"a.stl: byte 0: file ends within the header", "something else"},
      {"file ends before endsolid", text.substr(0, text.size() - 19)},
  };
  for (const Bad& bad : cases) {
    const std::string message = refusal([&] { (void)read_text(bad.content); });
    EXPECT_NE(message.find(bad.message), std::string::npos) << bad.message << "\n" << message;
  }
}

TEST(Stl, DamagedFilesAreReadOrRefused) {
  const TempFolder folder;
  std::mt19937_64 random(11);
  std::size_t refused = 0;
  for (const std::string& whole : {ascii(kTetrahedron), binary(kTetrahedron)}) {
    for (std::size_t size = 0; size < whole.size(); ++size)
      refused += !refusal([&] { (void)read_stl(folder.write("a.stl", whole.substr(0, size))); }).empty();
    for (int i = 0; i < 1000; ++i) {
      std::string damaged = whole;
      damaged[random() % damaged.size()] = static_cast<char>(random());
      refused += !refusal([&] { (void)read_stl(folder.write("a.stl", damaged)); }).empty();
    }
  }
  EXPECT_GT(refused, 700u);
}

}  // namespace
}  // namespace softkin
