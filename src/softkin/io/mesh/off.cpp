#include <array>
#include <softkin/io/mesh/surface_builder.hpp>
#include <softkin/io/mesh/surface_files.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <utility>
#include <vector>

namespace softkin {

namespace {

class OffReader {
 public:
  OffReader(const std::string& file, std::string content)
      : content_(without_comments(std::move(content))), scanner_(file, content_) {}

  TriangleSurface read() {
    if (scanner_.at_end()) scanner_.fail("the file is empty");
    Scanner ahead("", content_);
    if (const std::string_view word = ahead.token("OFF"); is_off_keyword(word)) read_keyword();
    const Index vertices = read_count(scanner_, "vertices", 0, 6);
    const Index faces = read_count(on_line(scanner_, "the number of faces"), "faces", 0, 2);
    if (scanner_.line_has_more()) (void)read_count(scanner_, "edges", 0, 1);  // many write 0
    scanner_.end_line();
    for (Index i = 0; i < vertices; ++i) read_vertex();
    for (Index i = 0; i < faces; ++i) read_face();
    expect_end(scanner_);
    if (welder_.empty()) throw InvalidInput({scanner_.here().file}, "the file has no faces");
    return std::move(welder_).surface();
  }

 private:
  void read_keyword() {
    const std::string word(scanner_.token("OFF"));
    if (word.find_first_of("4n") != std::string::npos)
      scanner_.fail("'" + word + "' has coordinates of another number than three: write it as OFF");
    if (!scanner_.line_has_more()) return;
    Scanner ahead("", std::string_view(content_).substr(content_.size() - scanner_.remaining()));
    if (ahead.token("BINARY") == "BINARY") scanner_.fail("a binary OFF file is not read: write it as text");
  }

  /// Three coordinates; what else a line has are colours, a normal or a place in a texture.
  void read_vertex() {
    (void)scanner_.at_end();
    SurfaceCorner vertex;
    vertex[0] = scanner_.real("coordinate of a vertex");
    for (int axis = 1; axis < 3; ++axis) vertex[axis] = on_line(scanner_, "coordinate").real("coordinate of a vertex");
    vertices_.push_back(vertex);
    scanner_.skip_line();
  }

  void read_face() {
    const Index corners = read_count(scanner_, "vertices of a face", 3, 2);
    std::vector<SurfaceCorner> polygon;
    for (Index i = 0; i < corners; ++i) {
      const Index vertex =
          read_index(on_line(scanner_, "a vertex of the face"), "vertex of a face", 0, std::ssize(vertices_) - 1);
      polygon.push_back(vertices_[static_cast<std::size_t>(vertex)]);
    }
    const auto fail = [&](const std::string& why) { scanner_.fail("the face " + why); };
    for (const FacetCorners& facet : triangulated(std::move(polygon), fail)) welder_.add(facet);
    scanner_.skip_line();  // a colour
  }

  std::string content_;
  Scanner scanner_;
  std::vector<SurfaceCorner> vertices_;
  Welder welder_;
};

}  // namespace

bool is_off_keyword(std::string_view word) {
  for (const std::string_view prefix : {"ST", "C", "N", "4", "n"})
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  return word == "OFF";
}

TriangleSurface read_off(const std::string& file, std::string content) {
  return OffReader(file, std::move(content)).read();
}

}  // namespace softkin
