#pragma once

#include <cstdint>
#include <limits>
#include <softkin/io/scanner.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <string_view>
#include <utility>

namespace softkin::gmsh {

/// Element types of the MSH format that softkin supports.
enum class CellType : int {
  line = 1,
  triangle = 2,
  quad = 3,
  tetrahedron = 4,
  prism = 6,
  quadratic_line = 8,
  quadratic_triangle = 9,
  quadratic_tetrahedron = 11,
  point = 15
};

struct CellShape {
  int dimension = 0, nodes = 0;
};

/// By the number of the type; no nodes: not a CellType.
inline constexpr CellShape kShapes[16] = {{},     {1, 2}, {2, 3}, {2, 4},  {3, 4}, {}, {3, 6}, {},
                                          {1, 3}, {2, 6}, {},     {3, 10}, {},     {}, {},     {0, 1}};
inline constexpr std::size_t kMaxNodes = 10;

[[nodiscard]] constexpr CellShape shape_of(CellType type) {
  return kShapes[static_cast<int>(type)];
}

/// The edge nodes of a tetrahedron from Gmsh's order (edges 01, 12, 02, 03, 23, 13) into softkin's, and back.
[[nodiscard]] constexpr EdgeNodes reordered(EdgeNodes nodes) {
  std::swap(nodes[4], nodes[5]);
  return nodes;
}

/// Does a name contain characters that cannot stand between double quotes on one line?
[[nodiscard]] bool is_unquotable(std::string_view name);

inline constexpr std::int64_t kMaxIndex = std::numeric_limits<Index>::max();
inline constexpr std::int64_t kMaxInt = std::numeric_limits<std::int32_t>::max();
inline constexpr std::int64_t kMaxSize = std::numeric_limits<std::int64_t>::max();

/// A .msh file as sections of values: words, one record a line (ASCII), or binary in either byte order.
class Source {
 public:
  /// Reads $MeshFormat; other sections may not stand before it, except $Comments. Text between sections is passed over,
  /// as Gmsh does. content must outlive the source.
  Source(const std::string& file, std::string_view content);

  [[nodiscard]] bool version_4() const { return version_4_; }
  [[nodiscard]] bool binary() const { return binary_; }

  /// Name of the next section without '$', or "" at the end of the file.
  std::string open_section();
  void close_section();
  /// Passes over the section that is open, whatever it holds.
  void skip_section();

  /// Values of a record; in binary an int has 4 bytes, a size 8 and a real 8.
  std::int64_t int_value(const char* what, std::int64_t low, std::int64_t high);
  std::int64_t size_value(const char* what, std::int64_t low, std::int64_t high);
  /// An int that is a CellType, or the failure with the reason why that type is refused.
  CellType cell_type(const char* what);
  double real(const char* what);
  void skip_reals(int count, const char* what);
  void end_record();

  /// A number that stands as text on a line of its own, also in binary files.
  std::int64_t text_count(const char* what);
  /// A line of $PhysicalNames, text also in binary files.
  struct PhysicalName {
    int dimension;
    int tag;
    std::string name;
  };
  PhysicalName physical_name();

  /// Fails unless count items of at least these sizes can still follow.
  void require(std::int64_t count, std::size_t text_bytes, std::size_t binary_bytes, const char* what) const {
    scan_.require(static_cast<std::uint64_t>(count), binary_ ? binary_bytes : text_bytes, what);
  }
  [[noreturn]] void fail(const std::string& message) const { scan_.fail(message); }
  [[noreturn]] void fail_section(const std::string& message) const { throw InvalidInput(section_origin_, message); }
  [[noreturn]] void fail_file(const std::string& message) const { throw InvalidInput({scan_.here().file}, message); }

 private:
  void read_format();
  void read_byte_order();
  void must_continue_line(const char* what);
  [[noreturn]] void fail_range(const char* what, const std::string& value, std::int64_t low, std::int64_t high) const;

  Scanner scan_;
  std::string section_;
  Origin section_origin_;
  bool version_4_ = false;
  bool binary_ = false;
  bool swap_ = false;
  bool record_begins_ = true;
};

}  // namespace softkin::gmsh
