#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/mesh/vtk_grid.hpp>
#include <softkin/io/mesh/vtu_bytes.hpp>
#include <type_traits>
#include <utility>

namespace softkin {

namespace {

constexpr std::int64_t kMost = std::numeric_limits<Index>::max();
constexpr std::string_view kBlanks = " \t\r\n";
/// Coordinates pack to a half, connectivity to a tenth: who unpacks to more than this many times the file wants to fill
/// the memory. Nothing small does.
constexpr std::uint64_t kMostUnpacked = 100, kSmall = 1 << 26;

/// Where <AppendedData> begins, outside comments, or npos.
std::size_t find_appended_tag(std::string_view content) {
  const std::string_view tag = "<AppendedData";
  std::size_t from = 0;
  while (true) {
    const std::size_t found = content.find(tag, from);
    const std::size_t comment = content.find("<!--", from);
    if (found == std::string_view::npos || found < comment) return found;
    from = content.find("-->", comment);
    if (from == std::string_view::npos) return from;
  }
}

/// A scanner that stands at position `begin` of the content, with the right line, and ends at `end`.
class TextScanner : public Scanner {
 public:
  TextScanner(const std::string& file, std::string_view content, std::size_t begin, std::size_t end)
      : Scanner(file, content.substr(0, end)) {
    for (std::size_t lines = line_of(content, begin); lines > 1; --lines) skip_line();
    take(remaining() - (end - begin), "the text of an array");
  }
};

/// A .vtu file as XML elements and the values of its arrays.
class VtuDocument {
 public:
  explicit VtuDocument(const std::filesystem::path& path) : file_(path.string()), content_(read_file(path)) {
    parse(head_of_file());
    const pugi::xml_node root = xml_.document_element();
    if (std::string(root.name()) != "VTKFile") fail(root, "not a VTK file: the first element must be VTKFile");
    const std::string kind = text(root, "type");
    if (kind != "UnstructuredGrid") fail(root, "the file is of type " + kind + "; a mesh must be an UnstructuredGrid");
    read_encoding(root);
    grid_ = child(root, "UnstructuredGrid");
  }

  [[nodiscard]] pugi::xml_node grid() const { return grid_; }  // the UnstructuredGrid element

  [[nodiscard]] pugi::xml_node child(pugi::xml_node parent, const char* name) const {
    const pugi::xml_node found = parent.child(name);
    if (!found) fail(parent, std::string(parent.name()) + " has no " + name);
    return found;
  }

  /// The DataArray of this name below parent.
  [[nodiscard]] pugi::xml_node array(pugi::xml_node parent, const std::string& name) const {
    for (const pugi::xml_node node : parent.children("DataArray"))
      if (node.attribute("Name").as_string() == name) return node;
    fail(parent, std::string(parent.name()) + " has no array '" + name + "'");
  }

  [[nodiscard]] std::string text(pugi::xml_node node, const char* attribute) const {
    const pugi::xml_attribute found = node.attribute(attribute);
    if (!found) fail(node, std::string(node.name()) + " has no attribute " + attribute);
    return found.as_string();
  }

  [[nodiscard]] std::int64_t integer(pugi::xml_node node, const char* attribute, std::int64_t low,
                                     std::int64_t high) const {
    const std::string value = text(node, attribute);
    std::int64_t number = 0;
    if (!parse_integer(value, number) || number < low || number > high)
      fail(node, std::string(attribute) + " must be an integer from " + std::to_string(low) + " to " +
                     std::to_string(high) + ", not '" + value.substr(0, 40) + "'");
    return number;
  }

  /// The attribute NumberOfComponents; 1 where it is not given.
  [[nodiscard]] std::int64_t components(pugi::xml_node array) const {
    return array.attribute("NumberOfComponents") ? integer(array, "NumberOfComponents", 1, 1 << 20) : 1;
  }

  /// The type of an array's numbers, or none where it holds strings.
  [[nodiscard]] std::optional<NumberType> type(pugi::xml_node array) const {
    static const std::pair<const char*, NumberType> types[] = {
        {"Int8", NumberType::int8},       {"UInt8", NumberType::uint8},   {"Int16", NumberType::int16},
        {"UInt16", NumberType::uint16},   {"Int32", NumberType::int32},   {"UInt32", NumberType::uint32},
        {"Int64", NumberType::int64},     {"UInt64", NumberType::uint64}, {"Float32", NumberType::float32},
        {"Float64", NumberType::float64},
    };
    const std::string name = text(array, "type");
    if (name == "String") return std::nullopt;
    for (const auto& [known, number] : types)
      if (name == known) return number;
    fail(array, "arrays of type '" + name.substr(0, 40) + "' cannot be read");
  }

