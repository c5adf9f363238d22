#include <algorithm>
#include <limits>
#include <map>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/mesh/vtk_grid.hpp>
#include <softkin/io/mesh/vtu_document.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr std::int64_t kMost = std::numeric_limits<Index>::max();

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
    const std::string refusal = cell_refusal(cell, types[cell], offsets[cell] - last);
    if (!refusal.empty()) document.fail(type_array, refusal);
    grid.types.push_back(static_cast<std::uint8_t>(types[cell]));
    grid.starts.push_back(offsets[cell]);
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
    grid.connectivity.push_back(vertex);
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
  read_types(document, cells, count, grid);
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
  const Index count = grid.types.size();
  const std::vector<double> values = document.reals(array, 3 * static_cast<std::uint64_t>(count));
  CellVectors vectors{Points::Zero(count, 3), Eigen::Map<const Points>(values.data(), count, 3)};
  for (Index cell = 0; cell < count; ++cell) {
    const std::size_t begin = grid.starts[cell];
    const std::size_t end = grid.starts[cell + 1];
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
