#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <softkin/io/mesh/vtu_bytes.hpp>
#include <utility>
#include <vector>

namespace softkin {

namespace {

// deflate cannot shrink data by more than this
constexpr std::uint64_t kMaxCompression = 1032;

bool is_xml_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// Per byte its value as a base64 digit; -1: it is none.
constexpr std::array<std::int8_t, 256> base64_digits = [] {
  std::array<std::int8_t, 256> values{};
  values.fill(-1);
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < digits.size(); ++i)
    values[static_cast<unsigned char>(digits[i])] = static_cast<std::int8_t>(i);
  return values;
}();

int base64_digit(char c) {
  return base64_digits[static_cast<unsigned char>(c)];
}

/// The bytes of one array; errors name it and its place.
class VtuBytes {
 public:
  VtuBytes(std::string_view content, VtuPlace place)
      : content_(content), place_(std::move(place)), cursor_(place_.begin) {}

  /// The next count bytes. A base64 text may end with padding, and begin anew, only between two reads.
  std::string read(std::uint64_t count, const std::string& what) {
    if (count > bound())
      fail("ends within " + what + ": " + std::to_string(count) + " bytes announced, at most " +
           std::to_string(bound()) + " follow");
    if (!place_.base64) {
      std::string raw(content_.substr(cursor_, count));
      cursor_ += count;
      return raw;
    }
    std::string bytes;
    bytes.reserve(count);
    if (pending_begin_ == pending_end_) padded_ = false;
    while (bytes.size() < count) {
      if (pending_begin_ == pending_end_ && !padded_) append_whole_quanta(bytes, count);
      if (bytes.size() == count) break;
      if (pending_begin_ == pending_end_) {
        if (padded_) fail("base64 padding within " + what);
        next_quantum(what);
      }
      const std::size_t part = std::min<std::size_t>(pending_end_ - pending_begin_, count - bytes.size());
      bytes.append(pending_ + pending_begin_, part);
      pending_begin_ += part;
    }
    return bytes;
  }

  /// Fails if anything but blanks is left.
  void finish() {
    skip_blanks();
    if (pending_begin_ != pending_end_ || cursor_ != place_.end) fail("more data follows than the header announces");
  }

  /// Most bytes that can still follow.
  [[nodiscard]] std::uint64_t bound() const {
    const std::uint64_t left = place_.end - cursor_;
    return place_.base64 ? left / 4 * 3 + (pending_end_ - pending_begin_) : left;
  }

  [[nodiscard]] std::size_t position() const { return cursor_; }
  [[noreturn]] void fail(const std::string& message) const { fail_at(cursor_, message); }

  [[noreturn]] void fail_at(std::size_t position, const std::string& message) const {
    const std::size_t line = place_.by_byte ? 0 : line_of(content_, position);
    throw InvalidInput({place_.file, line, position, place_.by_byte}, "array '" + place_.array + "': " + message);
  }

 private:
  char next_character(const std::string& what) {
    skip_blanks();
    if (cursor_ == place_.end) fail("the base64 text ends within " + what);
    return content_[cursor_];
  }

  /// Three bytes at a time while four digits follow one another, up to count bytes.
  void append_whole_quanta(std::string& bytes, std::uint64_t count) {
    for (; bytes.size() + 3 <= count && cursor_ + 4 <= place_.end; cursor_ += 4) {
      const char* text = content_.data() + cursor_;
      const int a = base64_digit(text[0]), b = base64_digit(text[1]), c = base64_digit(text[2]),
                d = base64_digit(text[3]);
      if ((a | b | c | d) < 0) return;
      const std::array<char, 3> three{static_cast<char>(a << 2 | b >> 4), static_cast<char>(b << 4 | c >> 2),
                                      static_cast<char>(c << 6 | d)};
      bytes.append(three.data(), three.size());
    }
  }

  void next_quantum(const std::string& what) {
    std::uint32_t bits = 0;
    int padding = 0;
    for (int i = 0; i < 4; ++i, ++cursor_) {
      const char c = next_character(what);
      const int digit = base64_digit(c);
      if (c == '=' && i >= 2)
        ++padding;
      else if (digit < 0 || padding > 0)
        fail("byte " + std::to_string(static_cast<unsigned char>(c)) + " is not base64 text here");
      bits = bits << 6 | static_cast<std::uint32_t>(std::max(digit, 0));
    }
    for (int i = 0; i < 3; ++i) pending_[i] = static_cast<char>(bits >> (16 - 8 * i) & 0xFF);
    pending_begin_ = 0;
    pending_end_ = 3 - padding;
    padded_ = padding > 0;
  }

  void skip_blanks() {
    while (cursor_ < place_.end && is_xml_blank(content_[cursor_])) ++cursor_;
  }

