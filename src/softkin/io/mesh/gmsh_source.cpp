#include <cmath>
#include <softkin/io/mesh/gmsh_source.hpp>

namespace softkin::gmsh {

namespace {

// Damaged binary files must not put control characters into a message.
std::string printable(std::string_view text) {
  std::string result(text.substr(0, 40));
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  return result;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace

Source::Source(const std::string& file, std::string_view content) : scan_(file, content) {
  if (scan_.at_end()) fail("file is empty: expected $MeshFormat");
  while (open_section() == "Comments") skip_section();
  if (section_.empty()) fail("file ends before $MeshFormat");
  if (section_ != "MeshFormat") {
    const std::string why = section_ == "NOD" ? " (MSH version 1 is not supported: save as 4.1 or 2.2)" : "";
    fail("not a Gmsh mesh: expected $MeshFormat, found '" + printable("$" + section_) + "'" + why);
  }
  read_format();
}

void Source::read_format() {
  const std::string_view word = scan_.token("the version of the format");
  double version = 0;
  if (!parse_real(word, version)) fail("version of the format must be a number, not '" + printable(word) + "'");
  if (version != 2.2 && version != 4.1)
    fail("MSH version " + printable(word) + " is not supported: save as 4.1 or 2.2");
  version_4_ = version == 4.1;
  record_begins_ = false;
  binary_ = int_value("file type", 0, 1) == 1;
  const std::int64_t bytes = scan_.integer("data size", 0, kMaxInt);
  if (bytes != 8) fail("data size " + std::to_string(bytes) + " is not supported: only 8 bytes");
  scan_.end_line();
  if (binary_) read_byte_order();
  close_section();
}

void Source::read_byte_order() {
  scan_.binary_positions(true);
  const auto mark = scan_.binary<std::uint32_t>("the mark of the byte order");
  if (mark != 1u && mark != 0x01000000u) fail("the mark of the byte order is not the integer 1");
  swap_ = mark != 1u;
}

std::string Source::open_section() {
  if (scan_.at_end()) return section_ = "";
  const std::string_view word = scan_.token("a section");
  section_origin_ = scan_.here();
  if (word.size() < 2 || word[0] != '$') fail("expected a section such as $Nodes, found '" + printable(word) + "'");
  section_ = word.substr(1);
  if (section_.starts_with("End")) fail("'" + printable(word) + "' closes no section");
  scan_.end_line();
  record_begins_ = true;
  return section_;
}

void Source::close_section() {
  const std::string end = "$End" + section_;
  const std::string_view word = scan_.token(end.c_str());
  if (word != end) fail("expected '" + end + "', found '" + printable(word) + "'");
  scan_.end_line();
}

void Source::skip_section() {
  const std::string end = "$End" + section_;
  while (scan_.remaining() > 0) {
    const std::string_view line = trimmed(scan_.line());
    if (line == end || (binary_ && line.ends_with(end))) return;
  }
  fail_section("section '" + printable("$" + section_) + "' has no '" + printable(end) + "'");
}

void Source::must_continue_line(const char* what) {
  if (!record_begins_ && scan_.remaining() > 0 && !scan_.line_has_more()) fail(std::string("line ends before ") + what);
  record_begins_ = false;
}

void Source::fail_range(const char* what, const std::string& value, std::int64_t low, std::int64_t high) const {
  fail(std::string(what) + " is " + value + ", outside " + std::to_string(low) + " to " + std::to_string(high));
}

std::int64_t Source::int_value(const char* what, std::int64_t low, std::int64_t high) {
  if (!binary_) {
    must_continue_line(what);
    return scan_.integer(what, low, high);
  }
  const std::int64_t value = scan_.binary<std::int32_t>(what, swap_);
  if (value < low || value > high) fail_range(what, std::to_string(value), low, high);
  return value;
}

std::int64_t Source::size_value(const char* what, std::int64_t low, std::int64_t high) {
  if (!binary_) {
    must_continue_line(what);
    return scan_.integer(what, low, high);
  }
  const auto value = scan_.binary<std::uint64_t>(what, swap_);
  if (value < static_cast<std::uint64_t>(low) || value > static_cast<std::uint64_t>(high))
    fail_range(what, std::to_string(value), low, high);
  return static_cast<std::int64_t>(value);
}

double Source::real(const char* what) {
  if (!binary_) {
    must_continue_line(what);
    return scan_.real(what);
  }
  const auto value = scan_.binary<double>(what, swap_);
  if (!std::isfinite(value)) fail(std::string(what) + " must be a finite number");
  return value;
}

void Source::skip_reals(int count, const char* what) {
  for (int i = 0; i < count; ++i) {
    if (binary_) {
      (void)scan_.take(sizeof(double), what);
    } else {
      must_continue_line(what);
      (void)scan_.token(what);
    }
  }
}

void Source::end_record() {
  if (!binary_) scan_.end_line();
  record_begins_ = true;
}

std::int64_t Source::text_count(const char* what) {
  const std::int64_t count = scan_.integer(what, 0, kMaxIndex);
  scan_.end_line();
  return count;
}

Source::PhysicalName Source::physical_name() {
  const auto dimension = scan_.integer("dimension of a physical group", 0, 3);
  const auto tag = scan_.integer("tag of a physical group", 1, kMaxInt);
  const std::string_view quoted = trimmed(scan_.line());
  if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"')
    fail("name of a physical group must stand in double quotes, not '" + printable(quoted) + "'");
  const std::string_view name = quoted.substr(1, quoted.size() - 2);
  if (name.empty()) fail("name of a physical group is empty");
  if (is_unquotable(name)) fail("name of a physical group holds '\"' or a control character");
  return {static_cast<int>(dimension), static_cast<int>(tag), std::string(name)};
}

}  // namespace softkin::gmsh
