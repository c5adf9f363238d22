#include <algorithm>
#include <bit>
#include <limits>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/vtu_document.hpp>
#include <type_traits>
#include <utility>

namespace softkin {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";
/// Coordinates pack to a half, connectivity to a tenth: who unpacks to more than this many times the file wants to fill
/// the memory. Nothing small does.
constexpr std::uint64_t kMaxUnpacked = 100, kSmall = 1 << 26;

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

}  // namespace

VtuDocument::VtuDocument(const std::filesystem::path& path) : file_(path.string()), content_(read_file(path)) {
  parse(head_of_file());
  const pugi::xml_node root = xml_.document_element();
  if (std::string(root.name()) != "VTKFile") fail(root, "not a VTK file: the first element must be VTKFile");
  const std::string kind = text(root, "type");
  if (kind != "UnstructuredGrid") fail(root, "the file is of type " + kind + "; a mesh must be an UnstructuredGrid");
  read_encoding(root);
  grid_ = child(root, "UnstructuredGrid");
}

pugi::xml_node VtuDocument::child(pugi::xml_node parent, const char* name) const {
  const pugi::xml_node found = parent.child(name);
  if (!found) fail(parent, std::string(parent.name()) + " has no " + name);
  return found;
}

pugi::xml_node VtuDocument::array(pugi::xml_node parent, const std::string& name) const {
  for (const pugi::xml_node node : parent.children("DataArray"))
    if (node.attribute("Name").as_string() == name) return node;
  fail(parent, std::string(parent.name()) + " has no array '" + name + "'");
}

std::string VtuDocument::text(pugi::xml_node node, const char* attribute) const {
  const pugi::xml_attribute found = node.attribute(attribute);
  if (!found) fail(node, std::string(node.name()) + " has no attribute " + attribute);
  return found.as_string();
}

std::int64_t VtuDocument::integer(pugi::xml_node node, const char* attribute, std::int64_t low,
                                  std::int64_t high) const {
  const std::string value = text(node, attribute);
  std::int64_t number = 0;
  if (!parse_integer(value, number) || number < low || number > high)
    fail(node, std::string(attribute) + " must be an integer from " + std::to_string(low) + " to " +
                   std::to_string(high) + ", not '" + value.substr(0, 40) + "'");
  return number;
}

std::int64_t VtuDocument::components(pugi::xml_node array) const {
  return array.attribute("NumberOfComponents") ? integer(array, "NumberOfComponents", 1, 1 << 20) : 1;
}

std::optional<NumberType> VtuDocument::type(pugi::xml_node array) const {
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

std::vector<double> VtuDocument::reals(pugi::xml_node array, std::uint64_t count) const {
  const std::optional<NumberType> number = type(array);
  if (!number) fail(array, "array '" + text(array, "Name") + "' must hold numbers");
  return values<double>(array, *number, count);
}

std::vector<std::int64_t> VtuDocument::integers(pugi::xml_node array, std::uint64_t count) const {
  const std::optional<NumberType> number = type(array);
  if (!number || !is_integer(*number)) fail(array, "array '" + text(array, "Name") + "' must be of an integer type");
  return values<std::int64_t>(array, *number, count);
}

std::vector<std::string> VtuDocument::strings(pugi::xml_node array) const {
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
    fail(array,
         "array '" + text(array, "Name") + "' holds " + std::to_string(result.size()) + " strings, not NumberOfTuples");
  return result;
}

Origin VtuDocument::origin(pugi::xml_node node) const {
  const std::ptrdiff_t offset = node.offset_debug();
  return {file_, offset < 0 ? 0 : line_of(content_, offset)};
}

void VtuDocument::fail(pugi::xml_node node, const std::string& message) const {
  throw InvalidInput(origin(node), message);
}

std::string VtuDocument::head_of_file() {
  if (content_.find_first_not_of(kBlanks) == std::string::npos) throw InvalidInput({file_, 1}, "the file is empty");
  const std::size_t tag = find_appended_tag(content_);
  if (tag == std::string::npos) return content_;
  const std::size_t close = content_.find('>', tag);
  if (close == std::string::npos) throw InvalidInput({file_, line_of(content_, tag)}, "AppendedData is not closed");
  if (content_[close - 1] == '/') return content_;
  find_appended_data(close + 1);
  return content_.substr(0, close + 1) + "</AppendedData></VTKFile>";
}

void VtuDocument::find_appended_data(std::size_t tag) {
  const auto refuse = [&](const std::string& message) { throw InvalidInput({file_, line_of(content_, tag)}, message); };
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

void VtuDocument::parse(const std::string& head) {
  const pugi::xml_parse_result result =
      xml_.load_buffer(head.data(), head.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result)
    throw InvalidInput({file_, line_of(content_, std::max<std::ptrdiff_t>(result.offset, 0))},
                       std::string("not well-formed XML: ") + result.description());
}

void VtuDocument::read_encoding(pugi::xml_node root) {
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

VtuDocument::Range VtuDocument::inline_text(pugi::xml_node array) const {
  pugi::xml_node found;
  for (const pugi::xml_node node : array.children()) {
    if (node.type() != pugi::node_pcdata && node.type() != pugi::node_cdata) continue;
    if (found || node.type() == pugi::node_cdata) fail(array, "the data of an array must be one plain text");
    found = node;
  }
  if (!found) fail(array, "array '" + text(array, "Name") + "' has no data");
  const std::size_t begin = found.offset_debug();
  return {begin, content_.find('<', begin)};
}

std::string VtuDocument::decoded(pugi::xml_node array, std::optional<std::uint64_t> expected) const {
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

std::string VtuDocument::unpacked(const VtuPlace& place, std::optional<std::uint64_t> expected) const {
  const std::uint64_t most = std::max<std::uint64_t>(kSmall, kMaxUnpacked * content_.size());
  std::string data = read_vtu_data(content_, place, encoding_, expected, most - std::min(most, unpacked_));
  unpacked_ += data.size();
  return data;
}

bool VtuDocument::is_ascii(pugi::xml_node array) const {
  const std::string format = text(array, "format");
  if (format != "ascii" && format != "binary" && format != "appended")
    fail(array, "format must be ascii, binary or appended, not '" + format + "'");
  return format == "ascii";
}

template <class Value>
std::vector<Value> VtuDocument::values(pugi::xml_node array, NumberType type,
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
      scanner.fail(name + " ends after " + std::to_string(result.size()) + " of " + std::to_string(*count) + " values");
  };
  if (is_ascii(array)) {
    if (count == 0u && !array.first_child()) return result;  // blanks alone
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

}  // namespace softkin