  std::string_view content_;
  VtuPlace place_;
  std::size_t cursor_;
  char pending_[3] = {0, 0, 0};  // decoded and not yet read
  std::size_t pending_begin_ = 0, pending_end_ = 0;
  bool padded_ = false;  // the last quantum ended a base64 text
};

std::uint64_t read_word(VtuBytes& bytes, const VtuEncoding& encoding) {
  std::string raw = bytes.read(encoding.long_header ? 8 : 4, "the header");
  const bool little = (std::endian::native == std::endian::little) != encoding.swap;
  if (little) std::reverse(raw.begin(), raw.end());
  std::uint64_t word = 0;
  for (const char c : raw) word = word << 8 | static_cast<unsigned char>(c);
  return word;
}

void check_size(const VtuBytes& bytes, std::uint64_t size, std::optional<std::uint64_t> expected) {
  if (expected && size != *expected)
    bytes.fail("holds " + std::to_string(size) + " bytes where the file's counts ask for " + std::to_string(*expected));
}

/// Header of compressed data: the sizes of the blocks, checked against the bytes that can follow.
struct Blocks {
  std::uint64_t size = 0, last_size = 0, total = 0;  // decompressed
  std::vector<std::uint64_t> compressed;
};

Blocks read_blocks(VtuBytes& bytes, const VtuEncoding& encoding, std::optional<std::uint64_t> expected,
                   std::uint64_t allowed) {
  const std::uint64_t count = read_word(bytes, encoding), size = read_word(bytes, encoding);
  const std::uint64_t partial = read_word(bytes, encoding);
  if (count > bytes.bound() / (encoding.long_header ? 8 : 4))
    bytes.fail("announces " + std::to_string(count) + " compressed blocks, more than the file can hold");
  const std::uint64_t most = bytes.bound() * kMaxCompression;
  const std::uint64_t whole = count > 0 && partial > 0 ? count - 1 : count;
  if (partial > most || (whole > 0 && size > most / whole))
    bytes.fail("announces blocks of " + std::to_string(size) + " bytes, more than the compressed data can hold");
  Blocks blocks{size, partial > 0 ? partial : size, whole * size + (count > 0 ? partial : 0), {}};
  check_size(bytes, blocks.total, expected);
  if (blocks.total > allowed)
    bytes.fail("unpacks to " + std::to_string(blocks.total) +
               " bytes, which makes more than a hundred times the file's size: no mesh does");
  std::uint64_t sum = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t compressed = read_word(bytes, encoding);
    if (compressed > bytes.bound() || (sum += compressed) > bytes.bound())
      bytes.fail("announces compressed blocks that are longer than the rest of the data");
    blocks.compressed.push_back(compressed);
  }
  if (blocks.total > sum * kMaxCompression)
    bytes.fail("announces " + std::to_string(blocks.total) + " bytes, more than " + std::to_string(sum) +
               " compressed bytes can hold");
  return blocks;
}

std::string inflate_blocks(VtuBytes& bytes, const Blocks& blocks) {
  std::string data(blocks.total, '\0');
  std::uint64_t done = 0;
  for (std::size_t i = 0; i < blocks.compressed.size(); ++i) {
    const std::string what = "compressed block " + std::to_string(i);
    const std::size_t begin = bytes.position();
    const std::string block = bytes.read(blocks.compressed[i], what);
    const std::uint64_t size = i + 1 < blocks.compressed.size() ? blocks.size : blocks.last_size;
    uLongf written = size;
    uLong used = block.size();
    const int status = uncompress2(reinterpret_cast<Bytef*>(data.data() + done), &written,
                                   reinterpret_cast<const Bytef*>(block.data()), &used);
    if (status != Z_OK || written != size || used != block.size()) bytes.fail_at(begin, what + " is damaged");
    done += size;
  }
  return data;
}

std::string read_data(VtuBytes& bytes, const VtuEncoding& encoding, std::optional<std::uint64_t> expected,
                      std::uint64_t most) {
  if (encoding.zlib_compressed) return inflate_blocks(bytes, read_blocks(bytes, encoding, expected, most));
  const std::uint64_t size = read_word(bytes, encoding);
  check_size(bytes, size, expected);
  return bytes.read(size, "its data");
}

}  // namespace

std::size_t line_of(std::string_view content, std::size_t position) {
  const std::string_view before = content.substr(0, position);
  return static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
}

std::string read_vtu_data(std::string_view content, const VtuPlace& place, const VtuEncoding& encoding,
                          std::optional<std::uint64_t> expected, std::uint64_t most) {
  VtuBytes bytes(content, place);
  std::string data = read_data(bytes, encoding, expected, most);
  if (!place.by_byte) bytes.finish();
  return data;
}

}  // namespace softkin
