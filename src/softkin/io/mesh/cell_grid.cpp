#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <softkin/io/mesh/cell_grid.hpp>
#include <softkin/model/mesh/element_order.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin {

namespace {

constexpr std::size_t kMostValues = 1000;

struct CellKind {
  int type;  // of VTK
  int dimension;
  std::size_t vertices;
  const char* name;
};

constexpr CellKind kVertex{1, 0, 1, "vertex"};
constexpr CellKind kLine{3, 1, 2, "line"};
constexpr CellKind kTriangle{5, 2, 3, "triangle"};
constexpr CellKind kQuad{9, 2, 4, "quad"};
constexpr CellKind kTetrahedron{10, 3, 4, "tetrahedron"};
constexpr CellKind kWedge{13, 3, 6, "wedge"};
constexpr CellKind kQuadraticLine{21, 1, 3, "second-order line"};
constexpr CellKind kQuadraticTriangle{22, 2, 6, "second-order triangle"};
constexpr CellKind kQuadraticTetrahedron{24, 3, 10, "second-order tetrahedron"};
constexpr std::array kKinds{
    kVertex, kLine, kTriangle, kQuad, kTetrahedron, kWedge, kQuadraticLine, kQuadraticTriangle, kQuadraticTetrahedron};

const CellKind* kind_of(std::int64_t type) {
  const auto found = std::find_if(kKinds.begin(), kKinds.end(), [&](const CellKind& k) { return k.type == type; });
  return found == kKinds.end() ? nullptr : &*found;
}

std::string refused_name(std::int64_t type) {
  static const std::map<std::int64_t, const char*> names{{0, "empty cell"},
                                                         {2, "poly-vertex"},
                                                         {4, "poly-line"},
                                                         {6, "triangle strip"},
                                                         {7, "polygon"},
                                                         {8, "pixel"},
                                                         {11, "voxel"},
                                                         {12, "hexahedron"},
                                                         {14, "pyramid"},
                                                         {15, "pentagonal prism"},
                                                         {16, "hexagonal prism"},
                                                         {23, "second-order quad"},
                                                         {25, "second-order hexahedron"},
                                                         {26, "second-order wedge"},
                                                         {27, "second-order pyramid"},
                                                         {28, "biquadratic quad"},
                                                         {29, "triquadratic hexahedron"},
                                                         {32, "biquadratic wedge"},
                                                         {34, "biquadratic triangle"},
                                                         {41, "convex point set"},
                                                         {42, "polyhedron"},
                                                         {69, "Lagrange triangle"},
                                                         {71, "Lagrange tetrahedron"},
                                                         {72, "Lagrange hexahedron"},
                                                         {73, "Lagrange wedge"}};
  const auto found = names.find(type);
  return found == names.end() ? "cell of a type that softkin does not know" : found->second;
}

/// Turns a grid into a mesh: places every cell in the mesh's arrays, then collects the regions.
class MeshBuilder {
 public:
  explicit MeshBuilder(const CellGrid& grid) : grid_(grid), place_(grid.types.size(), -1) {}

  Mesh build(const Origin& origin) {
    select_labels();
    mesh_.vertices = grid_.points;
    for (std::size_t cell = 0; cell < grid_.types.size(); ++cell) place(cell);
    if (mesh_.tetrahedra.empty() && mesh_.prisms.empty())
      throw InvalidInput(origin, "holds no tetrahedron and no wedge, so no volume");
    const std::string refusal =
        refusal_of_orders(mesh_.tetrahedra.size(), mesh_.edge_nodes.size(), mesh_.prisms.size());
    if (!refusal.empty()) throw InvalidInput(origin, refusal);
    for (const CellLabels* labels : labels_) add_regions(*labels);
    return std::move(mesh_);
  }

 private:
  void select_labels();
  [[nodiscard]] bool is_named(std::size_t cell) const;
  void place(std::size_t cell);
  void add_regions(const CellLabels& labels);
  void add_cell(Region& region, std::size_t cell) const;
  [[nodiscard]] int dimension_of(std::size_t cell) const { return kind_of(grid_.types[cell])->dimension; }

  template <std::size_t N>
  Index append(std::vector<std::array<Index, N>>& cells, const Index* vertices) {
    std::array<Index, N> cell;
    std::copy_n(vertices, N, cell.begin());
    cells.push_back(cell);
    return static_cast<Index>(cells.size() - 1);
  }

