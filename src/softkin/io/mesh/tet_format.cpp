#include <optional>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softkin {

namespace fs = std::filesystem;

namespace {

/// "a:b:c:" or "a:b:c" -> a, b, c
std::vector<std::string_view> split_row(std::string_view text) {
  if (text.back() == ':') text.remove_suffix(1);
  std::vector<std::string_view> cells;
  for (std::size_t colon = text.find(':'); colon != std::string_view::npos; colon = text.find(':')) {
    cells.push_back(trimmed(text.substr(0, colon)));
    text.remove_prefix(colon + 1);
  }
  cells.push_back(trimmed(text));
  return cells;
}

void check_id(const Scanner& scanner, std::string_view text, Index row, std::int64_t& first) {
  std::int64_t id = 0;
  if (!parse_integer(text, id))
    scanner.fail("row number must be an integer, not '" + std::string(text.substr(0, 40)) + "'");
  if (row == 0) {
    if (id != 0 && id != 1) scanner.fail("rows must count from 0 or 1, not from " + std::to_string(id));
    first = id;
  }
  if (id != first + row)
    scanner.fail("row number " + std::to_string(id) + " where " + std::to_string(first + row) + " is due");
}

void read_flags(const Scanner& scanner, const std::vector<std::string_view>& cells, std::size_t begin,
                Sidecar& sidecar) {
  if (sidecar.rows == 0) sidecar.columns.resize(cells.size() - begin);
  if (cells.size() - begin != sidecar.columns.size())
    scanner.fail("row has " + std::to_string(cells.size() - begin) + " columns, the first one has " +
                 std::to_string(sidecar.columns.size()));
  for (std::size_t i = begin; i < cells.size(); ++i) {
    if (cells[i] != "0" && cells[i] != "1")
      scanner.fail("column " + std::to_string(i - begin + 1) + " must be 0 or 1, not '" +
                   std::string(cells[i].substr(0, 40)) + "'");
    if (cells[i] == "1") sidecar.columns[i - begin].push_back(sidecar.rows);
  }
}

/// Names of a file next to NAME.tet: NAME_chamber.txt; next to ROBOT_body.tet also ROBOT_chamber.txt, as the paper's
/// authors publish theirs.
std::vector<std::string> names_beside(const fs::path& path, const std::string& suffix) {
  constexpr std::string_view body = "_body";
  const std::string stem = path.stem().string();
  std::vector<std::string> names{stem + suffix};
  if (stem.size() > body.size() && stem.ends_with(body))
    names.push_back(stem.substr(0, stem.size() - body.size()) + suffix);
  return names;
}

/// Which of these files is there; none: it is noted as missing.
std::optional<fs::path> find_sidecar(const fs::path& path, const std::string& suffix, const std::string& holds,
                                     Mesh& mesh) {
  std::optional<fs::path> found;
  const std::vector<std::string> names = names_beside(path, suffix);
  for (const std::string& name : names) {
    const fs::path file = path.parent_path() / name;
    std::error_code failure;
    if (!fs::exists(file, failure)) continue;
    if (found) throw InvalidInput({path.string()}, names[0] + " and " + names[1] + " are both there: remove one");
    found = file;
  }
  if (!found)
    mesh.missing.push_back("no " + holds + " of " + path.filename().string() + " are known: there is no " + names[0] +
                           (names.size() > 1 ? " and no " + names[1] : "") + " beside it");
  return found;
}

/// Its rows must be `rows` in number.
Sidecar read_rows(const fs::path& path, Index rows, const char* items) {
  Sidecar sidecar = read_sidecar(path);
  if (sidecar.rows != rows)
    throw InvalidInput({path.string()},
                       "has " + std::to_string(sidecar.rows) + " rows for " + std::to_string(rows) + " " + items);
  return sidecar;
}

void add_chambers(const fs::path& path, Mesh& mesh) {
  Sidecar sidecar = read_rows(path, mesh.tetrahedra.size(), "tets");
  for (std::size_t i = 0; i < sidecar.columns.size(); ++i) {
    if (sidecar.columns[i].empty()) continue;
    Region region;
    region.name = sidecar.bare ? "chamber" : "chamber" + std::to_string(i + 1);
    region.tetrahedra = std::move(sidecar.columns[i]);
    mesh.regions.push_back(std::move(region));
  }
}

void add_handle_and_rigid(const fs::path& path, Mesh& mesh) {
  Sidecar sidecar = read_rows(path, mesh.vertices.rows(), "vertices");
  if (sidecar.bare || sidecar.columns.size() != 2)
    throw InvalidInput({path.string(), 1}, "rows must be id:handle:rigid:");
  const char* const names[2] = {"handle", "rigid"};
  for (std::size_t i = 0; i < 2; ++i) {
    if (sidecar.columns[i].empty()) continue;
    Region region;
    region.name = names[i];
    region.dimension = 0;
    region.vertices = std::move(sidecar.columns[i]);
    mesh.regions.push_back(std::move(region));
  }
}

}  // namespace

Sidecar read_sidecar(const fs::path& path) {
  Scanner scanner(path);
  Sidecar sidecar;
  std::int64_t first = 0;
  while (!scanner.at_end()) {
    const std::string_view row = trimmed(scanner.line());
    const bool bare = row.find(':') == std::string_view::npos;
    if (sidecar.rows == 0) sidecar.bare = bare;
    if (bare != sidecar.bare) scanner.fail("rows with and without ':' are mixed");
    const std::vector<std::string_view> cells = split_row(row);
    if (!bare) check_id(scanner, cells[0], sidecar.rows, first);
    if (!bare && cells.size() < 2) scanner.fail("row has no column after its number");
    read_flags(scanner, cells, bare ? 0 : 1, sidecar);
    ++sidecar.rows;
  }
  if (sidecar.rows == 0) scanner.fail("has no rows");
  return sidecar;
}

Mesh read_tet(const fs::path& path) {
  Scanner scanner(path);
  Mesh mesh;
  const Index vertices = read_count(scanner, "vertices", 1, 6);
  on_line(scanner, "vertices").expect("vertices");
  scanner.end_line();
  const Index tetrahedra = read_count(scanner, "tets", 1, 10);
  on_line(scanner, "tets").expect("tets");
  scanner.end_line();
  mesh.vertices.resize(vertices, 3);
  for (Index i = 0; i < vertices; ++i) {
    mesh.vertices(i, 0) = scanner.real("coordinate");
    for (int axis = 1; axis < 3; ++axis) mesh.vertices(i, axis) = on_line(scanner, "coordinate").real("coordinate");
    scanner.end_line();
  }
  mesh.tetrahedra.resize(tetrahedra);
  for (Tetrahedron& element : mesh.tetrahedra) {
    if (read_label(scanner, "number of vertices") != 4) scanner.fail("an element must have 4 vertices");
    for (Index& vertex : element)
      vertex = read_index(on_line(scanner, "vertex number"), "vertex number", 0, vertices - 1);
    scanner.end_line();
  }
  expect_end(scanner);
  if (const auto file = find_sidecar(path, "_chamber.txt", "chambers", mesh)) add_chambers(*file, mesh);
  if (const auto file = find_sidecar(path, "_rigid_handle.txt", "handle and rigid part", mesh))
    add_handle_and_rigid(*file, mesh);
  mesh.no_sidecars = mesh.missing.size() == 2;
  return mesh;
}

}  // namespace softkin
