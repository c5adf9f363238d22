#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <softkin/core/error.hpp>
#include <string>
#include <string_view>

namespace softkin {

/// The encoding of binary arrays in a .vtu file, by its VTKFile element.
struct VtuEncoding {
  bool swap = false;             // not in this machine's byte order
  bool long_header = false;      // header_type UInt64, not UInt32
  bool zlib_compressed = false;  // in blocks
};

/// Of a position in the content, from 1.
[[nodiscard]] std::size_t line_of(std::string_view content, std::size_t position);

/// Where one array of a .vtu file is: content from begin to end, raw or base64. by_byte: errors name the byte, and
/// other arrays may follow; else they name the line, and nothing but blanks may follow.
struct VtuPlace {
  std::string file, array;
  std::size_t begin = 0, end = 0;
  bool base64 = false, by_byte = false;
};

/// The values of an array as bytes: header, then data, decompressed where the file is compressed. Nothing is allocated
/// beyond what the remaining content can hold.
///
/// expected  size that the file's counts ask for, where they do
/// most      bytes that it may unpack to
[[nodiscard]] std::string read_vtu_data(std::string_view content, const VtuPlace& place, const VtuEncoding& encoding,
                                        std::optional<std::uint64_t> expected, std::uint64_t most);

}  // namespace softkin
