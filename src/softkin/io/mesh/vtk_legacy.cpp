#include <algorithm>
#include <bit>
#include <iterator>
#include <limits>
#include <optional>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/mesh/vtk_grid.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr std::int64_t kMaxIndices = std::numeric_limits<Index>::max();
constexpr std::int64_t kMaxComponents = 1 << 20;

/// VTK writes blanks and other special characters of a name as %XX.
std::string decoded_name(std::string_view text) {
  const auto digit = [](char c) {
    const std::size_t value = std::string_view("0123456789ABCDEF").find(c >= 'a' && c <= 'f' ? c - 32 : c);
    return value == std::string_view::npos ? -1 : static_cast<int>(value);
  };
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool coded = text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0;
    name += coded ? static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2])) : text[i];
    if (coded) i += 2;
  }
  return name;
}

/// What the values of a legacy array are: numbers, single bits, or strings.
struct ArrayType {
  NumberType number = NumberType::uint8;
  bool bits = false, strings = false;
};

std::optional<ArrayType> array_type(const std::string& name) {
  static const std::pair<const char*, NumberType> types[] = {
      {"CHAR", NumberType::int8},
      {"SIGNED_CHAR", NumberType::int8},
      {"UNSIGNED_CHAR", NumberType::uint8},
      {"SHORT", NumberType::int16},
      {"UNSIGNED_SHORT", NumberType::uint16},
      {"INT", NumberType::int32},
      {"UNSIGNED_INT", NumberType::uint32},
      {"LONG", NumberType::int64},
      {"UNSIGNED_LONG", NumberType::uint64},
      {"VTKIDTYPE", NumberType::int32},  // VTK writes its ids as int
      {"VTKTYPEINT64", NumberType::int64},
      {"VTKTYPEUINT64", NumberType::uint64},
      {"FLOAT", NumberType::float32},
      {"DOUBLE", NumberType::float64}};
  if (name == "BIT") return ArrayType{NumberType::uint8, true, false};
  if (name == "STRING" || name == "UTF8_STRING") return ArrayType{NumberType::uint8, false, true};
  for (const auto& [known, number] : types)
    if (name == known) return ArrayType{number, false, false};
  return std::nullopt;
}

class LegacyReader {
 public:
  explicit LegacyReader(const std::filesystem::path& path) : scanner_(path), file_(path.string()) {}

  Mesh read() {
    read_header();
    while (!scanner_.at_end()) read_section(upper_case(scanner_.token("a section")));
    if (grid_.points.rows() == 0) scanner_.fail("the file has no POINTS");
    if (!has_cells_) scanner_.fail("the file has no CELLS");
    if (grid_.types.size() != cell_count()) scanner_.fail("the file has no CELL_TYPES");
    return mesh_of(grid_, {file_});
  }

 private:
  void read_header() {
    const std::string_view first = scanner_.line(), prefix = "# vtk DataFile Version ";
    if (!first.starts_with(prefix))
      scanner_.fail("not a legacy VTK file: the first line must be '# vtk DataFile Version X.Y'");
    std::string_view number = first.substr(prefix.size());
    while (!number.empty() && number.back() == ' ') number.remove_suffix(1);
    double version = 0;
    if (!parse_real(number, version) || version < 2 || version > 5.1)
      scanner_.fail("VTK file version '" + std::string(number.substr(0, 20)) + "' is not one of 2.0 to 5.1");
    offset_cells_ = version >= 5;
    scanner_.skip_line();  // title
    const std::string form(scanner_.token("ASCII or BINARY"));
    binary_ = upper_case(form) == "BINARY";
    if (!binary_ && upper_case(form) != "ASCII")
      scanner_.fail("expected ASCII or BINARY, found '" + form.substr(0, 40) + "'");
    scanner_.end_line();
    if (upper_case(scanner_.token("DATASET")) != "DATASET") scanner_.fail("expected DATASET after ASCII or BINARY");
    const std::string kind(scanner_.token("the kind of dataset"));
    if (upper_case(kind) != "UNSTRUCTURED_GRID")
      scanner_.fail("the dataset is " + kind.substr(0, 40) + "; a volume mesh must be an UNSTRUCTURED_GRID");
    scanner_.end_line();
  }

