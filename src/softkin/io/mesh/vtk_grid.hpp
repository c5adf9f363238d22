#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <softkin/io/scanner.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <vector>

namespace softkin {

/// The number types of VTK files.
enum class NumberType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

[[nodiscard]] std::size_t size_of(NumberType type);
[[nodiscard]] bool is_integer(NumberType type);

/// Numbers out of a scanner, as text or binary (swap: not in this machine's byte order).
class NumberReader {
 public:
  NumberReader(Scanner& scanner, bool binary, bool swap) : scanner_(scanner), binary_(binary), swap_(swap) {}

  /// A finite number of any type.
  double real(NumberType type, const char* what);
  /// A number of an integer type, which must fit 64 bits with sign.
  std::int64_t integer(NumberType type, const char* what);
  /// Fails unless count numbers can still follow.
  void require(std::uint64_t count, NumberType type, const char* what) const;

 private:
  template <class T>
  double next_real(const char* what);
  template <class T>
  std::int64_t next_integer(const char* what);

  Scanner& scanner_;
  bool binary_, swap_;
};

/// An integer array over the cells of a VTK file.
struct CellLabels {
  std::string name;
  std::vector<std::int64_t> values;               // one per cell
  std::optional<std::vector<std::string>> names;  // of the values 0, 1, ...; a cell of value -1 has no name
  Origin origin;
};

/// An unstructured grid as the VTK formats hold it; vertices and types are checked by the code that fills it.
struct CellGrid {
  Points points;
  std::vector<std::uint8_t> types;     // VTK cell types for which cell_refusal() is empty
  std::vector<std::size_t> starts{0};  // where each cell begins in connectivity, and the end: #cells + 1
  std::vector<Index> connectivity;
  std::vector<CellLabels> labels;
};

/// Why a cell of this VTK type with so many vertices cannot be read, or "". cell counts from 0.
[[nodiscard]] std::string cell_refusal(std::size_t cell, std::int64_t type, std::size_t vertices);

/// The grid as a mesh. Labels become regions: "NAME_VALUE", or the value's own name. Where a value covers cells of
/// several dimensions, those of the highest have that name and the others "..._2d", "_1d", "_0d". Labels with more
/// than 1000 distinct values and no names are ids of cells, not regions, and are left out.
///
/// throws  InvalidInput at origin where there is no tetrahedron, wedge or triangle, or orders are mixed; at the label's
///         origin where a value has no name or two regions have the same name
[[nodiscard]] Mesh mesh_of(const CellGrid& grid, const Origin& origin);

}  // namespace softkin
