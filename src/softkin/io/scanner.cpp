#include <charconv>
#include <cmath>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>

namespace softkin {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

std::string_view without_plus(std::string_view text) {
  return text.size() > 1 && text[0] == '+' && text[1] != '-' ? text.substr(1) : text;
}

}  // namespace

bool parse_real(std::string_view text, double& value) {
  text = without_plus(text);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
}

std::string decimal_comma_hint(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos) return "";
  std::string with_point(text);
  with_point[comma] = '.';
  double value = 0;
  return parse_real(with_point, value) ? "; write a decimal point: " + with_point : "";
}

bool parse_integer(std::string_view text, std::int64_t& value) {
  text = without_plus(text);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

Scanner::Scanner(const std::filesystem::path& path) : owned_(read_file(path)), file_(path.string()), content_(owned_) {}

Scanner::Scanner(std::string file, std::string_view content) : file_(std::move(file)), content_(content) {}

void Scanner::skip_blanks() {
  while (cursor_ < content_.size() && is_blank(content_[cursor_])) {
    if (content_[cursor_] == '\n') ++line_;
    ++cursor_;
  }
}

bool Scanner::at_end() {
  skip_blanks();
  return cursor_ == content_.size();
}

std::string_view Scanner::token(const char* what) {
  skip_blanks();
  token_line_ = line_;
  token_byte_ = cursor_;
  if (cursor_ == content_.size()) fail(std::string("file ends before ") + what);
  const std::size_t begin = cursor_;
  while (cursor_ < content_.size() && !is_blank(content_[cursor_])) ++cursor_;
  return content_.substr(begin, cursor_ - begin);
}

std::string_view Scanner::line() {
  token_line_ = line_;
  token_byte_ = cursor_;
  const std::size_t end = content_.find('\n', cursor_);
  std::string_view text = content_.substr(cursor_, end == std::string_view::npos ? end : end - cursor_);
  cursor_ = end == std::string_view::npos ? content_.size() : end + 1;
  if (end != std::string_view::npos) ++line_;
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  return text;
}

bool Scanner::line_has_more() {
  while (cursor_ < content_.size() && content_[cursor_] != '\n' && is_blank(content_[cursor_])) ++cursor_;
  return cursor_ < content_.size() && content_[cursor_] != '\n';
}

void Scanner::end_line() {
  if (line_has_more()) {
    const std::string extra(token("the end of the line"));
    fail("unexpected '" + extra.substr(0, 40) + "' at the end of the line");
  }
  skip_line();
}

double Scanner::real(const char* what) {
  const std::string_view text = token(what);
  double value = 0;
  if (!parse_real(text, value))
    fail(std::string(what) + " must be a finite number, not '" + std::string(text.substr(0, 40)) + "'");
  return value;
}

std::int64_t Scanner::integer(const char* what, std::int64_t low, std::int64_t high) {
  const std::string_view text = token(what);
  std::int64_t value = 0;
  if (!parse_integer(text, value))
    fail(std::string(what) + " must be an integer, not '" + std::string(text.substr(0, 40)) + "'");
  if (value < low || value > high)
    fail(std::string(what) + " is " + std::to_string(value) + ", outside " + std::to_string(low) + " to " +
         std::to_string(high));
  return value;
}

void Scanner::expect(std::string_view word) {
  const std::string text(word);
  const std::string_view found = token(text.c_str());
  if (found != word) fail("expected '" + text + "', found '" + std::string(found.substr(0, 40)) + "'");
}

std::string_view Scanner::take(std::size_t bytes, const char* what) {
  token_line_ = line_;
  token_byte_ = cursor_;
  if (bytes > remaining()) fail(std::string("file ends within ") + what);
  const std::string_view raw = content_.substr(cursor_, bytes);
  cursor_ += bytes;
  return raw;
}

void Scanner::require(std::uint64_t count, std::size_t bytes_each, const char* what) const {
  if (count > remaining() / bytes_each + 1)
    fail("announces " + std::to_string(count) + " " + what + ", more than the rest of the file can hold");
}

Origin Scanner::here() const {
  return {file_, binary_ ? 0 : token_line_, token_byte_, binary_};
}

void Scanner::fail(const std::string& message) const {
  throw InvalidInput(here(), message);
}

}  // namespace softkin
