#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

// One small mesh, a prism with a tetrahedron on it, in every form of .msh that softkin reads. Groups overlap, "body"
// names groups of two dimensions, numbers are sparse and unordered, one vertex is in no element, one triangle in no
// group.
namespace gmsh_samples {

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "softkin_gmsh_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] std::filesystem::path put(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline const std::string kText2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Comments
by hand
$EndComments
$PhysicalNames
6
0 7 "tip"
1 4 "edge"
2 1 "base"
2 3 "body"
3 1 "body"
3 2 "soft part"
$EndPhysicalNames
$Nodes
8
50 1 0 1
10 0 0 0
20 1 0 0
30 0 1 0
40 0 0 1
60 0 1 1
5 0 0 2
7 9 9 9
$EndNodes
$Elements
11
1 15 2 7 1 5
2 1 2 4 1 10 40
3 1 2 4 1 40 5
4 2 2 1 1 30 20 10
5 2 2 9 1 10 20 30
6 3 2 3 2 10 20 50 40
7 3 2 9 2 10 20 50 40
8 2 2 0 3 40 50 60
9 6 4 1 1 1 2 10 20 30 40 50 60
10 4 2 1 2 40 50 60 5
11 4 2 2 2 40 50 60 5
$EndElements
)";

inline const std::string kText4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
6
0 7 "tip"
1 4 "edge"
2 1 "base"
2 3 "body"
3 1 "body"
3 2 "soft part"
$EndPhysicalNames
$Entities
1 1 3 2
1 0 0 2 1 7 
1 0 0 0 0 0 2 1 4 2 1 -1 
1 0 0 0 1 1 0 2 1 -9 0 
2 0 0 0 1 0 1 2 3 9 0 
3 0 0 1 1 1 1 0 0 
1 0 0 0 1 1 1 1 1 3 1 2 3 
2 0 0 1 1 1 2 2 1 2 0 
$EndEntities
$Nodes
3 8 5 60
3 1 0 5
50
10
20
30
40
1 0 1
0 0 0
1 0 0
0 1 0
0 0 1
2 3 1 2
60
5
0 1 1 0.5 0.5
0 0 2 0.5 0.5
3 2 0 1
7
9 9 9
$EndNodes
$Periodic
1
0 1 1
0
0
$EndPeriodic
$Elements
7 8 1 10
0 1 15 1
1 5 
1 1 1 2
2 10 40 
3 40 5 
2 1 2 1
4 30 20 10 
2 2 3 1
5 10 20 50 40 
2 3 2 1
8 40 50 60 
3 1 6 1
9 10 20 30 40 50 60 
3 2 4 1
10 40 50 60 5 
$EndElements
)";

