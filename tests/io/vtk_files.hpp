#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <stdexcept>
#include <string>
#include <vector>

// Small independent writers of VTK's forms, for the tests of the readers.
namespace vtk_files {

namespace fs = std::filesystem;

class TempFolder {
 public:
  TempFolder() {
    std::string name = (fs::temp_directory_path() / "softkin_vtk_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TempFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] fs::path file(const std::string& name) const { return path_ / name; }
  [[nodiscard]] fs::path write(const std::string& name, const std::string& content) const {
    fs::remove(file(name));  // writing over a file is slow on some file systems
    std::ofstream(file(name), std::ios::binary) << content;
    return file(name);
  }

 private:
  fs::path path_;
};

inline std::string slurp(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Values as bytes; these tests run on little-endian machines.
template <class T>
std::string packed(const std::vector<T>& values, bool big = false) {
  std::string bytes;
  for (const T value : values) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big) std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
  }
  return bytes;
}

inline std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text, bits;
  for (const char c : bytes)
    for (int i = 7; i >= 0; --i) bits += (c >> i & 1) ? '1' : '0';
  while (bits.size() % 6) bits += '0';
  for (std::size_t i = 0; i < bits.size(); i += 6) text += digits[std::stoi(bits.substr(i, 6), nullptr, 2)];
  while (text.size() % 4) text += '=';
  return text;
}

inline std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string block(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(block.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), 9) != Z_OK)
    throw std::runtime_error("compress2");
  block.resize(size);
  return block;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("the test's own file has no '" + from + "'");
  return text.replace(at, from.size(), to);
}

/// what() of the InvalidInput that action throws, or "" where it throws nothing.
inline std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const softkin::InvalidInput& error) {
    return error.what();
  }
  return "";
}

inline const softkin::Region& region(const softkin::Mesh& mesh, const std::string& name) {
  for (const softkin::Region& candidate : mesh.regions)
    if (candidate.name == name) return candidate;
  throw std::runtime_error("no region " + name);
}

inline std::vector<std::string> region_names(const softkin::Mesh& mesh) {
  std::vector<std::string> names;
  for (const softkin::Region& each : mesh.regions) names.push_back(each.name);
  std::sort(names.begin(), names.end());
  return names;
}

// One wedge with a tetrahedron below and one above, a triangle, a quad, a line and a vertex.
inline const std::vector<double> kPoints{0, 0, 0, 1, 0, 0, 0,   1,   0,    0,    0,    1,
                                         1, 0, 1, 0, 1, 1, 0.5, 0.5, -0.5, 0.25, 0.25, 2};
inline const std::vector<int> kConnectivity{0, 1, 2, 3, 4, 5, 0, 2, 1, 6, 3, 4, 5, 7, 0, 1, 2, 0, 1, 4, 3, 0, 1, 7};
inline const std::vector<int> kOffsets{6, 10, 14, 17, 21, 23, 24};
inline const std::vector<int> kTypes{13, 10, 10, 5, 9, 3, 1};
inline const std::vector<int> kMaterial{1, 2, 1, 2, 2, 5, 5};

