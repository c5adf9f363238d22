#include <softkin/io/mesh/gmsh_builder.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/mesh_review.hpp>

namespace softkin::gmsh {

namespace {

template <std::size_t N>
std::array<Index, N> to_array(std::span<const Index> vertices) {
  std::array<Index, N> cell;
  std::copy_n(vertices.begin(), N, cell.begin());
  return cell;
}

/// Index of the cell of the first N vertices, new or known.
template <std::size_t N>
Index add_cell(CellStore<N>& store, std::span<const Index> vertices, std::span<Region* const> groups,
               std::vector<Index> Region::*list) {
  const Index cell = store.add(to_array<N>(vertices));
  for (Region* group : groups) (group->*list).push_back(cell);
  return cell;
}

}  // namespace

void Builder::begin_nodes(std::size_t count) {
  positions_.resize(count, 3);
  numbers_ = NodeNumbers(count);
}

void Builder::number_node(std::int64_t number) {
  if (!numbers_.insert(number, node_count_)) in_.fail("two nodes have the number " + std::to_string(number));
  ++node_count_;
}

Index Builder::vertex(std::int64_t element, std::int64_t number) const {
  const Index row = numbers_.find(number);
  if (row < 0)
    in_.fail("element " + std::to_string(element) + " names node " + std::to_string(number) + ", which does not exist");
  return row;
}

Region& Builder::group(int dimension, int tag) {
  const auto [place, is_new] = groups_.try_emplace({dimension, tag});
  if (is_new) place->second.dimension = dimension;
  return place->second;
}

void Builder::add_element(CellType type, std::span<const Index> vertices, std::span<Region* const> groups) {
  switch (type) {
    case CellType::tetrahedron:
    case CellType::quadratic_tetrahedron:
    case CellType::prism:
      return add_volume(type, vertices, groups);
    case CellType::triangle:
    case CellType::quadratic_triangle:
      if (!groups.empty())
        add_cell(triangles_, vertices, groups, &Region::triangles);
      else
        loose_.push_back(to_array<3>(vertices));
      return;
    case CellType::quad:
      if (!groups.empty()) add_cell(quads_, vertices, groups, &Region::quads);
      return;
    case CellType::line:
    case CellType::quadratic_line:
    case CellType::point:
      for (Region* group : groups) group->vertices.insert(group->vertices.end(), vertices.begin(), vertices.end());
  }
}

void Builder::add_volume(CellType type, std::span<const Index> vertices, std::span<Region* const> groups) {
  has_linear_ = has_linear_ || type == CellType::tetrahedron;
  has_quadratic_ = has_quadratic_ || type == CellType::quadratic_tetrahedron;
  const std::size_t prisms = prisms_.size() + (type == CellType::prism ? 1 : 0);
  const std::string refusal =
      refusal_of_orders((has_linear_ ? 1 : 0) + (has_quadratic_ ? 1 : 0), has_quadratic_ ? 1 : 0, prisms);
  if (!refusal.empty()) in_.fail(refusal);
  if (type == CellType::prism)
    add_cell(prisms_, vertices, groups, &Region::prisms);
  else
    add_tetrahedron(type, vertices, groups);
}

void Builder::add_tetrahedron(CellType type, std::span<const Index> vertices, std::span<Region* const> groups) {
  const std::size_t place = add_cell(tetrahedra_, vertices, groups, &Region::tetrahedra);
  if (type == CellType::tetrahedron) return;
  EdgeNodes nodes = reordered(to_array<6>(vertices.subspan(4)));
  if (place == edge_nodes_.size()) edge_nodes_.push_back(nodes);
  EdgeNodes known = edge_nodes_[place];
  std::sort(known.begin(), known.end());
  std::sort(nodes.begin(), nodes.end());
  if (nodes != known) in_.fail("two tetrahedra have the same corners but different edge nodes");
}

void Builder::name_group(int dimension, int tag, const std::string& name) {
  const Key key{dimension, tag};
  const auto [known, is_new] = names_.try_emplace(key, name);
  if (!is_new)
    in_.fail("physical group " + std::to_string(tag) + " of dimension " + std::to_string(dimension) +
             " has a name already: '" + known->second + "'");
  if (!used_names_.emplace(dimension, name).second)
    in_.fail("two physical groups of dimension " + std::to_string(dimension) + " have the name '" + name + "'");
  named_.push_back(key);
}

void Builder::move_to_regions(const Key& key, const std::string& name) {
  Region& region = regions_.emplace_back(std::move(group(key.first, key.second)));
  region.name = name;
  groups_.erase(key);
}

void Builder::make_regions() {
  std::map<std::string, int> highest;
  for (const auto& [dimension, name] : used_names_) highest[name] = std::max(highest[name], dimension);
  for (const Key& key : named_) {
    const std::string& name = names_[key];
    move_to_regions(key, key.first == highest[name] ? name : name + "_" + std::to_string(key.first) + "d");
  }
  while (!groups_.empty()) {
    const Key key = groups_.begin()->first;
    move_to_regions(key, "physical_" + std::to_string(key.first) + "_" + std::to_string(key.second));
  }
  std::set<std::string> seen;
  for (const Region& region : regions_)
    if (!seen.insert(region.name).second)
      in_.fail_file("two physical groups would become regions named '" + region.name + "'");
}

Mesh Builder::take() {
  if (tetrahedra_.size() + prisms_.size() == 0) {
    for (const Triangle& triangle : loose_) (void)triangles_.add(triangle);
    if (triangles_.size() == 0) in_.fail_file(missing_volume({}));
  }
  make_regions();
  for (Region& region : regions_)
    for (auto* list : {&region.tetrahedra, &region.prisms, &region.triangles, &region.quads, &region.vertices})
      sort_unique(*list);
  Mesh mesh;
  mesh.vertices = std::move(positions_);
  mesh.tetrahedra = tetrahedra_.take();
  mesh.edge_nodes = std::move(edge_nodes_);
  mesh.prisms = prisms_.take();
  mesh.triangles = triangles_.take();
  mesh.quads = quads_.take();
  mesh.regions = std::move(regions_);
  return mesh;
}

}  // namespace softkin::gmsh