  [[nodiscard]] std::vector<double> reals(pugi::xml_node array, std::uint64_t count) const {
    const std::optional<NumberType> number = type(array);
    if (!number) fail(array, "array '" + text(array, "Name") + "' must hold numbers");
    return values<double>(array, *number, count);
  }

  [[nodiscard]] std::vector<std::int64_t> integers(pugi::xml_node array, std::uint64_t count) const {
    const std::optional<NumberType> number = type(array);
    if (!number || !is_integer(*number)) fail(array, "array '" + text(array, "Name") + "' must be of an integer type");
    return values<std::int64_t>(array, *number, count);
  }

  [[nodiscard]] std::vector<std::string> strings(pugi::xml_node array) const {
    // in ASCII form every byte is a number, and VTK writes those above 127 as negative ones
    const NumberType number = is_ascii(array) ? NumberType::int16 : NumberType::uint8;
    std::vector<std::string> result;
    std::string current;
    bool open = false;
    for (const std::int64_t code : values<std::int64_t>(array, number, std::nullopt)) {
      if (code < -128 || code > 255)
        fail(array, "array '" + text(array, "Name") + "': " + std::to_string(code) + " is no byte");
      open = code != 0;
      if (open) {
        current += static_cast<char>(code);
      } else {
        result.push_back(std::exchange(current, ""));
      }
    }
    if (open) fail(array, "array '" + text(array, "Name") + "': the last string does not end with 0");
    if (array.attribute("NumberOfTuples") &&
        std::cmp_not_equal(integer(array, "NumberOfTuples", 0, std::numeric_limits<Index>::max()), result.size()))
      fail(array, "array '" + text(array, "Name") + "' holds " + std::to_string(result.size()) +
                      " strings, not NumberOfTuples");
    return result;
  }

  [[nodiscard]] Origin origin(pugi::xml_node node) const {
    const std::ptrdiff_t offset = node.offset_debug();
    return {file_, offset < 0 ? 0 : line_of(content_, static_cast<std::size_t>(offset))};
  }

  [[noreturn]] void fail(pugi::xml_node node, const std::string& message) const {
    throw InvalidInput(origin(node), message);
  }

 private:
  struct Range {
    std::size_t begin = 0, end = 0;  // in content_
  };

  /// The XML of the file; appended data, which need not be XML, are cut out.
  std::string head_of_file() {
    if (content_.find_first_not_of(kBlanks) == std::string::npos) throw InvalidInput({file_, 1}, "the file is empty");
    const std::size_t tag = find_appended_tag(content_);
    if (tag == std::string::npos) return content_;
    const std::size_t close = content_.find('>', tag);
    if (close == std::string::npos) throw InvalidInput({file_, line_of(content_, tag)}, "AppendedData is not closed");
    if (content_[close - 1] == '/') return content_;
    find_appended_data(close + 1);
    return content_.substr(0, close + 1) + "</AppendedData></VTKFile>";
  }

  void find_appended_data(std::size_t tag) {
    const auto refuse = [&](const std::string& message) {
      throw InvalidInput({file_, line_of(content_, tag)}, message);
    };
    const std::string_view content = content_, closing = "</AppendedData>";
    const std::size_t underscore = content.find_first_not_of(kBlanks, tag);
    if (underscore == std::string::npos || content[underscore] != '_') refuse("AppendedData must begin with '_'");
    const std::size_t end = content.rfind(closing);
    if (end == std::string::npos || end < underscore) refuse("AppendedData does not end: the file is cut off");
    std::string_view rest = content.substr(end + closing.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    if (!rest.starts_with("</VTKFile>") || rest.find_first_not_of(kBlanks, 10) != std::string_view::npos)
      throw InvalidInput({file_, 0, end, true}, "expected </VTKFile> and nothing else after </AppendedData>");
    appended_ = Range{underscore + 1, end};
  }

  void parse(const std::string& head) {
    const pugi::xml_parse_result result =
        xml_.load_buffer(head.data(), head.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result)
      throw InvalidInput(
          {file_, line_of(content_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)))},
          std::string("not well-formed XML: ") + result.description());
  }

