#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <softkin/io/mesh/vtk_grid.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/mesh_review.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr std::size_t kMaxValues = 1000;

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

constexpr std::pair<int, const char*> kRefusedNames[] = {{0, "empty cell"},
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

std::string refused_name(std::int64_t type) {
  for (const auto& [known, name] : kRefusedNames)
    if (known == type) return name;
  return "cell of a type that softkin does not know";
}

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
    if (values.size() > kMaxValues) return false;
  }
  return true;
}

/// Turns a grid into a mesh: places every cell in the mesh's arrays, then collects the regions.
class GridMeshBuilder {
 public:
  explicit GridMeshBuilder(const CellGrid& grid) : grid_(grid), place_(grid.types.size(), -1) {}

  Mesh build(const Origin& origin) {
    select_labels();
    surface_ = true;
    for (std::size_t cell = 0; cell < grid_.types.size(); ++cell) surface_ = surface_ && dimension_of(cell) < 3;
    mesh_.vertices = grid_.points;
    for (std::size_t cell = 0; cell < grid_.types.size(); ++cell) place(cell);
    if (mesh_.tetrahedra.empty() && mesh_.prisms.empty() && mesh_.triangles.empty())
      throw InvalidInput(origin, missing_volume(mesh_));
    const std::string refusal = refusal_of_orders(mesh_);
    if (!refusal.empty()) throw InvalidInput(origin, refusal);
    for (const CellLabels* labels : labels_) add_regions(*labels);
    return std::move(mesh_);
  }

 private:
  void select_labels() {
    for (const CellLabels& labels : grid_.labels) {
      if (labels.names) check_names(labels);
      if (labels.names || has_few_values(labels)) labels_.push_back(&labels);
    }
  }

  [[nodiscard]] bool is_named(std::size_t cell) const {
    return std::any_of(labels_.begin(), labels_.end(),
                       [&](const CellLabels* labels) { return !is_nameless(*labels, labels->values[cell]); });
  }

  /// Calls visit with the mesh's array for cells of this type and a region's; lines and vertices have none.
  template <class Visit>
  void visit_array(int type, const Visit& visit) {
    switch (type) {
      case kTetrahedron.type:
      case kQuadraticTetrahedron.type:
        return visit(mesh_.tetrahedra, &Region::tetrahedra);
      case kWedge.type:
        return visit(mesh_.prisms, &Region::prisms);
      case kTriangle.type:
      case kQuadraticTriangle.type:
        return visit(mesh_.triangles, &Region::triangles);
      case kQuad.type:
        return visit(mesh_.quads, &Region::quads);
    }
  }

  void place(std::size_t cell) {
    const Index* vertices = grid_.connectivity.data() + grid_.starts[cell];
    if (grid_.types[cell] == kQuadraticTetrahedron.type) append(mesh_.edge_nodes, vertices + 4);  // in softkin's order
    if (dimension_of(cell) == 3 || is_named(cell) || (surface_ && dimension_of(cell) == 2))
      visit_array(grid_.types[cell], [&](auto& cells, auto) { place_[cell] = append(cells, vertices); });
  }

  void add_regions(const CellLabels& labels) {
    std::map<std::int64_t, std::map<int, Region, std::greater<>>> by_value;
    for (std::size_t cell = 0; cell < grid_.types.size(); ++cell)
      if (!is_nameless(labels, labels.values[cell])) add_cell(by_value[labels.values[cell]][dimension_of(cell)], cell);
    for (auto& [value, by_dimension] : by_value) {
      const std::string name = labels.names ? (*labels.names)[value] : labels.name + "_" + std::to_string(value);
      const int highest = by_dimension.begin()->first;
      for (auto& [dimension, region] : by_dimension) {
        region.dimension = dimension;
        region.name = dimension == highest ? name : name + "_" + std::to_string(dimension) + "d";
        sort_unique(region.vertices);
        if (!names_.insert(region.name).second)
          throw InvalidInput(labels.origin, "array '" + labels.name + "' makes a second region '" + region.name + "'");
        mesh_.regions.push_back(std::move(region));
      }
    }
  }

