#pragma once

#include <softkin/io/mesh/gmsh_types.hpp>
#include <softkin/io/scanner.hpp>
#include <string>
#include <string_view>

namespace softkin::gmsh {

/// A .msh file as sections of values: words, one record a line (ASCII), or binary in either byte order.
class Source {
 public:
  /// Reads $MeshFormat; other sections may not stand before it, except $Comments. content must outlive the source.
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