  void read_encoding(pugi::xml_node root) {
    const pugi::xml_attribute order = root.attribute("byte_order");
    const std::string order_name = order.as_string();
    if (order && order_name != "LittleEndian" && order_name != "BigEndian")
      fail(root, "byte_order must be LittleEndian or BigEndian, not '" + order_name + "'");
    knows_byte_order_ = !order.empty();
    encoding_.swap = (order_name == "BigEndian") == (std::endian::native == std::endian::little);
    const std::string header = root.attribute("header_type").as_string("UInt32");
    if (header != "UInt32" && header != "UInt64")
      fail(root, "header_type must be UInt32 or UInt64, not '" + header + "'");
    encoding_.long_header = header == "UInt64";
    const std::string compressor = root.attribute("compressor").as_string();
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      fail(root, "compressor " + compressor + " is not supported; write the file with vtkZLibDataCompressor or none");
    encoding_.zlib_compressed = !compressor.empty();
    const pugi::xml_node appended = root.child("AppendedData");
    if (!appended_ || !appended) return;
    const std::string form = text(appended, "encoding");
    if (form != "raw" && form != "base64") fail(appended, "encoding must be raw or base64, not '" + form + "'");
    appended_base64_ = form == "base64";
  }

  [[nodiscard]] Range inline_text(pugi::xml_node array) const {
    pugi::xml_node found;
    for (const pugi::xml_node node : array.children()) {
      if (node.type() != pugi::node_pcdata && node.type() != pugi::node_cdata) continue;
      if (found || node.type() == pugi::node_cdata) fail(array, "the data of an array must be one plain text");
      found = node;
    }
    if (!found) fail(array, "array '" + text(array, "Name") + "' has no data");
    const std::size_t begin = static_cast<std::size_t>(found.offset_debug());
    return {begin, content_.find('<', begin)};
  }

  [[nodiscard]] std::string decoded(pugi::xml_node array, std::optional<std::uint64_t> expected) const {
    if (!knows_byte_order_) fail(array, "binary data, but VTKFile has no attribute byte_order");
    VtuPlace place{file_, array.attribute("Name").as_string(), 0, 0, true, false};
    if (text(array, "format") == "binary") {
      const Range range = inline_text(array);
      place.begin = range.begin;
      place.end = range.end;
      return unpacked(place, expected);
    }
    if (!appended_) fail(array, "appended data, but the file has no AppendedData");
    const std::size_t size = appended_->end - appended_->begin;
    const std::int64_t offset = integer(array, "offset", 0, std::numeric_limits<std::int64_t>::max());
    if (std::cmp_greater_equal(offset, size))
      fail(array,
           "offset " + std::to_string(offset) + " lies outside the " + std::to_string(size) + " bytes of AppendedData");
    place.begin = appended_->begin + static_cast<std::size_t>(offset);
    place.end = appended_->end;
    place.base64 = appended_base64_;
    place.by_byte = true;
    return unpacked(place, expected);
  }

  [[nodiscard]] std::string unpacked(const VtuPlace& place, std::optional<std::uint64_t> expected) const {
    const std::uint64_t most = std::max<std::uint64_t>(kSmall, kMostUnpacked * content_.size());
    std::string data = read_vtu_data(content_, place, encoding_, expected, most - std::min(most, unpacked_));
    unpacked_ += data.size();
    return data;
  }

  [[nodiscard]] bool is_ascii(pugi::xml_node array) const {
    const std::string format = text(array, "format");
    if (format != "ascii" && format != "binary" && format != "appended")
      fail(array, "format must be ascii, binary or appended, not '" + format + "'");
    return format == "ascii";
  }

  template <class Value>
  [[nodiscard]] std::vector<Value> values(pugi::xml_node array, NumberType type,
                                          std::optional<std::uint64_t> count) const {
    const std::string name = "array '" + std::string(array.attribute("Name").as_string()) + "'";
    const std::string what = "value of " + name;
    std::vector<Value> result;
    const auto read = [&](Scanner& scanner, bool binary) {
      NumberReader reader(scanner, binary, binary && encoding_.swap);
      if (count && binary) result.reserve(*count);  // the decoded data have just this size
      while (binary ? scanner.remaining() > 0 : !scanner.at_end()) {
        if (result.size() == count) scanner.fail(name + " has more than " + std::to_string(*count) + " values");
        if constexpr (std::is_same_v<Value, double>)
          result.push_back(reader.real(type, what.c_str()));
        else
          result.push_back(reader.integer(type, what.c_str()));
      }
      if (count && result.size() < *count)
        scanner.fail(name + " ends after " + std::to_string(result.size()) + " of " + std::to_string(*count) +
                     " values");
    };
    if (is_ascii(array)) {
      const Range range = inline_text(array);
      TextScanner scanner(file_, content_, range.begin, range.end);
      read(scanner, false);
    } else {
      const std::string bytes = decoded(array, count ? std::optional(*count * size_of(type)) : std::nullopt);
      Scanner scanner(origin(array).text() + ": decoded data", bytes);
      scanner.binary_positions(true);
      read(scanner, true);
    }
    return result;
  }