/// Written by Gmsh 4.8.4 with order 2: a tetrahedron, "base" its side z = 0, "edge" from (2, 0, 0) to "tip" (0, 0, 6).
inline const std::string kQuadratic2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
0 4 "tip"
1 3 "edge"
2 2 "base"
3 1 "body"
$EndPhysicalNames
$Nodes
10
1 0 0 0
2 2 0 0
3 0 4 0
4 0 0 6
5 0.9999999999973436 0 0
6 1.000000000002657 1.999999999994685 0
7 0 2.000000000005322 0
8 0 0 2.999999999990317
9 1.000000000003171 0 2.999999999990488
10 0 2.000000000006107 2.99999999999084
$EndNodes
$Elements
4
1 15 2 4 4 4
2 8 2 3 5 2 4 9
3 9 2 2 1 1 2 3 5 6 7
4 11 2 1 1 1 3 4 2 7 10 8 5 9 6
$EndElements
)";
inline const std::string kQuadratic4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
4
0 4 "tip"
1 3 "edge"
2 2 "base"
3 1 "body"
$EndPhysicalNames
$Entities
4 6 4 1
1 0 0 0 0 
2 2 0 0 0 
3 0 4 0 0 
4 0 0 6 1 4 
1 0 0 0 2 0 0 0 2 1 -2 
2 0 0 0 2 4 0 0 2 2 -3 
3 0 0 0 0 4 0 0 2 3 -1 
4 0 0 0 0 0 6 0 2 1 -4 
5 0 0 0 2 0 6 1 3 2 2 -4 
6 0 0 0 0 4 6 0 2 3 -4 
1 0 0 0 2 4 0 1 2 3 1 2 3 
2 0 0 0 2 0 6 0 3 1 5 -4 
3 0 0 0 2 4 6 0 3 2 6 -5 
4 0 0 0 0 4 6 0 3 3 4 -6 
1 0 0 0 2 4 6 1 1 4 1 2 3 4 
$EndEntities
$Nodes
12 10 1 10
0 1 0 1
1
0 0 0
0 2 0 1
2
2 0 0
0 3 0 1
3
0 4 0
0 4 0 1
4
0 0 6
1 1 0 1
5
0.9999999999973436 0 0
1 2 0 1
6
1.000000000002657 1.999999999994685 0
1 3 0 1
7
0 2.000000000005322 0
1 4 0 1
8
0 0 2.999999999990317
1 5 0 1
9
1.000000000003171 0 2.999999999990488
1 6 0 1
10
0 2.000000000006107 2.99999999999084
2 1 0 0
3 1 0 0
$EndNodes
$Elements
4 4 1 4
0 4 15 1
1 4 
1 5 8 1
2 2 4 9 
2 1 9 1
3 1 2 3 5 6 7 
3 1 11 1
4 1 3 4 2 7 10 8 5 9 6 
$EndElements
)";