/// The mesh above, with the regions that the array `material` makes.
inline void expect_reference_mesh(const softkin::Mesh& mesh) {
  using Indices = std::vector<softkin::Index>;
  ASSERT_EQ(mesh.vertices.rows(), 8);
  for (int i = 0; i < 24; ++i) EXPECT_EQ(mesh.vertices(i / 3, i % 3), kPoints[i]) << i;
  ASSERT_EQ(mesh.prisms.size(), 1u);
  EXPECT_EQ(mesh.prisms[0], (softkin::Prism{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(mesh.tetrahedra, (std::vector<softkin::Tetrahedron>{{0, 2, 1, 6}, {3, 4, 5, 7}}));
  EXPECT_EQ(mesh.triangles, (std::vector<softkin::Triangle>{{0, 1, 2}}));
  EXPECT_EQ(mesh.quads, (std::vector<softkin::Quad>{{0, 1, 4, 3}}));
  EXPECT_EQ(region_names(mesh),
            (std::vector<std::string>{"material_1", "material_2", "material_2_2d", "material_5", "material_5_0d"}));
  const softkin::Region &one = region(mesh, "material_1"), &two = region(mesh, "material_2");
  EXPECT_EQ(one.dimension, 3);
  EXPECT_EQ(one.prisms, Indices{0});
  EXPECT_EQ(one.tetrahedra, Indices{1});
  EXPECT_EQ(two.dimension, 3);
  EXPECT_EQ(two.tetrahedra, Indices{0});
  EXPECT_TRUE(two.prisms.empty() && two.triangles.empty());
  const softkin::Region& flat = region(mesh, "material_2_2d");
  EXPECT_EQ(flat.dimension, 2);
  EXPECT_EQ(flat.triangles, Indices{0});
  EXPECT_EQ(flat.quads, Indices{0});
  EXPECT_EQ(region(mesh, "material_5").dimension, 1);
  EXPECT_EQ(region(mesh, "material_5").vertices, (Indices{0, 1}));
  EXPECT_EQ(region(mesh, "material_5_0d").dimension, 0);
  EXPECT_EQ(region(mesh, "material_5_0d").vertices, Indices{7});
}

/// Written by Gmsh 4.8.4 with order 2: a vertex, a line, a triangle and a tetrahedron.
inline const std::string kQuadraticLegacy = R"(# vtk DataFile Version 2.0
t, Created by Gmsh
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 10 double
0 0 0
2 0 0
0 4 0
0 0 6
0.9999999999973436 0 0
1.000000000002657 1.999999999994685 0
0 2.000000000005322 0
0 0 2.999999999990317
1.000000000003171 0 2.999999999990488
0 2.000000000006107 2.99999999999084

CELLS 4 24
1 3
3 1 3 8
6 0 1 2 4 5 6
10 0 2 3 1 6 9 7 4 5 8

CELL_TYPES 4
1
21
22
24

CELL_DATA 4
SCALARS CellEntityIds int 1
LOOKUP_TABLE default
4
3
2
1
)";

/// How xml_file() writes its arrays.
struct XmlForm {
  enum class Format { ascii, binary, raw, base64 } format = Format::ascii;
  bool big = false, long_header = false, compressed = false, separate_header = false, float32 = false, int64 = true;
  std::size_t block = 40;  // bytes; small, so that arrays have several blocks and a partial one
};

class XmlWriter {
 public:
  explicit XmlWriter(const XmlForm& form) : form_(form) {}

  template <class T>
  std::string array(const std::string& type, const std::string& name, int components, const std::vector<T>& values) {
    std::string head = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                       std::to_string(components) + "\" format=\"";
    if (form_.format == XmlForm::Format::ascii) {
      std::string text;
      for (const T value : values) text += std::to_string(value) + "\n";
      return head + "ascii\">\n" + text + "</DataArray>\n";
    }
    const std::string data = packed(values, form_.big);
    if (form_.format == XmlForm::Format::binary) return head + "binary\">\n  " + encoded(data) + "\n</DataArray>\n";
    head += "appended\" offset=\"" + std::to_string(appended.size()) + "\"/>\n";
    appended += encoded(data);
    return head;
  }

  std::string appended;

 private:
  std::string words(const std::vector<std::uint64_t>& values) const {
    if (form_.long_header) return packed(values, form_.big);
    return packed(std::vector<std::uint32_t>(values.begin(), values.end()), form_.big);
  }

  std::string encoded(const std::string& data) const {
    const bool raw = form_.format == XmlForm::Format::raw;
    if (!form_.compressed) {
      const std::string header = words({data.size()});
      if (raw) return header + data;
      return form_.separate_header ? base64(header) + base64(data) : base64(header + data);
    }
    std::vector<std::uint64_t> header{(data.size() + form_.block - 1) / form_.block, form_.block,
                                      data.size() % form_.block};
    std::string blocks;
    for (std::size_t i = 0; i < data.size(); i += form_.block) {
      const std::string block = deflated(data.substr(i, form_.block));
      header.push_back(block.size());
      blocks += block;
    }
    return raw ? words(header) + blocks : base64(words(header)) + base64(blocks);
  }

  XmlForm form_;
};

/// The reference mesh as .vtu.
inline std::string xml_file(const XmlForm& form) {
  XmlWriter writer(form);
  std::string xml =
      std::string("<?xml version=\"1.0\"?>\n<!-- <AppendedData> -->\n<VTKFile type=\"UnstructuredGrid\" ") +
      "version=\"1.0\" byte_order=\"" + (form.big ? "BigEndian" : "LittleEndian") + "\"";
  if (form.long_header) xml += " header_type=\"UInt64\"";
  if (form.compressed) xml += " compressor=\"vtkZLibDataCompressor\"";
  xml += ">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"8\" NumberOfCells=\"7\">\n<Points>\n";
  xml += form.float32 ? writer.array("Float32", "Points", 3, std::vector<float>(kPoints.begin(), kPoints.end()))
                      : writer.array("Float64", "Points", 3, kPoints);
  xml += "</Points>\n<Cells>\n";
  if (form.int64) {
    xml +=
        writer.array("Int64", "connectivity", 1, std::vector<std::int64_t>(kConnectivity.begin(), kConnectivity.end()));
    xml += writer.array("Int64", "offsets", 1, std::vector<std::int64_t>(kOffsets.begin(), kOffsets.end()));
  } else {
    xml += writer.array("Int32", "connectivity", 1, kConnectivity);
    xml += writer.array("UInt16", "offsets", 1, std::vector<std::uint16_t>(kOffsets.begin(), kOffsets.end()));
  }
  xml += writer.array("UInt8", "types", 1, std::vector<std::uint8_t>(kTypes.begin(), kTypes.end()));
  xml += "</Cells>\n<CellData>\n" + writer.array("Float64", "stress", 1, std::vector<double>(7, 0.5));
  xml += writer.array("Int16", "material", 1, std::vector<std::int16_t>(kMaterial.begin(), kMaterial.end()));
  xml += "</CellData>\n</Piece>\n</UnstructuredGrid>\n";
  if (form.format == XmlForm::Format::raw) xml += "<AppendedData encoding=\"raw\">\n_" + writer.appended;
  if (form.format == XmlForm::Format::base64) xml += "<AppendedData encoding=\"base64\">\n  _" + writer.appended;
  if (!writer.appended.empty()) xml += "\n</AppendedData>\n";
  return xml + "</VTKFile>\n";
}

/// The reference mesh as a legacy file: cells as counts (version 3.0) or offsets (5.1), text or big-endian binary.
inline std::string legacy_file(bool binary, bool offsets) {
  const auto doubles = [&](const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text += std::to_string(value) + " ";
    return (binary ? packed(values, true) : text) + "\n";
  };
  const auto integers = [&](const auto& values) {
    std::string text;
    for (const auto value : values) text += std::to_string(value) + " ";
    return (binary ? packed(values, true) : text) + "\n";
  };
  std::string file = std::string("# vtk DataFile Version ") + (offsets ? "5.1" : "3.0") + "\ntitle\n" +
                     (binary ? "BINARY" : "ASCII") + "\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n" +
                     doubles(kPoints);
  if (offsets) {
    std::vector<std::int64_t> ends{0};
    ends.insert(ends.end(), kOffsets.begin(), kOffsets.end());
    file += "CELLS 8 24\nOFFSETS vtktypeint64\n" + integers(ends) + "CONNECTIVITY vtktypeint64\n" +
            integers(std::vector<std::int64_t>(kConnectivity.begin(), kConnectivity.end()));
  } else {
    std::vector<int> counted;
    int begin = 0;
    for (const int end : kOffsets) {
      counted.push_back(end - begin);
      for (; begin < end; ++begin) counted.push_back(kConnectivity[begin]);
    }
    file += "CELLS 7 31\n" + integers(counted);
  }
  file += "CELL_TYPES 7\n" + integers(kTypes);
  file += "CELL_DATA 7\nSCALARS material int 1\nLOOKUP_TABLE default\n" + integers(kMaterial);
  return file;
}

}  // namespace vtk_files