  std::string file_, content_;
  pugi::xml_document xml_;
  pugi::xml_node grid_;
  VtuEncoding encoding_;
  mutable std::uint64_t unpacked_ = 0;  // bytes
  bool knows_byte_order_ = false;
  std::optional<Range> appended_;  // after the underscore
  bool appended_base64_ = false;
};

pugi::xml_node only_piece(const VtuDocument& document) {
  const pugi::xml_node piece = document.child(document.grid(), "Piece");
  const pugi::xml_node second = piece.next_sibling("Piece");
  if (second)
    document.fail(second, "the grid has several pieces, whose common points are not joined; write it as one piece");
  return piece;
}

Points points_of(const VtuDocument& document, pugi::xml_node piece) {
  const std::int64_t count = document.integer(piece, "NumberOfPoints", 1, kMost);
  const pugi::xml_node array = document.child(document.child(piece, "Points"), "DataArray");
  if (document.components(array) != 3) document.fail(array, "Points must have NumberOfComponents=\"3\"");
  const std::vector<double> values = document.reals(array, 3 * static_cast<std::uint64_t>(count));
  return Eigen::Map<const Points>(values.data(), count, 3);
}

void read_types(const VtuDocument& document, pugi::xml_node cells, std::size_t count, CellGrid& grid) {
  const pugi::xml_node type_array = document.array(cells, "types"), offset_array = document.array(cells, "offsets");
  const std::vector<std::int64_t> types = document.integers(type_array, count);
  const std::vector<std::int64_t> offsets = document.integers(offset_array, count);
  for (std::size_t cell = 0; cell < count; ++cell) {
    const std::int64_t last = static_cast<std::int64_t>(grid.starts.back());
    if (offsets[cell] <= last)
      document.fail(offset_array, "array 'offsets' must ascend: cell " + std::to_string(cell) + " ends at " +
                                      std::to_string(offsets[cell]) + ", the cell before at " + std::to_string(last));
    const std::string refusal = cell_refusal(cell, types[cell], static_cast<std::size_t>(offsets[cell] - last));
    if (!refusal.empty()) document.fail(type_array, refusal);
    grid.types.push_back(static_cast<std::uint8_t>(types[cell]));
    grid.starts.push_back(static_cast<std::size_t>(offsets[cell]));
  }
}

void read_connectivity(const VtuDocument& document, pugi::xml_node cells, CellGrid& grid) {
  const pugi::xml_node array = document.array(cells, "connectivity");
  const std::vector<std::int64_t> vertices = document.integers(array, grid.starts.back());
  grid.connectivity.reserve(vertices.size());
  for (const std::int64_t vertex : vertices) {
    if (vertex < 0 || vertex >= grid.points.rows()) {
      const auto cell = std::upper_bound(grid.starts.begin(), grid.starts.end(), grid.connectivity.size());
      document.fail(array, "array 'connectivity': cell " + std::to_string(cell - grid.starts.begin() - 1) +
                               " has the vertex " + std::to_string(vertex) + ", outside 0 to " +
                               std::to_string(grid.points.rows() - 1));
    }
    grid.connectivity.push_back(static_cast<Index>(vertex));
  }
}

/// The names of the values of "region": arrays "region_NAME" with one value each, or, of older files, strings.
std::optional<std::vector<std::string>> region_names(const VtuDocument& document) {
  const std::string prefix = "region_";
  std::map<std::int64_t, std::string> names;
  for (const pugi::xml_node array : document.grid().child("FieldData").children()) {
    const std::string name = array.attribute("Name").as_string();
    if (!name.starts_with(prefix)) continue;
    const std::optional<NumberType> type = document.type(array);
    if (!type && name == "region_names") return document.strings(array);
    if (!type || !is_integer(*type) || array.attribute("NumberOfTuples").as_int(1) != 1) continue;
    const std::int64_t value = document.integers(array, 1).front();
    if (!names.emplace(value, name.substr(prefix.size())).second)
      document.fail(array, "two regions have the number " + std::to_string(value));
  }
  std::vector<std::string> listed;
  for (const auto& [value, name] : names) {
    if (std::cmp_not_equal(value, listed.size()))
      document.fail(document.grid(), "the numbers of the regions must be 0 to " + std::to_string(names.size() - 1));
    listed.push_back(name);
  }
  return names.empty() ? std::nullopt : std::optional(listed);
}

void read_labels(const VtuDocument& document, pugi::xml_node piece, CellGrid& grid) {
  for (const pugi::xml_node array : piece.child("CellData").children("DataArray")) {
    const std::optional<NumberType> type = document.type(array);
    if (!type || !is_integer(*type) || document.components(array) != 1) continue;
    CellLabels labels{document.text(array, "Name"), {}, std::nullopt, document.origin(array)};
    labels.values = document.integers(array, grid.types.size());
    if (labels.name == "region") {
      labels.names = region_names(document);
      const bool none = std::all_of(labels.values.begin(), labels.values.end(), [](auto value) { return value == -1; });
      if (!labels.names && none) labels.names.emplace();  // a file of softkin's without regions
    }
    grid.labels.push_back(std::move(labels));
  }
}

}  // namespace

