#pragma once

#include <cstring>
#include <filesystem>
#include <softkin/core/error.hpp>
#include <softkin/core/types.hpp>
#include <string>
#include <string_view>

namespace softkin {

/// Reads a file front to back, as text or binary. Every failure is an InvalidInput that names file and line (or byte).
/// Numbers are strict: the whole token, finite, in range.
class Scanner {
 public:
  explicit Scanner(const std::filesystem::path& path);
  /// Over content that is already in memory; `file` is for messages. content must outlive the scanner.
  Scanner(std::string file, std::string_view content);
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  [[nodiscard]] bool at_end();               // after blanks
  std::string_view token(const char* what);  // next word; fails at the end of the file: "file ends before WHAT"
  std::string_view line();                   // rest of this line without its end; moves to the next line
  void skip_line() { (void)line(); }
  /// Is there another token before the line ends?
  [[nodiscard]] bool line_has_more();
  /// Fails unless the line ends here (blanks aside), then moves to the next line.
  void end_line();

  double real(const char* what);  // NaN and infinities are refused
  std::int64_t integer(const char* what, std::int64_t low, std::int64_t high);
  void expect(std::string_view word);  // next token must be this

  /// Binary value at the cursor, in file order (swap: the other byte order).
  template <class T>
  T binary(const char* what, bool swap = false) {
    char bytes[sizeof(T)];
    const std::string_view raw = take(sizeof(T), what);
    std::memcpy(bytes, raw.data(), sizeof(T));
    if (swap)
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }
  std::string_view take(std::size_t bytes, const char* what);

  [[nodiscard]] std::size_t remaining() const { return content_.size() - cursor_; }
  /// Fails unless count items of at least bytes_each can still follow: guards allocations against lying headers.
  void require(std::uint64_t count, std::size_t bytes_each, const char* what) const;

  [[nodiscard]] Origin here() const;                // position of the last token or value
  void binary_positions(bool on) { binary_ = on; }  // errors name the byte, not the line
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skip_blanks();

  std::string owned_;
  std::string file_;
  std::string_view content_;
  std::size_t cursor_ = 0;
  std::size_t line_ = 1;        // of the cursor
  std::size_t token_line_ = 1;  // of the last token
  std::size_t token_byte_ = 0;
  bool binary_ = false;
};

/// The whole of text as a finite number, or false.
[[nodiscard]] bool parse_real(std::string_view text, double& value);

/// "; write a decimal point: 0.5" for "0,5"; "" for what is no number with a decimal comma.
[[nodiscard]] std::string decimal_comma_hint(std::string_view text);
[[nodiscard]] bool parse_integer(std::string_view text, std::int64_t& value);

}  // namespace softkin