/// Written by Gmsh 4.8.4 (4.1 binary): the unit tetrahedron; "body" and "half" its volume, "base" (reversed) and 6
/// (unnamed) share a side.
inline std::string written_by_gmsh() {
  const std::string hex =
      "244d657368466f726d61740a342e31203120380a010000000a24456e644d657368466f726d61740a24506879736963616c4e616d6573"
      "0a350a3020382022746970220a312037202265646765220a322035202262617365220a3320312022626f6479220a332032202268616c"
      "66220a24456e64506879736963616c4e616d65730a24456e7469746965730a0400000000000000060000000000000004000000000000"
      "000100000000000000010000000000000000000000000000000000000000000000000000000000000000000000020000000000000000"
      "00f03f000000000000000000000000000000000000000000000000030000000000000000000000000000000000f03f00000000000000"
      "0000000000000000000400000000000000000000000000000000000000000000000000f03f0100000000000000080000000100000000"
      "0000000000000000000000000000000000000000000000000000000000f03f0000000000000000000000000000000000000000000000"
      "00020000000000000001000000feffffff02000000000000000000000000000000000000000000000000000000000000000000f03f00"
      "0000000000f03f00000000000000000000000000000000020000000000000002000000fdffffff030000000000000000000000000000"
      "000000000000000000000000000000000000000000000000000000f03f00000000000000000000000000000000020000000000000003"
      "000000ffffffff0400000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000"
      "000000f03f010000000000000007000000020000000000000001000000fcffffff050000000000000000000000000000000000000000"
      "00000000000000000000000000f03f0000000000000000000000000000f03f0000000000000000020000000000000002000000fcffff"
      "ff060000000000000000000000000000000000000000000000000000000000000000000000000000000000f03f000000000000f03f00"
      "00000000000000020000000000000003000000fcffffff01000000000000000000000000000000000000000000000000000000000000"
      "000000f03f000000000000f03f00000000000000000200000000000000fbffffff060000000300000000000000010000000200000003"
      "00000002000000000000000000000000000000000000000000000000000000000000000000f03f0000000000000000000000000000f0"
      "3f01000000000000000600000003000000000000000100000005000000fcffffff030000000000000000000000000000000000000000"
      "00000000000000000000000000f03f000000000000f03f000000000000f03f0000000000000000030000000000000002000000060000"
      "00fbffffff040000000000000000000000000000000000000000000000000000000000000000000000000000000000f03f0000000000"
      "00f03f000000000000000003000000000000000300000004000000faffffff0100000000000000000000000000000000000000000000"
      "0000000000000000000000f03f000000000000f03f000000000000f03f02000000000000000100000002000000040000000000000001"
      "0000000200000003000000040000000a24456e64456e7469746965730a244e6f6465730a080000000000000004000000000000000100"
      "000000000000040000000000000000000000010000000000000001000000000000000100000000000000000000000000000000000000"
      "00000000000000000000000000000000020000000000000001000000000000000200000000000000000000000000f03f000000000000"
      "00000000000000000000000000000300000000000000010000000000000003000000000000000000000000000000000000000000f03f"
      "000000000000000000000000040000000000000001000000000000000400000000000000000000000000000000000000000000000000"
      "00000000f03f010000000400000000000000000000000000000002000000010000000000000000000000000000000200000002000000"
      "00000000000000000000000003000000010000000000000000000000000000000a24456e644e6f6465730a24456c656d656e74730a05"
      "0000000000000005000000000000000100000000000000050000000000000000000000040000000f0000000100000000000000010000"
      "000000000004000000000000000100000004000000010000000100000000000000020000000000000001000000000000000400000000"
      "000000020000000100000002000000010000000000000003000000000000000100000000000000020000000000000003000000000000"
      "000200000002000000020000000100000000000000040000000000000001000000000000000200000000000000040000000000000003"
      "000000010000000400000001000000000000000500000000000000010000000000000003000000000000000400000000000000020000"
      "00000000000a24456e64456c656d656e74730a";
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

/// Rewrites words as binary values.
class Transcriber {
 public:
  Transcriber(const std::string& words, bool swapped) : words_(words), swapped_(swapped) {}
  std::int64_t int_value() { return put<std::int32_t>(next<std::int32_t>()); }
  std::int64_t size_value() { return static_cast<std::int64_t>(put<std::uint64_t>(next<std::uint64_t>())); }
  void reals(std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) put<double>(next<double>());
  }
  template <class T>
  T next() {
    T value{};
    words_ >> value;
    return value;
  }
  template <class T>
  T put(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (swapped_) std::reverse(bytes, bytes + sizeof(T));
    bytes_.append(bytes, sizeof(T));
    return value;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::istringstream words_;
  std::string bytes_;
  bool swapped_;
};

/// What stands between the lines that open and close a section.
inline std::string body(const std::string& text, const std::string& section) {
  const std::size_t begin = text.find("$" + section + "\n") + section.size() + 2;
  return text.substr(begin, text.find("$End" + section) - begin);
}

inline std::string whole(const std::string& section, const std::string& content) {
  return "$" + section + "\n" + content + "$End" + section + "\n";
}

inline std::string binary_format(const std::string& version, bool swapped) {
  Transcriber mark("1", swapped);
  mark.int_value();
  return whole("MeshFormat", version + " 1 8\n" + mark.bytes() + "\n");
}

inline int node_count(std::int64_t type) {
  switch (type) {
    case 15:
      return 1;
    case 1:
      return 2;
    case 2:
    case 8:
      return 3;
    case 6:
    case 9:
      return 6;
    case 11:
      return 10;
    default:
      return 4;
  }
}

/// A text in binary; neighbours of one type and number of tags share a header.
inline std::string binary_2(bool swapped, const std::string& text = kText2) {
  Transcriber nodes(body(text, "Nodes"), swapped);
  const int count = nodes.next<int>();
  for (int i = 0; i < count; ++i) {
    nodes.int_value();
    nodes.reals(3);
  }
  Transcriber elements("", swapped);
  std::istringstream lines(body(text, "Elements"));
  std::string line, total;
  std::getline(lines, total);
  std::vector<std::vector<int>> rows;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    rows.emplace_back();
    for (int value = 0; words >> value;) rows.back().push_back(value);
  }
  for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
    while (end < rows.size() && rows[end][1] == rows[begin][1] && rows[end][2] == rows[begin][2]) ++end;
    elements.put<std::int32_t>(rows[begin][1]);
    elements.put(static_cast<std::int32_t>(end - begin));
    elements.put<std::int32_t>(rows[begin][2]);
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t k = 0; k < rows[r].size(); ++k)
        if (k != 1 && k != 2) elements.put<std::int32_t>(rows[r][k]);
  }
  return binary_format("2.2", swapped) + whole("PhysicalNames", body(text, "PhysicalNames")) +
         whole("Nodes", std::to_string(count) + "\n" + nodes.bytes() + "\n") +
         whole("Elements", total + "\n" + elements.bytes() + "\n");
}

