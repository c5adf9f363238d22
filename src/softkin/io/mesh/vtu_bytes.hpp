#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <softkin/core/error.hpp>
#include <string>
#include <string_view>

namespace softkin {

/// How a .vtu file holds its binary arrays, as its VTKFile element says.
struct VtuEncoding {
  bool swap = false;             // not in this machine's byte order
  bool long_header = false;      // header_type UInt64, not UInt32
  bool zlib_compressed = false;  // in blocks
};

/// Bytes of one array of a .vtu file: content from begin to end, raw or base64. Nothing is allocated beyond what the
/// remaining content can hold. Errors name the array and its place: the byte (by_byte) or the line.
class VtuBytes {
 public:
  struct Place {
    std::string file, array;
    std::size_t begin = 0, end = 0;  // in content
    bool base64 = false, by_byte = false;
  };
  VtuBytes(std::string_view content, Place place);

  /// The next count bytes. A base64 text may end with padding, and begin anew, only between two reads.
  std::string read(std::uint64_t count, const std::string& what);
  /// Fails if anything but blanks is left.
  void finish();
  /// Most bytes that can still follow.
  [[nodiscard]] std::uint64_t bound() const;
  [[nodiscard]] std::size_t position() const { return cursor_; }
  [[noreturn]] void fail(const std::string& message) const { fail_at(cursor_, message); }
  [[noreturn]] void fail_at(std::size_t position, const std::string& message) const;

 private:
  char next_character(const std::string& what);
  void next_quantum(const std::string& what);
  void skip_blanks();

  std::string_view content_;
  Place place_;
  std::size_t cursor_;
  char pending_[3] = {0, 0, 0};  // decoded and not yet read
  std::size_t pending_begin_ = 0, pending_end_ = 0;
  bool padded_ = false;  // the last quantum ended a base64 text
};

/// The values of an array as bytes: header, then data, decompressed where the file is compressed.
///
/// expected  size that the file's counts ask for, where they do
[[nodiscard]] std::string read_vtu_data(VtuBytes& bytes, const VtuEncoding& encoding,
                                        std::optional<std::uint64_t> expected);

}  // namespace softkin
