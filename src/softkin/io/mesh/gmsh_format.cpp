#include <algorithm>
#include <cmath>
#include <iterator>
#include <softkin/io/mesh/gmsh_format.hpp>

namespace softkin::gmsh {

namespace {

constexpr std::int64_t kLastType = 140;
constexpr std::pair<std::int64_t, const char*> kUnreadTypes[] = {
    {5, "hexahedra"},
    {7, "pyramids"},
    {10, "second-order quads"},
    {12, "second-order hexahedra"},
    {13, "second-order prisms"},
    {14, "second-order pyramids"},
    {16, "second-order quads"},
    {17, "second-order hexahedra"},
    {18, "second-order prisms"},
    {19, "second-order pyramids"},
    {21, "third-order triangles"},
    {26, "third-order lines"},
    {29, "third-order tetrahedra"},
};

/// Why an element type cannot be read.
std::string refusal_of_type(std::int64_t type) {
  const std::string number = std::to_string(type);
  if (type < 1 || type > kLastType) return "unknown element type " + number;
  const auto* known = std::find_if(std::begin(kUnreadTypes), std::end(kUnreadTypes),
                                   [&](const auto& unread) { return unread.first == type; });
  if (known == std::end(kUnreadTypes))
    return "elements of type " + number + " are not supported: mesh with order 1 or 2";
  const std::string name = known->second;
  if (type == 5 || type == 7) return name + " (type " + number + ") are not supported: mesh with tetrahedra or prisms";
  return name + " (type " + number + ") are not supported: mesh with order 1" +
         (name.starts_with("second") ? "" : " or 2");
}

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

bool is_unquotable(std::string_view name) {
  return std::any_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < ' ' || byte == 127 || c == '"';
  });
}

Source::Source(const std::string& file, std::string_view content) : scan_(file, content) {
  if (scan_.at_end()) fail("file is empty: expected $MeshFormat");
  while (open_section() == "Comments") skip_section();
  if (section_.empty()) fail_file("not a Gmsh mesh: it has no section $MeshFormat");
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
  while (!scan_.at_end()) {
    const std::string_view line = trimmed(scan_.line());
    if (!line.starts_with('$'))
      continue;  // what stands between sections is no business of a mesh: Gmsh's window
                 // appends lines such as Show "*";
    section_origin_ = scan_.here();
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    if (word.size() < 2) fail("expected a section such as $Nodes, found '" + printable(word) + "'");
    section_ = word.substr(1);
    if (section_.starts_with("End")) fail("'" + printable(word) + "' closes no section");
    if (word.size() < line.size())
      fail("unexpected '" + printable(trimmed(line.substr(word.size()))) + "' at the end of the line");
    record_begins_ = true;
    return section_;
  }
  return section_ = "";
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

CellType Source::cell_type(const char* what) {
  const std::int64_t type = int_value(what, -kMaxInt, kMaxInt);
  if (type < 1 || type >= std::ssize(kShapes) || kShapes[type].nodes == 0) fail(refusal_of_type(type));
  return static_cast<CellType>(type);
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
