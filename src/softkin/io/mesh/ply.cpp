#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <softkin/io/mesh/surface_builder.hpp>
#include <softkin/io/mesh/surface_files.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin {

namespace {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct ScalarName {
  std::string_view name;
  Scalar scalar;
};

constexpr ScalarName scalar_names[] = {
    {"char", Scalar::int8},      {"int8", Scalar::int8},       {"uchar", Scalar::uint8},
    {"uint8", Scalar::uint8},    {"short", Scalar::int16},     {"int16", Scalar::int16},
    {"ushort", Scalar::uint16},  {"uint16", Scalar::uint16},   {"int", Scalar::int32},
    {"int32", Scalar::int32},    {"uint", Scalar::uint32},     {"uint32", Scalar::uint32},
    {"float", Scalar::float32},  {"float32", Scalar::float32}, {"double", Scalar::float64},
    {"float64", Scalar::float64}};

std::size_t bytes_of(Scalar scalar) {
  constexpr std::array<std::size_t, 8> bytes{1, 1, 2, 2, 4, 4, 4, 8};
  return bytes[static_cast<std::size_t>(scalar)];
}

bool is_whole(Scalar scalar) {
  return scalar != Scalar::float32 && scalar != Scalar::float64;
}

struct Property {
  std::string name;
  Scalar value = Scalar::float32;
  std::optional<Scalar> count{};  // of a list
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties{};
};

class PlyReader {
 public:
  PlyReader(const std::string& file, std::string_view content) : scanner_(file, content) {}

  TriangleSurface read() {
    read_header();
    scanner_.binary_positions(binary_);
    for (const Element& element : elements_) read_element(element);
    check_end();
    Welder welder;
    for (const Face& face : faces_) add(face, welder);
    if (welder.empty()) throw InvalidInput({scanner_.here().file}, "the file has no faces");
    return std::move(welder).surface();
  }

 private:
  struct Face {
    std::size_t place;       // its line, or byte
    std::size_t begin, end;  // of its corners
  };

  void read_header() {
    scanner_.expect("ply");
    scanner_.end_line();
    bool has_format = false;
    for (std::string word(scanner_.token("end_header")); word != "end_header"; word = scanner_.token("end_header")) {
      if (word == "format") {
        read_format();
        has_format = true;
      } else if (word == "element") {
        begin_element();
      } else if (word == "property") {
        read_property();
      } else if (word == "comment" || word == "obj_info") {
        scanner_.skip_line();
      } else {
        scanner_.fail("unknown line " + excerpt(word) + " in the header of a PLY file");
      }
    }
    if (!has_format) scanner_.fail("the header ends without a line 'format'");
    scanner_.end_line();
    check_elements();
  }

  void read_format() {
    const std::string_view form = on_line(scanner_, "the format").token("the format");
    binary_ = form != "ascii";
    if (binary_ && form != "binary_little_endian" && form != "binary_big_endian")
      scanner_.fail("format " + excerpt(form) + " is none of ascii, binary_little_endian and binary_big_endian");
    swap_ = (form == "binary_big_endian") != (std::endian::native == std::endian::big);
    if (on_line(scanner_, "the version").token("the version") != "1.0") scanner_.fail("only PLY version 1.0 is read");
    scanner_.end_line();
  }

  void begin_element() {
    const std::string name(on_line(scanner_, "the element's name").token("the element's name"));
    const std::int64_t count = read_index(on_line(scanner_, "the number of elements"), "number of elements", 0,
                                          std::numeric_limits<Index>::max());
    elements_.push_back({name, count});
    scanner_.end_line();
  }

  void read_property() {
    if (elements_.empty()) scanner_.fail("a property before the first element");
    Property property;
    std::string_view word = on_line(scanner_, "the type").token("the type of the property");
    if (word == "list") {
      property.count = scalar(on_line(scanner_, "the type").token("the type of a list's length"));
      if (!is_whole(*property.count)) scanner_.fail("the length of a list must be of a whole number's type");
      word = on_line(scanner_, "the type").token("the type of a list's values");
    }
    property.value = scalar(word);
    property.name = on_line(scanner_, "the name").token("the name of the property");
    scanner_.end_line();
    elements_.back().properties.push_back(std::move(property));
  }

  [[nodiscard]] Scalar scalar(std::string_view word) const {
    for (const auto& [name, scalar] : scalar_names)
      if (word == name) return scalar;
    scanner_.fail("unknown type " + excerpt(word) + " of a property");
  }

  static bool is_vertices(const Property& property) {
    return property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
  }

  void check_elements() const {
    const Element* vertex = nullptr;
    const Element* face = nullptr;
    for (const Element& element : elements_) {
      if (element.name == "tristrips" && element.count > 0)
        scanner_.fail("the faces are triangle strips: write them as a list of faces");
      for (const auto& [name, place] : {std::pair("vertex", &vertex), std::pair("face", &face)}) {
        if (element.name != name) continue;
        if (*place != nullptr) scanner_.fail("the header has a second element '" + element.name + "'");
        *place = &element;
      }
      if (element.properties.empty() && element.count > 0)
        scanner_.fail("the element " + excerpt(element.name) + " has no property");
    }
    if (vertex == nullptr || face == nullptr || face->count == 0)
      throw InvalidInput({scanner_.here().file}, "the file has no faces");
    for (const char* axis : {"x", "y", "z"})
      if (std::count_if(vertex->properties.begin(), vertex->properties.end(),
                        [&](const Property& p) { return p.name == axis && !p.count; }) != 1)
        scanner_.fail("the element 'vertex' needs one property " + std::string(axis));
    const auto lists = std::count_if(face->properties.begin(), face->properties.end(), is_vertices);
    const auto whole = std::all_of(face->properties.begin(), face->properties.end(),
                                   [](const Property& p) { return !is_vertices(p) || is_whole(p.value); });
    if (lists != 1 || !whole)
      scanner_.fail("the element 'face' needs one list 'vertex_indices' (or 'vertex_index') of whole numbers");
  }