  const CellGrid& grid_;
  std::vector<const CellLabels*> labels_;  // those that become regions
  std::vector<Index> place_;               // of a cell in the mesh's array of its kind
  std::set<std::string> names_;
  Mesh mesh_;
};

bool is_nameless(const CellLabels& labels, std::int64_t value) {
  return labels.names && value == -1;
}

void check_names(const CellLabels& labels) {
  const std::int64_t count = static_cast<std::int64_t>(labels.names->size());
  for (const std::int64_t value : labels.values)
    if (value < -1 || value >= count)
      throw InvalidInput(labels.origin, "array '" + labels.name + "' has the value " + std::to_string(value) +
                                            ", outside the " + std::to_string(count) + " names of regions");
}

bool has_few_values(const CellLabels& labels) {
  std::set<std::int64_t> values;
  for (const std::int64_t value : labels.values) {
    values.insert(value);
    if (values.size() > kMostValues) return false;
  }
  return true;
}

void MeshBuilder::select_labels() {
  for (const CellLabels& labels : grid_.labels) {
    if (labels.names) check_names(labels);
    if (labels.names || has_few_values(labels)) labels_.push_back(&labels);
  }
}

bool MeshBuilder::is_named(std::size_t cell) const {
  return std::any_of(labels_.begin(), labels_.end(),
                     [&](const CellLabels* labels) { return !is_nameless(*labels, labels->values[cell]); });
}

void MeshBuilder::place(std::size_t cell) {
  const Index* vertices = grid_.connectivity.data() + grid_.starts[cell];
  switch (grid_.types[cell]) {
    case kQuadraticTetrahedron.type:  // edges in softkin's order
      append(mesh_.edge_nodes, vertices + 4);
      [[fallthrough]];
    case kTetrahedron.type:
      place_[cell] = append(mesh_.tetrahedra, vertices);
      break;
    case kWedge.type:
      place_[cell] = append(mesh_.prisms, vertices);
      break;
    case kTriangle.type:
    case kQuadraticTriangle.type:
      if (is_named(cell)) place_[cell] = append(mesh_.triangles, vertices);
      break;
    case kQuad.type:
      if (is_named(cell)) place_[cell] = append(mesh_.quads, vertices);
      break;
    default:  // lines and vertices live in regions only
      break;
  }
}

void MeshBuilder::add_cell(Region& region, std::size_t cell) const {
  switch (grid_.types[cell]) {
    case kTetrahedron.type:
    case kQuadraticTetrahedron.type:
      region.tetrahedra.push_back(place_[cell]);
      break;
    case kWedge.type:
      region.prisms.push_back(place_[cell]);
      break;
    case kTriangle.type:
    case kQuadraticTriangle.type:
      region.triangles.push_back(place_[cell]);
      break;
    case kQuad.type:
      region.quads.push_back(place_[cell]);
      break;
    default:
      region.vertices.insert(region.vertices.end(), grid_.connectivity.begin() + grid_.starts[cell],
                             grid_.connectivity.begin() + grid_.starts[cell + 1]);
  }
}

void MeshBuilder::add_regions(const CellLabels& labels) {
  std::map<std::int64_t, std::map<int, Region, std::greater<>>> by_value;
  for (std::size_t cell = 0; cell < grid_.types.size(); ++cell)
    if (!is_nameless(labels, labels.values[cell])) add_cell(by_value[labels.values[cell]][dimension_of(cell)], cell);
  for (auto& [value, by_dimension] : by_value) {
    const std::string name =
        labels.names ? (*labels.names)[static_cast<std::size_t>(value)] : labels.name + "_" + std::to_string(value);
    const int highest = by_dimension.begin()->first;
    for (auto& [dimension, region] : by_dimension) {
      region.dimension = dimension;
      region.name = dimension == highest ? name : name + "_" + std::to_string(dimension) + "d";
      std::sort(region.vertices.begin(), region.vertices.end());
      region.vertices.erase(std::unique(region.vertices.begin(), region.vertices.end()), region.vertices.end());
      if (!names_.insert(region.name).second)
        throw InvalidInput(labels.origin, "array '" + labels.name + "' makes a second region '" + region.name + "'");
      mesh_.regions.push_back(std::move(region));
    }
  }
}

}  // namespace

std::string cell_refusal(std::size_t cell, std::int64_t type, std::size_t vertices) {
  const CellKind* kind = kind_of(type);
  const std::string subject = "cell " + std::to_string(cell) + " ";
  if (kind == nullptr)
    return subject + "is a " + refused_name(type) + " (VTK type " + std::to_string(type) +
           "); softkin takes tetrahedra (10, 24) and linear wedges (13)";
  if (vertices != kind->vertices)
    return subject + "has " + std::to_string(vertices) + " vertices, but a " + kind->name + " has " +
           std::to_string(kind->vertices);
  return "";
}

Mesh mesh_of(const CellGrid& grid, const Origin& origin) {
  return MeshBuilder(grid).build(origin);
}

}  // namespace softkin
