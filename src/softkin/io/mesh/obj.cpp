#include <algorithm>
#include <array>
#include <softkin/io/mesh/surface_builder.hpp>
#include <softkin/io/mesh/surface_files.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <utility>
#include <vector>

namespace softkin {

namespace {

/// Statements that define no vertices and faces.
constexpr std::string_view passed_over[] = {
    "vt",     "vn",     "vp",     "o",     "g",        "s",        "mg",  "l",          "p",         "mtllib",
    "usemtl", "usemap", "maplib", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "fo"};
/// Curves and surfaces that are no polygons.
constexpr std::string_view free_forms[] = {"cstype", "deg",  "bmat", "step", "curv", "curv2", "surf",  "parm",
                                           "trim",   "hole", "scrv", "sp",   "end",  "con",   "ctech", "stech"};

template <std::size_t N>
bool is_one_of(const std::string_view (&words)[N], std::string_view word) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

class ObjReader {
 public:
  ObjReader(const std::string& file, std::string content)
      : content_(joined_lines(without_comments(std::move(content)))), scanner_(file, content_) {}

  TriangleSurface read() {
    while (!scanner_.at_end()) read_statement();
    Welder welder;
    for (const Face& face : faces_) add(face, welder);
    if (welder.empty()) throw InvalidInput({scanner_.here().file}, "the file has no faces");
    return std::move(welder).surface();
  }

 private:
  struct Face {
    std::size_t line, begin, end;  // of its corners
  };

  /// A line that ends in a backslash continues on the next one; the statements after it keep their lines.
  static std::string joined_lines(const std::string& content) {
    std::string joined;
    joined.reserve(content.size());
    std::size_t missing = 0;  // ends of lines
    for (std::size_t i = 0; i < content.size(); ++i) {
      const std::size_t end = content.compare(i, 3, "\\\r\n") == 0 ? i + 2 : i + 1;
      if (content[i] == '\\' && end < content.size() && content[end] == '\n') {
        joined += ' ';
        ++missing;
        i = end;
        continue;
      }
      joined += content[i];
      if (content[i] == '\n') joined.append(std::exchange(missing, 0), '\n');
    }
    return joined;
  }

  void read_statement() {
    const std::string_view word = scanner_.token("a statement");
    if (word == "v") return read_vertex();
    if (word == "f") return read_face();
    if (is_one_of(free_forms, word))
      scanner_.fail("'" + std::string(word) + "' is of free-form curves and surfaces: export the surface as polygons");
    if (!is_one_of(passed_over, word))
      scanner_.fail("unknown statement " + excerpt(word) + ": an OBJ file has lines such as 'v x y z' and 'f 1 2 3'");
    scanner_.skip_line();
  }

  void read_vertex() {
    SurfaceCorner& vertex = vertices_.emplace_back();
    for (double& x : vertex) x = on_line(scanner_, "coordinate of a vertex").real("coordinate of a vertex");
    scanner_.skip_line();  // a weight, colours
  }

  void read_face() {
    Face face{scanner_.here().line, corners_.size(), 0};
    while (scanner_.line_has_more()) corners_.push_back(read_corner());
    scanner_.skip_line();
    face.end = corners_.size();
    if (face.end - face.begin < 3) fail(face, "a face of " + std::to_string(face.end - face.begin) + " vertices");
    faces_.push_back(face);
  }

  /// The vertex of "v", "v/vt", "v//vn" or "v/vt/vn", from 0; negative numbers count from the last vertex back.
  std::int64_t read_corner() {
    const std::string_view word = scanner_.token("vertex of a face");
    const auto count = static_cast<std::int64_t>(vertices_.size());
    std::int64_t number = 0;
    if (!parse_integer(word.substr(0, word.find('/')), number) || number == 0)
      scanner_.fail("vertex of a face must be a whole number from 1, or below 0, not " + excerpt(word));
    if (number > 0) return number - 1;
    if (number < -count)
      scanner_.fail("vertex of a face is " + std::to_string(number) + ", but only " + std::to_string(count) +
                    " vertices stand before it");
    return count + number;
  }

  void add(const Face& face, Welder& welder) const {
    std::vector<SurfaceCorner> polygon;
    for (std::size_t i = face.begin; i < face.end; ++i) {
      if (corners_[i] >= static_cast<std::int64_t>(vertices_.size()))
        fail(face, "the face has the vertex " + std::to_string(corners_[i] + 1) + ", but the file has " +
                       std::to_string(vertices_.size()));
      polygon.push_back(vertices_[static_cast<std::size_t>(corners_[i])]);
    }
    const auto refuse = [&](const std::string& why) { fail(face, "the face " + why); };
    for (const FacetCorners& corners : triangulated(std::move(polygon), refuse)) welder.add(corners);
  }

  [[noreturn]] void fail(const Face& face, const std::string& message) const {
    throw InvalidInput({scanner_.here().file, face.line}, message);
  }

  std::string content_;
  Scanner scanner_;
  std::vector<SurfaceCorner> vertices_;
  std::vector<std::int64_t> corners_;  // of all faces
  std::vector<Face> faces_;
};

}  // namespace

TriangleSurface read_obj(const std::string& file, std::string content) {
  return ObjReader(file, std::move(content)).read();
}

}  // namespace softkin
