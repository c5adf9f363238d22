#include <cmath>
#include <limits>
#include <optional>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin {

namespace fs = std::filesystem;

namespace {

constexpr Index max_columns = 1000;

/// One of TetGen's files: a header line, then one numbered entry a line.
struct TetgenFile {
  std::string content;
  Scanner scanner;

  explicit TetgenFile(const fs::path& path) : content(read_without_comments(path)), scanner(path.string(), content) {}

  /// A header's number that may be left out.
  Index option(const char* what, Index high, Index otherwise) {
    return scanner.line_has_more() ? read_index(scanner, what, 0, high) : otherwise;
  }

  void entry_number(Index expected) {
    const Index number = read_label(scanner, "entry number");
    if (number != expected)
      scanner.fail("entry number " + std::to_string(number) + " where " + std::to_string(expected) + " is due");
  }

  double real(const char* what) { return on_line(scanner, what).real(what); }
  Index label(const char* what) { return read_label(on_line(scanner, what), what); }

  template <std::size_t K>
  void vertices(std::array<Index, K>& element, Index first, const Mesh& mesh) {
    const Index last = first + static_cast<Index>(mesh.vertices.rows()) - 1;
    for (Index& vertex : element)
      vertex = read_index(on_line(scanner, "vertex number"), "vertex number", first, last) - first;
  }
};

/// Returns the number of the first vertex, 0 or 1.
Index read_nodes(const fs::path& path, Mesh& mesh) {
  TetgenFile file(path);
  Scanner& scanner = file.scanner;
  const Index count = read_count(scanner, "vertices", 1, 8);
  if (file.option("dimension", 3, 3) != 3) scanner.fail("only meshes of dimension 3 are read");
  const Index attributes = file.option("number of attributes", max_columns, 0);
  const Index markers = file.option("boundary marker flag", 1, 0);
  scanner.end_line();
  mesh.vertices.resize(count, 3);
  Index first = 0;
  for (Index i = 0; i < count; ++i) {
    if (i == 0)
      first = read_index(scanner, "first vertex number", 0, 1);
    else
      file.entry_number(first + i);
    for (int axis = 0; axis < 3; ++axis) mesh.vertices(i, axis) = file.real("coordinate");
    for (Index a = 0; a < attributes; ++a) (void)file.real("attribute");
    if (markers) (void)file.label("boundary marker");
    scanner.end_line();
  }
  expect_end(scanner);
  return first;
}

/// TetGen writes its region numbers as reals.
Index whole_attribute(TetgenFile& file) {
  const double value = file.real("attribute");
  if (value != std::floor(value) || std::abs(value) > std::numeric_limits<Index>::max())
    file.scanner.fail("the element attribute must be a whole number to name a region");
  return static_cast<Index>(value);
}

/// The six nodes that TetGen's -o2 adds to the tetrahedron that was read last: on its edges 23, 03, 01, 12, 13, 02
/// (`edge2ver` of TetGen 1.5 and 1.6).
void read_edge_nodes(TetgenFile& file, Index first, Mesh& mesh) {
  constexpr std::size_t place[6] = {5, 3, 0, 1, 4, 2};
  EdgeNodes written, nodes;
  file.vertices(written, first, mesh);
  for (std::size_t i = 0; i < 6; ++i) nodes[place[i]] = written[i];
  const Tetrahedron& corners = mesh.tetrahedra[mesh.edge_nodes.size()];
  mesh.edge_nodes.push_back(nodes);
  const auto at = [&](Index vertex) { return Vec3(mesh.vertices.row(vertex).transpose()); };
  const auto distance = [&](Index node, const int(&edge)[2]) {
    const Vec3 middle = (at(corners[edge[0]]) + at(corners[edge[1]])) / 2;
    return (at(node) - middle).norm();
  };
  // other versions wrote another order, which the file does not specify
  for (std::size_t i = 0; i < 6; ++i)
    for (const auto& edge : tetrahedron_edges)
      if (2 * distance(nodes[i], edge) < distance(nodes[i], tetrahedron_edges[i]))
        file.scanner.fail("the edge nodes are not in the order of TetGen 1.5 and 1.6, edges 34, 14, 12, 23, 24, 13");
}

void read_tetrahedra(const fs::path& path, Index first, Mesh& mesh) {
  TetgenFile file(path);
  Scanner& scanner = file.scanner;
  const Index count = read_count(scanner, "tetrahedra", 1, 10);
  const Index nodes = file.option("nodes per element", max_columns, 4);
  if (nodes != 4 && nodes != 10) scanner.fail("elements have " + std::to_string(nodes) + " nodes, not 4 or 10");
  const Index attributes = file.option("number of attributes", max_columns, 0);
  scanner.end_line();
  LabelledRegions regions;
  mesh.tetrahedra.resize(count);
  for (Index i = 0; i < count; ++i) {
    file.entry_number(first + i);
    file.vertices(mesh.tetrahedra[i], first, mesh);
    if (nodes == 10) read_edge_nodes(file, first, mesh);
    for (Index a = 1; a < attributes; ++a) (void)file.real("attribute");
    if (attributes > 0) regions[whole_attribute(file)].tetrahedra.push_back(i);
    scanner.end_line();
  }
  expect_end(scanner);
  append_regions(mesh, std::move(regions), "attribute_", 3);
}

/// The boundary marker of the face whose vertices were read last. Before it -o2 writes the three nodes on the face's
/// edges, after it -nn the two elements at the face; the header announces neither.
std::optional<Index> read_marker(TetgenFile& file, bool marked, bool quadratic) {
  std::vector<Index> numbers;
  while (file.scanner.line_has_more() && numbers.size() < 6) numbers.push_back(file.label("number of a face"));
  const std::size_t markers = marked ? 1 : 0;
  const std::size_t edge_nodes = quadratic && numbers.size() >= 3 + markers ? 3 : 0;
  if (numbers.size() != edge_nodes + markers && numbers.size() != edge_nodes + markers + 2)
    file.scanner.fail("a face has " + std::to_string(numbers.size()) +
                      " numbers after its vertices, which are not edge nodes (3), marker (1) and elements (2)");
  if (!marked) return std::nullopt;
  return numbers[edge_nodes];
}

void read_faces(const fs::path& path, Index first, Mesh& mesh) {
  TetgenFile file(path);
  Scanner& scanner = file.scanner;
  const Index count = read_count(scanner, "faces", 0, 8);
  const bool markers = file.option("boundary marker flag", 1, 0) == 1;
  scanner.end_line();
  LabelledRegions regions;
  for (Index i = 0; i < count; ++i) {
    Triangle triangle;
    file.entry_number(first + i);
    file.vertices(triangle, first, mesh);
    if (const std::optional<Index> marker = read_marker(file, markers, !mesh.edge_nodes.empty())) {
      regions[*marker].triangles.push_back(i);
      mesh.triangles.push_back(triangle);
    }
    scanner.end_line();
  }
  expect_end(scanner);
  append_regions(mesh, std::move(regions), "marker_", 2);
}

}  // namespace

Mesh read_tetgen(const fs::path& path) {
  const auto part = [&](const char* extension) {
    return lower_extension(path) == extension ? path : fs::path(path).replace_extension(extension);
  };
  Mesh mesh;
  const Index first = read_nodes(part(".node"), mesh);
  read_tetrahedra(part(".ele"), first, mesh);
  const fs::path faces = part(".face");
  std::error_code failure;
  if (fs::exists(faces, failure)) read_faces(faces, first, mesh);
  return mesh;
}

}  // namespace softkin