  void read_section(const std::string& keyword) {
    if (keyword == "POINTS") return read_points();
    if (keyword == "CELLS") return read_cells();
    if (keyword == "CELL_TYPES") return read_cell_types();
    if (keyword == "POINT_DATA") return begin_attributes(grid_.points.rows(), false);
    if (keyword == "CELL_DATA") return begin_attributes(cell_count(), true);
    if (keyword == "METADATA") return skip_metadata();
    if (keyword == "FIELD") return read_field();
    if (in_attributes_ && keyword == "LOOKUP_TABLE") return read_lookup_table();
    if (in_attributes_ && keyword == "SCALARS") return read_scalars();
    if (!in_attributes_ || !read_attribute(keyword)) scanner_.fail("unknown section '" + keyword.substr(0, 40) + "'");
  }

  bool read_attribute(const std::string& keyword) {
    static const std::pair<const char*, int> fixed[] = {{"VECTORS", 3},   {"NORMALS", 3},    {"TENSORS", 9},
                                                        {"TENSORS6", 6},  {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1},
                                                        {"EDGE_FLAGS", 1}};
    const auto* known = std::find_if(std::begin(fixed), std::end(fixed), [&](auto& f) { return keyword == f.first; });
    const bool texture = keyword == "TEXTURE_COORDINATES", colors = keyword == "COLOR_SCALARS";
    if (known == std::end(fixed) && !texture && !colors) return false;
    const std::string name = decoded_name(scanner_.token("the name of an array"));
    const std::int64_t components =
        texture || colors ? scanner_.integer("number of components", 1, kMaxComponents) : known->second;
    const ArrayType type = colors ? ArrayType{} : type_token();
    scanner_.end_line();
    read_array(name, type, components, tuples_, false);
    return true;
  }

  void read_points() {
    if (grid_.points.rows() > 0) scanner_.fail("POINTS stands twice in the file");
    const std::int64_t count = scanner_.integer("number of points", 1, kMaxIndices);
    const ArrayType type = type_token();
    if (type.bits || type.strings) scanner_.fail("points must be numbers");
    begin_data();
    components_ = 3;
    NumberReader reader = numbers();
    reader.require(3 * static_cast<std::uint64_t>(count), type.number, "coordinates");
    grid_.points.resize(count, 3);
    for (std::int64_t i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis) grid_.points(i, axis) = reader.real(type.number, "coordinate");
  }

  void read_cells() {
    if (has_cells_) scanner_.fail("CELLS stands twice in the file");
    if (grid_.points.rows() == 0) scanner_.fail("CELLS stands before POINTS");
    has_cells_ = true;
    const std::int64_t count = scanner_.integer("number of cells", 1, kMaxIndices);
    const std::int64_t size = scanner_.integer("size of CELLS", 1, std::numeric_limits<std::int64_t>::max());
    scanner_.end_line();
    if (offset_cells_)
      read_offset_cells(count, size);
    else
      read_counted_cells(count, size);
  }

  void read_counted_cells(std::int64_t cells, std::int64_t size) {
    scanner_.binary_positions(binary_);
    numbers().require(static_cast<std::uint64_t>(size), NumberType::int32, "values of CELLS");
    numbers().require(static_cast<std::uint64_t>(cells), NumberType::int32, "cells");
    std::int64_t left = size;
    for (std::int64_t cell = 0; cell < cells; ++cell) {
      const std::int64_t vertices = numbers().integer(NumberType::int32, "number of vertices of a cell");
      left -= 1 + vertices;
      if (vertices < 1 || left < 0)
        scanner_.fail("cell " + std::to_string(cell) + " has " + std::to_string(vertices) +
                      " vertices, which does not fit the size of CELLS, " + std::to_string(size));
      for (std::int64_t i = 0; i < vertices; ++i) grid_.connectivity.push_back(vertex(NumberType::int32));
      grid_.starts.push_back(grid_.connectivity.size());
    }
    if (left != 0)
      scanner_.fail("the cells hold " + std::to_string(size - left) + " values, but CELLS announces " +
                    std::to_string(size));
  }