Points read_vtu_points(const std::filesystem::path& path) {
  const VtuDocument document(path);
  return points_of(document, only_piece(document));
}

std::map<std::string, std::vector<double>> read_vtu_arrays(const std::filesystem::path& path) {
  const VtuDocument document(path);
  std::map<std::string, std::vector<double>> arrays;
  for (const pugi::xml_node array : document.grid().child("FieldData").children("DataArray")) {
    const std::optional<NumberType> type = document.type(array);
    if (!type || is_integer(*type)) continue;
    const auto count = static_cast<std::uint64_t>(document.integer(array, "NumberOfTuples", 0, kMost));
    arrays[document.text(array, "Name")] =
        document.reals(array, count * static_cast<std::uint64_t>(document.components(array)));
  }
  return arrays;
}

Points read_vtu_point_vectors(const std::filesystem::path& path, const std::string& name) {
  const VtuDocument document(path);
  const pugi::xml_node piece = only_piece(document);
  const auto count = static_cast<Index>(document.integer(piece, "NumberOfPoints", 1, kMost));
  const pugi::xml_node array = document.array(document.child(piece, "PointData"), name);
  if (document.components(array) != 3) document.fail(array, "array '" + name + "' must have three components");
  const std::vector<double> values = document.reals(array, 3 * static_cast<std::uint64_t>(count));
  return Eigen::Map<const Points>(values.data(), count, 3);
}

namespace {

/// Points and cells, without labels.
CellGrid read_cells(const VtuDocument& document, pugi::xml_node piece) {
  CellGrid grid;
  grid.points = points_of(document, piece);
  const std::int64_t count = document.integer(piece, "NumberOfCells", 1, kMost);
  const pugi::xml_node cells = document.child(piece, "Cells");
  read_types(document, cells, static_cast<std::size_t>(count), grid);
  read_connectivity(document, cells, grid);
  return grid;
}

}  // namespace

CellVectors read_vtu_cell_vectors(const std::filesystem::path& path, const std::string& name) {
  const VtuDocument document(path);
  const pugi::xml_node piece = only_piece(document);
  const CellGrid grid = read_cells(document, piece);
  const pugi::xml_node array = document.array(document.child(piece, "CellData"), name);
  if (document.components(array) != 3) document.fail(array, "array '" + name + "' must have three components");
  const auto count = static_cast<Index>(grid.types.size());
  const std::vector<double> values = document.reals(array, 3 * static_cast<std::uint64_t>(count));
  CellVectors vectors{Points::Zero(count, 3), Eigen::Map<const Points>(values.data(), count, 3)};
  for (Index cell = 0; cell < count; ++cell) {
    const std::size_t begin = grid.starts[static_cast<std::size_t>(cell)];
    const std::size_t end = grid.starts[static_cast<std::size_t>(cell) + 1];
    for (std::size_t i = begin; i < end; ++i)
      vectors.centers.row(cell) += grid.points.row(grid.connectivity[i]) / static_cast<double>(end - begin);
  }
  return vectors;
}

Mesh read_vtu(const std::filesystem::path& path) {
  const VtuDocument document(path);
  const pugi::xml_node piece = only_piece(document);
  CellGrid grid = read_cells(document, piece);
  read_labels(document, piece, grid);
  return mesh_of(grid, {path.string()});
}

}  // namespace softkin