  void read_element(const Element& element) {
    std::size_t least = 0;  // bytes of one
    for (const Property& p : element.properties) least += binary_ ? bytes_of(p.count ? *p.count : p.value) : 2;
    scanner_.require(static_cast<std::uint64_t>(element.count), least == 0 ? 1 : least, "elements");
    for (std::int64_t i = 0; i < element.count; ++i) {
      SurfaceCorner vertex{};
      for (const Property& property : element.properties) {
        if (property.count)
          read_list(element, property);
        else if (element.name == "vertex" && property.name.size() == 1 && property.name[0] >= 'x' &&
                 property.name[0] <= 'z')
          vertex[static_cast<std::size_t>(property.name[0] - 'x')] = read_coordinate(property.value);
        else
          skip_number(property.value);
      }
      if (element.name == "vertex") vertices_.push_back(vertex);
    }
  }

  void read_list(const Element& element, const Property& property) {
    const double length = read_whole(*property.count, "length of a list");
    if (length < 0) scanner_.fail("the length of a list is " + std::to_string(static_cast<std::int64_t>(length)));
    const auto count = static_cast<std::uint64_t>(length);
    scanner_.require(count, binary_ ? bytes_of(property.value) : 2, "values of a list");
    const bool vertices = element.name == "face" && is_vertices(property);
    if (!vertices) {
      for (std::uint64_t i = 0; i < count; ++i) skip_number(property.value);
      return;
    }
    Face face{binary_ ? scanner_.here().byte : scanner_.here().line, corners_.size(), 0};
    for (std::uint64_t i = 0; i < count; ++i)
      corners_.push_back(static_cast<std::int64_t>(read_whole(property.value, "vertex of a face")));
    face.end = corners_.size();
    if (count < 3) scanner_.fail("a face of " + std::to_string(count) + " vertices");
    faces_.push_back(face);
  }

  void skip_number(Scalar scalar) {
    if (binary_)
      (void)scanner_.take(bytes_of(scalar), "a value of a property");
    else
      (void)scanner_.token("a value of a property");
  }

  double read_coordinate(Scalar scalar) {
    const double value = read_number(scalar);
    if (!std::isfinite(value)) scanner_.fail("coordinate of a vertex must be a finite number");
    return value;
  }

  double read_whole(Scalar scalar, const char* what) {
    if (binary_) return read_number(scalar);
    return static_cast<double>(
        scanner_.integer(what, std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::uint32_t>::max()));
  }

  /// Every value of these types is one of double precision.
  double read_number(Scalar scalar) {
    if (!binary_) return scanner_.real("value of a property");
    constexpr const char* what = "a value of a property";
    switch (scalar) {
      case Scalar::int8:
        return scanner_.binary<std::int8_t>(what, swap_);
      case Scalar::uint8:
        return scanner_.binary<std::uint8_t>(what, swap_);
      case Scalar::int16:
        return scanner_.binary<std::int16_t>(what, swap_);
      case Scalar::uint16:
        return scanner_.binary<std::uint16_t>(what, swap_);
      case Scalar::int32:
        return scanner_.binary<std::int32_t>(what, swap_);
      case Scalar::uint32:
        return scanner_.binary<std::uint32_t>(what, swap_);
      case Scalar::float32:
        return scanner_.binary<float>(what, swap_);
      case Scalar::float64:
        break;
    }
    return scanner_.binary<double>(what, swap_);
  }

  void check_end() {
    if (!binary_) return expect_end(scanner_);
    const std::size_t more = scanner_.remaining();
    const std::string_view rest = scanner_.take(more, "the end");
    if (!trimmed(rest).empty()) scanner_.fail(std::to_string(more) + " bytes follow after the last element");
  }

  void add(const Face& face, Welder& welder) const {
    std::vector<SurfaceCorner> polygon;
    for (std::size_t i = face.begin; i < face.end; ++i) {
      if (corners_[i] < 0 || corners_[i] >= static_cast<std::int64_t>(vertices_.size()))
        fail(face, "the face has the vertex " + std::to_string(corners_[i]) + " (from 0), but the file has " +
                       std::to_string(vertices_.size()));
      polygon.push_back(vertices_[static_cast<std::size_t>(corners_[i])]);
    }
    const auto refuse = [&](const std::string& why) { fail(face, "the face " + why); };
    for (const FacetCorners& corners : triangulated(std::move(polygon), refuse)) welder.add(corners);
  }

  [[noreturn]] void fail(const Face& face, const std::string& message) const {
    Origin origin{.file = scanner_.here().file, .binary = binary_};
    (binary_ ? origin.byte : origin.line) = face.place;
    throw InvalidInput(origin, message);
  }

  Scanner scanner_;
  bool binary_ = false, swap_ = false;
  std::vector<Element> elements_;
  std::vector<SurfaceCorner> vertices_;
  std::vector<std::int64_t> corners_;  // of all faces
  std::vector<Face> faces_;
};

}  // namespace

TriangleSurface read_ply(const std::string& file, std::string_view content) {
  return PlyReader(file, content).read();
}

}  // namespace softkin