  void read_offset_cells(std::int64_t offsets, std::int64_t size) {
    if (upper_case(scanner_.token("OFFSETS")) != "OFFSETS") scanner_.fail("expected OFFSETS after CELLS of version 5");
    const NumberType offset_type = integer_type_token("OFFSETS");
    begin_data();
    numbers().require(static_cast<std::uint64_t>(offsets), offset_type, "offsets");
    for (std::int64_t i = 0; i < offsets; ++i) {
      const std::int64_t offset = numbers().integer(offset_type, "offset");
      const std::int64_t last = static_cast<std::int64_t>(grid_.starts.back());
      if (i == 0 ? offset != 0 : offset <= last)
        scanner_.fail(i == 0 ? "OFFSETS must begin with 0"
                             : "OFFSETS must ascend: " + std::to_string(offset) + " after " + std::to_string(last));
      if (i > 0) grid_.starts.push_back(offset);
    }
    if (std::cmp_not_equal(grid_.starts.back(), size))
      scanner_.fail("OFFSETS end with " + std::to_string(grid_.starts.back()) + ", but CONNECTIVITY has " +
                    std::to_string(size) + " values");
    if (upper_case(scanner_.token("CONNECTIVITY")) != "CONNECTIVITY")
      scanner_.fail("expected CONNECTIVITY after OFFSETS");
    const NumberType type = integer_type_token("CONNECTIVITY");
    begin_data();
    numbers().require(static_cast<std::uint64_t>(size), type, "vertices of cells");
    grid_.connectivity.reserve(size);
    for (std::int64_t i = 0; i < size; ++i) grid_.connectivity.push_back(vertex(type));
  }

  void read_cell_types() {
    if (!has_cells_) scanner_.fail("CELL_TYPES stands before CELLS");
    if (!grid_.types.empty()) scanner_.fail("CELL_TYPES stands twice in the file");
    const std::int64_t count = scanner_.integer("number of cell types", 1, kMaxIndices);
    if (std::cmp_not_equal(count, cell_count()))
      scanner_.fail("there are " + std::to_string(count) + " cell types for " + std::to_string(cell_count()) +
                    " cells");
    begin_data();
    for (std::size_t cell = 0; cell < cell_count(); ++cell) {
      const std::int64_t type = numbers().integer(NumberType::int32, "type of a cell");
      const std::string refusal = cell_refusal(cell, type, grid_.starts[cell + 1] - grid_.starts[cell]);
      if (!refusal.empty()) scanner_.fail(refusal);
      grid_.types.push_back(static_cast<std::uint8_t>(type));
    }
  }

  void read_scalars() {
    const std::string name = decoded_name(scanner_.token("the name of an array"));
    const ArrayType type = type_token();
    const std::int64_t components =
        scanner_.line_has_more() ? scanner_.integer("number of components", 1, kMaxComponents) : 1;
    scanner_.end_line();
    if (upper_case(scanner_.token("LOOKUP_TABLE")) != "LOOKUP_TABLE")
      scanner_.fail("expected LOOKUP_TABLE after SCALARS");
    scanner_.token("the name of a lookup table");
    scanner_.end_line();
    read_array(name, type, components, tuples_, of_cells_);
  }

  void read_field() {
    scanner_.token("the name of a field");
    const std::int64_t arrays = scanner_.integer("number of arrays", 0, kMaxIndices);
    scanner_.end_line();
    for (std::int64_t i = 0; i < arrays; ++i) {
      std::string name = decoded_name(scanner_.token("the name of an array"));
      while (name == "METADATA") {
        skip_metadata();
        name = decoded_name(scanner_.token("the name of an array"));
      }
      if (name == "NULL_ARRAY") continue;
      const std::int64_t components = scanner_.integer("number of components", 0, kMaxComponents);
      const std::int64_t tuples = scanner_.integer("number of tuples", 0, kMaxIndices);
      if (in_attributes_ && tuples != tuples_)
        scanner_.fail("array '" + name + "' has " + std::to_string(tuples) + " tuples instead of " +
                      std::to_string(tuples_));
      const ArrayType type = type_token();
      scanner_.end_line();
      read_array(name, type, components, tuples, in_attributes_ && of_cells_);
    }
  }

  void read_lookup_table() {
    scanner_.token("the name of a lookup table");
    const std::int64_t size = scanner_.integer("size of a lookup table", 0, kMaxIndices);
    scanner_.end_line();
    read_array("", ArrayType{}, 4, size, false);
  }

  void begin_attributes(std::size_t tuples, bool of_cells) {
    if (of_cells && !has_cells_) scanner_.fail("CELL_DATA stands before CELLS");
    tuples_ = scanner_.integer(of_cells ? "number of CELL_DATA" : "number of POINT_DATA", 0, kMaxIndices);
    if (std::cmp_not_equal(tuples_, tuples))
      scanner_.fail((of_cells ? "CELL_DATA is for " : "POINT_DATA is for ") + std::to_string(tuples_) +
                    ", but the file has " + std::to_string(tuples) + (of_cells ? " cells" : " points"));
    scanner_.end_line();
    in_attributes_ = true;
    of_cells_ = of_cells;
  }