inline std::string binary_entities_4(bool swapped, const std::string& text) {
  Transcriber out(body(text, "Entities"), swapped);
  std::int64_t counts[4];
  for (std::int64_t& count : counts) count = out.size_value();
  for (int dimension = 0; dimension < 4; ++dimension)
    for (std::int64_t i = 0; i < counts[dimension]; ++i) {
      out.int_value();
      out.reals(dimension == 0 ? 3 : 6);
      for (int list = 0; list < (dimension == 0 ? 1 : 2); ++list)
        for (std::int64_t left = out.size_value(); left > 0; --left) out.int_value();
    }
  return whole("Entities", out.bytes() + "\n");
}

inline std::string binary_nodes_4(bool swapped, const std::string& text) {
  Transcriber out(body(text, "Nodes"), swapped);
  const std::int64_t blocks = out.size_value();
  for (int i = 0; i < 3; ++i) out.size_value();
  for (std::int64_t b = 0; b < blocks; ++b) {
    const std::int64_t dimension = out.int_value();
    out.int_value();
    const std::int64_t parametric = out.int_value();
    const std::int64_t count = out.size_value();
    for (std::int64_t i = 0; i < count; ++i) out.size_value();
    out.reals(count * (3 + parametric * dimension));
  }
  return whole("Nodes", out.bytes() + "\n");
}

inline std::string binary_elements_4(bool swapped, const std::string& text) {
  Transcriber out(body(text, "Elements"), swapped);
  const std::int64_t blocks = out.size_value();
  for (int i = 0; i < 3; ++i) out.size_value();
  for (std::int64_t b = 0; b < blocks; ++b) {
    for (int i = 0; i < 2; ++i) out.int_value();
    const int nodes = node_count(out.int_value());
    for (std::int64_t left = out.size_value() * (1 + nodes); left > 0; --left) out.size_value();
  }
  return whole("Elements", out.bytes() + "\n");
}

/// A text in binary, with bytes that are no text in $Periodic.
inline std::string binary_4(bool swapped, const std::string& text = kText4) {
  return binary_format("4.1", swapped) + whole("PhysicalNames", body(text, "PhysicalNames")) +
         binary_entities_4(swapped, text) + binary_nodes_4(swapped, text) +
         whole("Periodic", std::string("\x01\0\0\n$\xff\n\n", 8)) + binary_elements_4(swapped, text);
}

inline std::string replaced(std::string text, const std::string& old, const std::string& fresh) {
  const std::size_t at = text.find(old);
  if (at == std::string::npos) throw std::logic_error("the sample has no '" + old + "'");
  return text.replace(at, old.size(), fresh);
}

/// The message of the InvalidInput that reading content as a file of that name ends with, "" where it does not.
inline std::string refusal(const std::string& content, const std::string& file) {
  try {
    (void)softkin::read_gmsh(file, content);
  } catch (const softkin::InvalidInput& error) {
    return error.what();
  }
  return "";
}

}  // namespace gmsh_samples
