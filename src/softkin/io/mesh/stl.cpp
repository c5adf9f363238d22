#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/surface_builder.hpp>
#include <softkin/io/mesh/surface_files.hpp>
#include <softkin/io/scanner.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softkin {

namespace {

constexpr std::size_t kHeaderBytes = 84;  // 80 of text, the number of facets
constexpr std::size_t kFacetBytes = 50;   // normal, three vertices, two bytes of attribute
constexpr bool kSwap = std::endian::native == std::endian::big;

using Corner = SurfaceCorner;
using Corners = FacetCorners;

bool is_token(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

void check_area(const Scanner& scanner, std::size_t facet, const Corners& corners) {
  const auto point = [&](int i) { return Vec3(corners[i][0], corners[i][1], corners[i][2]); };
  if (facet_normal(point(0), point(1), point(2)).isZero(0))
    scanner.fail("facet " + std::to_string(facet) + " has no area");
}

std::uint32_t announced_facets(const std::string& content) {
  return Scanner("", std::string_view(content).substr(80)).binary<std::uint32_t>("", kSwap);
}

/// The word "solid" does not decide: binary files may begin with it too. Their size does; and text holds no zero byte.
bool is_binary(const std::string& content) {
  if (content.size() >= kHeaderBytes && content.size() == kHeaderBytes + kFacetBytes * announced_facets(content))
    return true;
  Scanner scanner("", content);
  const bool solid = !scanner.at_end() && is_token(scanner.token("solid"), "solid");
  return !solid || std::string_view(content).substr(0, kHeaderBytes).find('\0') != std::string_view::npos;
}

TriangleSurface read_binary(Scanner& scanner) {
  scanner.binary_positions(true);
  scanner.take(80, "the header");
  const auto facets = scanner.binary<std::uint32_t>("the number of facets", kSwap);
  if (facets == 0) scanner.fail("the file has no facets");
  if (scanner.remaining() / kFacetBytes < facets)
    scanner.fail("announces " + std::to_string(facets) + " facets, but the file ends after " +
                 std::to_string(scanner.remaining() / kFacetBytes));
  const auto coordinate = [&](const char* what) {
    const double value = scanner.binary<float>(what, kSwap);
    if (!std::isfinite(value)) scanner.fail(std::string(what) + " must be a finite number");
    return value;
  };
  Welder welder;
  for (std::size_t facet = 0; facet < facets; ++facet) {
    Corners corners;
    for (int i = 0; i < 3; ++i) coordinate("normal of a facet");
    for (Corner& corner : corners)
      for (double& x : corner) x = coordinate("coordinate");
    check_area(scanner, facet, corners);
    scanner.take(2, "a facet");
    welder.add(corners);
  }
  if (scanner.remaining() > 0) {
    const std::size_t more = scanner.remaining();
    scanner.take(more, "the end");
    scanner.fail(std::to_string(more) + " bytes follow after the last facet");
  }
  return std::move(welder).surface();
}

void expect(Scanner& scanner, const char* word) {
  const std::string_view found = scanner.token(word);
  if (!is_token(found, word))
    scanner.fail("expected '" + std::string(word) + "', found '" + std::string(found.substr(0, 40)) + "'");
}

Corners read_ascii_facet(Scanner& scanner) {
  Corners corners;
  expect(scanner, "normal");
  for (int i = 0; i < 3; ++i) scanner.real("normal of a facet");
  expect(scanner, "outer");
  expect(scanner, "loop");
  for (Corner& corner : corners) {
    expect(scanner, "vertex");
    for (double& x : corner) x = scanner.real("coordinate");
  }
  expect(scanner, "endloop");
  expect(scanner, "endfacet");
  return corners;
}

TriangleSurface read_ascii(Scanner& scanner) {
  Welder welder;
  std::size_t facets = 0;
  while (!scanner.at_end()) {  // a file may hold several solids
    expect(scanner, "solid");
    scanner.skip_line();
    while (true) {
      const std::string_view word = scanner.token("endsolid");
      if (is_token(word, "endsolid")) break;
      if (!is_token(word, "facet"))
        scanner.fail("expected 'facet' or 'endsolid', found '" + std::string(word.substr(0, 40)) + "'");
      const Corners corners = read_ascii_facet(scanner);
      check_area(scanner, facets++, corners);
      welder.add(corners);
    }
    scanner.skip_line();
  }
  if (facets == 0) scanner.fail("the file has no facets");
  return std::move(welder).surface();
}

template <class T>
void append(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (kSwap) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

void append(std::string& bytes, const Vec3& vector) {
  for (int i = 0; i < 3; ++i) append(bytes, static_cast<float>(vector[i]));
}

}  // namespace

TriangleSurface read_stl(const std::string& file, const std::string& content) {
  Scanner scanner(file, content);
  if (content.empty()) scanner.fail("the file is empty");
  return is_binary(content) ? read_binary(scanner) : read_ascii(scanner);
}

TriangleSurface read_stl(const std::filesystem::path& path) {
  return read_stl(path.string(), read_file(path));
}

void write_stl(const std::filesystem::path& path, const Points& vertices, const std::vector<Triangle>& triangles) {
  const auto fail = [&](const std::string& message) { throw InvalidInput({path.string()}, message); };
  if (triangles.empty()) fail("nothing to write: there are no facets");
  if (triangles.size() > std::numeric_limits<std::uint32_t>::max()) fail("an STL file cannot hold so many facets");
  std::string bytes = "softkin";
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::array<Vec3, 3> corners;
    for (int k = 0; k < 3; ++k) {
      const Index vertex = triangles[i][k];
      if (vertex < 0 || vertex >= vertices.rows())
        fail("facet " + std::to_string(i) + " has the vertex " + std::to_string(vertex) + ", which does not exist");
      corners[k] = vertices.row(vertex).transpose();
      if (!(corners[k].array().abs() <= std::numeric_limits<float>::max()).all())
        fail("vertex " + std::to_string(vertex) + " is not finite in single precision");
      corners[k] = corners[k].cast<float>().cast<double>();
    }
    const Vec3 normal = facet_normal(corners[0], corners[1], corners[2]);
    if (normal.isZero(0)) fail("facet " + std::to_string(i) + " has no area in single precision");
    append(bytes, Vec3(normal.normalized()));
    for (const Vec3& corner : corners) append(bytes, corner);
    append(bytes, std::uint16_t{0});
  }
  write_file(path, bytes);
}

}  // namespace softkin