  void read_array(const std::string& name, const ArrayType& type, std::int64_t components, std::int64_t tuples,
                  bool is_label) {
    scanner_.binary_positions(binary_);
    components_ = components;
    if (is_label && components == 1 && !type.strings && is_integer(type.number))
      read_labels(name, type);
    else
      skip_values(type, static_cast<std::uint64_t>(components) * static_cast<std::uint64_t>(tuples));
  }

  void read_labels(const std::string& name, const ArrayType& type) {
    CellLabels labels{name, {}, std::nullopt, scanner_.here()};
    const std::size_t count = cell_count();
    if (type.bits && binary_) {
      const std::string_view bytes = scanner_.take((count + 7) / 8, "an array of bits");
      for (std::size_t i = 0; i < count; ++i)
        labels.values.push_back(static_cast<unsigned char>(bytes[i / 8]) >> (7 - i % 8) & 1);
    } else {
      numbers().require(count, type.number, "values");
      for (std::size_t i = 0; i < count; ++i)
        labels.values.push_back(numbers().integer(type.number, "value of a cell"));
    }
    grid_.labels.push_back(std::move(labels));
  }

  void skip_values(const ArrayType& type, std::uint64_t count) {
    if (type.strings) {
      for (std::uint64_t i = 0; i < count; ++i) skip_string();
    } else if (binary_) {
      scanner_.take(type.bits ? (count + 7) / 8 : count * size_of(type.number), "an array");
    } else {
      for (std::uint64_t i = 0; i < count; ++i) scanner_.token("a value of an array");
    }
  }

  void skip_string() {
    if (scanner_.remaining() == 0) scanner_.fail("file ends before a string");
    if (!binary_) return scanner_.skip_line();
    // the first two bits give the number of bytes of the length: 11 one, 10 two, 01 four, 00 eight
    const auto first = scanner_.binary<unsigned char>("a string");
    std::uint64_t length = first & 0x3F;
    const int more = first >> 6 == 3 ? 0 : first >> 6 == 2 ? 1 : first >> 6 == 1 ? 3 : 7;
    for (int i = 0; i < more; ++i) length = length << 8 | scanner_.binary<unsigned char>("a string");
    scanner_.take(length, "a string");
  }

  void skip_metadata() {
    scanner_.skip_line();
    while (scanner_.remaining() > 0) {
      const std::string_view text = scanner_.line();
      if (text.find_first_not_of(" \t") == std::string_view::npos) return;
      if (upper_case(text) != "COMPONENT_NAMES") continue;
      for (std::int64_t i = 0; i < components_ && scanner_.remaining() > 0; ++i) scanner_.skip_line();  // may be blank
    }
  }

  [[nodiscard]] std::size_t cell_count() const { return grid_.starts.size() - 1; }
  [[nodiscard]] NumberReader numbers() { return {scanner_, binary_, std::endian::native == std::endian::little}; }

  ArrayType type_token() {
    const std::string name(scanner_.token("the type of an array"));
    const std::optional<ArrayType> type = array_type(upper_case(name));
    if (!type) scanner_.fail("arrays of type '" + name.substr(0, 40) + "' cannot be read");
    return *type;
  }

  NumberType integer_type_token(const char* what) {
    const ArrayType type = type_token();
    if (type.bits || type.strings || !is_integer(type.number))
      scanner_.fail(std::string(what) + " must be of an integer type");
    return type.number;
  }

  void begin_data() {
    scanner_.end_line();
    scanner_.binary_positions(binary_);
  }

  Index vertex(NumberType type) {
    const std::int64_t index = numbers().integer(type, "vertex of a cell");
    if (index < 0 || index >= grid_.points.rows())
      scanner_.fail("vertex of a cell is " + std::to_string(index) + ", outside 0 to " +
                    std::to_string(grid_.points.rows() - 1));
    return index;
  }

  Scanner scanner_;
  std::string file_;
  bool binary_ = false, offset_cells_ = false, has_cells_ = false;
  bool in_attributes_ = false, of_cells_ = false;
  std::int64_t tuples_ = 0;      // of the attributes that follow
  std::int64_t components_ = 0;  // of the last array, whose metadata may follow
  CellGrid grid_;
};

}  // namespace

Mesh read_vtk(const std::filesystem::path& path) {
  return LegacyReader(path).read();
}

}  // namespace softkin
