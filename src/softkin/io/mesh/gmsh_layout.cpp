#include <map>
#include <softkin/io/mesh/gmsh_write.hpp>
#include <utility>

namespace softkin::gmsh {

namespace {

/// Numbers the distinct sets of regions that cells are in; set 0 is empty.
class RegionSets {
 public:
  /// The set with one more region.
  int extended(int set, int region) {
    const auto [place, is_new] = extensions_.try_emplace({set, region}, static_cast<int>(sets_.size()));
    if (is_new) {
      std::vector<int> more = sets_[static_cast<std::size_t>(set)];
      more.push_back(region);
      sets_.push_back(std::move(more));
    }
    return place->second;
  }
  [[nodiscard]] const std::vector<int>& regions(int set) const { return sets_[static_cast<std::size_t>(set)]; }

 private:
  std::vector<std::vector<int>> sets_ = {{}};
  std::map<std::pair<int, int>, int> extensions_;
};

class Planner {
 public:
  explicit Planner(const Mesh& mesh) : mesh_(mesh) { layout_.quadratic_triangles = quadratic_triangles(mesh); }

  Layout plan() {
    plan_points();
    plan_cells(layout_.quadratic_triangles.empty() ? CellType::triangle : CellType::quadratic_triangle, mesh_.triangles,
               &Region::triangles);
    plan_cells(CellType::quad, mesh_.quads, &Region::quads);
    plan_cells(mesh_.edge_nodes.empty() ? CellType::tetrahedron : CellType::quadratic_tetrahedron, mesh_.tetrahedra,
               &Region::tetrahedra);
    plan_cells(CellType::prism, mesh_.prisms, &Region::prisms);
    return std::move(layout_);
  }

 private:
  // The set of each cell; physical tags are places in mesh.regions from 1.
  std::vector<int> sets_of(std::size_t cells, std::vector<Index> Region::*list) {
    std::vector<int> sets(cells, 0);
    for (std::size_t r = 0; r < mesh_.regions.size(); ++r)
      for (const Index cell : mesh_.regions[r].*list) {
        int& set = sets[static_cast<std::size_t>(cell)];
        set = sets_.extended(set, static_cast<int>(r) + 1);
      }
    return sets;
  }

  void plan_points() {
    std::vector<Entity>& entities = layout_.entities[0];
    const std::vector<int> sets = sets_of(static_cast<std::size_t>(mesh_.vertices.rows()), &Region::vertices);
    for (std::size_t v = 0; v < sets.size(); ++v) {
      if (sets[v] == 0) continue;
      const Vec3 position = mesh_.vertices.row(static_cast<Eigen::Index>(v)).transpose();
      entities.push_back({sets_.regions(sets[v]), Eigen::AlignedBox3d(position)});
      layout_.blocks.push_back({CellType::point, static_cast<int>(entities.size()), static_cast<Index>(v), 1});
    }
  }

  int entity_of(int dimension, int set) {
    std::vector<Entity>& entities = layout_.entities[static_cast<std::size_t>(dimension)];
    const auto [place, is_new] = tags_.try_emplace({dimension, set}, static_cast<int>(entities.size()) + 1);
    // Gmsh's number for none: where some cells have a group, meshio asks for one of all
    if (is_new) entities.push_back({set == 0 && !mesh_.regions.empty() ? std::vector{0} : sets_.regions(set), {}});
    return place->second;
  }

  template <std::size_t N>
  void plan_cells(CellType type, const std::vector<std::array<Index, N>>& cells, std::vector<Index> Region::*list) {
    const int dimension = shape_of(type).dimension;
    const std::vector<int> sets = sets_of(cells.size(), list);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const int entity = entity_of(dimension, sets[c]);
      Eigen::AlignedBox3d& box =
          layout_.entities[static_cast<std::size_t>(dimension)][static_cast<std::size_t>(entity) - 1].box;
      for (const Index v : cells[c]) box.extend(Vec3(mesh_.vertices.row(v).transpose()));
      if (layout_.blocks.empty() || layout_.blocks.back().type != type || layout_.blocks.back().entity != entity)
        layout_.blocks.push_back({type, entity, static_cast<Index>(c), 0});
      ++layout_.blocks.back().count;
    }
  }

  const Mesh& mesh_;
  Layout layout_;
  RegionSets sets_;
  std::map<std::pair<int, int>, int> tags_;  // of an entity by dimension and set
};

}  // namespace

Layout lay_out(const Mesh& mesh) {
  return Planner(mesh).plan();
}

}  // namespace softkin::gmsh