  void add_cell(Region& region, std::size_t cell) {
    if (dimension_of(cell) < 2)
      region.vertices.insert(region.vertices.end(), grid_.connectivity.begin() + grid_.starts[cell],
                             grid_.connectivity.begin() + grid_.starts[cell + 1]);
    else
      visit_array(grid_.types[cell], [&](auto&, auto list) { (region.*list).push_back(place_[cell]); });
  }

  [[nodiscard]] int dimension_of(std::size_t cell) const { return kind_of(grid_.types[cell])->dimension; }

  template <std::size_t N>
  Index append(std::vector<std::array<Index, N>>& cells, const Index* vertices) {
    std::array<Index, N> cell;
    std::copy_n(vertices, N, cell.begin());
    cells.push_back(cell);
    return cells.size() - 1;
  }

  const CellGrid& grid_;
  std::vector<const CellLabels*> labels_;  // those that become regions
  std::vector<Index> place_;               // of a cell in the mesh's array of its kind
  std::set<std::string> names_;
  bool surface_ = false;  // is there no volume: cells of no region count, too
  Mesh mesh_;
};

}  // namespace

std::size_t size_of(NumberType type) {
  switch (type) {
    case NumberType::int8:
    case NumberType::uint8:
      return 1;
    case NumberType::int16:
    case NumberType::uint16:
      return 2;
    case NumberType::int32:
    case NumberType::uint32:
    case NumberType::float32:
      return 4;
    default:
      return 8;
  }
}

bool is_integer(NumberType type) {
  return type != NumberType::float32 && type != NumberType::float64;
}

template <class T>
double NumberReader::next_real(const char* what) {
  if (!binary_) return scanner_.real(what);
  const double value = scanner_.binary<T>(what, swap_);
  if (!std::isfinite(value)) scanner_.fail(std::string(what) + " must be a finite number");
  return value;
}

template <class T>
std::int64_t NumberReader::next_integer(const char* what) {
  constexpr std::int64_t high = std::numeric_limits<std::int64_t>::max();
  constexpr bool wide = std::cmp_greater(std::numeric_limits<T>::max(), high);
  if (!binary_)
    return scanner_.integer(what, static_cast<std::int64_t>(std::numeric_limits<T>::min()),
                            wide ? high : static_cast<std::int64_t>(std::numeric_limits<T>::max()));
  const T value = scanner_.binary<T>(what, swap_);
  if (std::cmp_greater(value, high))
    scanner_.fail(std::string(what) + " is " + std::to_string(value) + ", which does not fit 64 bits with sign");
  return static_cast<std::int64_t>(value);
}

double NumberReader::real(NumberType type, const char* what) {
  if (type == NumberType::float32) return next_real<float>(what);
  if (type == NumberType::float64) return next_real<double>(what);
  return static_cast<double>(integer(type, what));
}

std::int64_t NumberReader::integer(NumberType type, const char* what) {
  switch (type) {
    case NumberType::int8:
      return next_integer<std::int8_t>(what);
    case NumberType::uint8:
      return next_integer<std::uint8_t>(what);
    case NumberType::int16:
      return next_integer<std::int16_t>(what);
    case NumberType::uint16:
      return next_integer<std::uint16_t>(what);
    case NumberType::int32:
      return next_integer<std::int32_t>(what);
    case NumberType::uint32:
      return next_integer<std::uint32_t>(what);
    case NumberType::int64:
      return next_integer<std::int64_t>(what);
    case NumberType::uint64:
      return next_integer<std::uint64_t>(what);
    default:
      scanner_.fail(std::string(what) + " must be of an integer type");
  }
}

void NumberReader::require(std::uint64_t count, NumberType type, const char* what) const {
  const std::size_t digit_and_blank = 2;
  scanner_.require(count, binary_ ? size_of(type) : digit_and_blank, what);
}

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
  return GridMeshBuilder(grid).build(origin);
}

}  // namespace softkin
