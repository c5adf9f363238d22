#include <Eigen/Geometry>
#include <charconv>
#include <map>
#include <set>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/gmsh_format.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/own_file.hpp>
#include <softkin/model/mesh/mesh_order.hpp>

namespace softkin {

namespace gmsh {

namespace {

constexpr std::size_t kLongestName = 127;  // of the MSH format

/// Refuses a mesh that cannot be written so that it is read back as it is.
class Checker {
 public:
  Checker(std::string file, const Mesh& mesh) : file_(std::move(file)), mesh_(mesh) {}

  void check() const {
    if (!mesh_.vertices.allFinite()) fail("a vertex has a coordinate that is not finite");
    if (mesh_.tetrahedra.empty() && mesh_.prisms.empty() && mesh_.triangles.empty())
      fail("the mesh has no volume elements");
    check_cells(mesh_.tetrahedra, "tetrahedron");
    check_cells(mesh_.edge_nodes, "tetrahedron");
    const std::string refusal = refusal_of_orders(mesh_);
    if (!refusal.empty()) fail(refusal);
    check_cells(mesh_.prisms, "prism");
    check_cells(mesh_.triangles, "triangle");
    check_cells(mesh_.quads, "quad");
    std::set<std::string> names;
    for (const Region& region : mesh_.regions) {
      check_region(region);
      if (!names.insert(region.name).second) fail("two regions have the name '" + region.name + "'");
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InvalidInput({file_}, message); }

  template <std::size_t N>
  void check_cells(const std::vector<std::array<Index, N>>& cells, const char* what) const {
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (const Index v : cells[i])
        if (v < 0 || v >= mesh_.vertices.rows())
          fail(std::string(what) + " " + std::to_string(i) + " has vertex " + std::to_string(v) + " of " +
               std::to_string(mesh_.vertices.rows()));
  }

  void check_region(const Region& region) const {
    if (region.name.empty()) fail("a region has no name");
    if (region.name.size() > kLongestName)
      fail("region name '" + region.name + "' is longer than the 127 bytes of a Gmsh name");
    if (is_unquotable(region.name)) fail("a region name holds '\"' or a control character");
    const int d = region.dimension;
    if (d < 0 || d > 3) fail("region '" + region.name + "' has dimension " + std::to_string(d));
    check_list(region, region.tetrahedra, mesh_.tetrahedra.size(), d == 3, "tetrahedra");
    check_list(region, region.prisms, mesh_.prisms.size(), d == 3, "prisms");
    check_list(region, region.triangles, mesh_.triangles.size(), d == 2, "triangles");
    check_list(region, region.quads, mesh_.quads.size(), d == 2, "quads");
    check_list(region, region.vertices, mesh_.vertices.rows(), d < 2, "vertices");
  }

  void check_list(const Region& region, const std::vector<Index>& list, std::size_t cells, bool fits,
                  const std::string& what) const {
    const std::string who = "region '" + region.name + "' of dimension " + std::to_string(region.dimension);
    if (!list.empty() && !fits) fail(who + " cannot list " + what);
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (list[i] < 0 || static_cast<std::size_t>(list[i]) >= cells)
        fail(who + " lists number " + std::to_string(list[i]) + " of " + std::to_string(cells) + " " + what);
      if (i > 0 && list[i] <= list[i - 1]) fail(who + " must list " + what + " in ascending order, each once");
    }
  }

  std::string file_;
  const Mesh& mesh_;
};

/// A geometric entity of the file: what physical groups hang on. Its tag is its place in the list, from 1.
struct Entity {
  std::vector<int> groups;  // physical tags: places in mesh.regions, from 1; 0: no region
  Eigen::AlignedBox3d box;
};

/// Consecutive cells of one type in one entity, vertex after vertex.
struct Block {
  CellType type;
  int entity;
  std::vector<Index> vertices;

  [[nodiscard]] std::size_t count() const { return vertices.size() / static_cast<std::size_t>(shape_of(type).nodes); }
};

/// One entity per set of regions that cells are in and dimension; points: one per vertex that a region names.
class Layout {
 public:
  explicit Layout(const Mesh& mesh) : mesh_(mesh) {
    plan_points();
    if (const std::vector<QuadraticTriangle> triangles = quadratic_triangles(mesh); !triangles.empty())
      plan_cells(CellType::quadratic_triangle, triangles, &Region::triangles, 3);
    else
      plan_cells(CellType::triangle, mesh.triangles, &Region::triangles);
    plan_cells(CellType::quad, mesh.quads, &Region::quads);
    plan_cells(mesh.edge_nodes.empty() ? CellType::tetrahedron : CellType::quadratic_tetrahedron, mesh.tetrahedra,
               &Region::tetrahedra);
    plan_cells(CellType::prism, mesh.prisms, &Region::prisms);
  }

  std::array<std::vector<Entity>, 4> entities;  // by dimension
  std::vector<Block> blocks;                    // in runs, so that cells keep their order

 private:
  /// The set of regions of each cell; physical tags are places in mesh.regions from 1.
  std::vector<int> sets_of(std::size_t cells, std::vector<Index> Region::*list) {
    std::vector<int> sets(cells, 0);
    for (std::size_t r = 0; r < mesh_.regions.size(); ++r)
      for (const Index cell : mesh_.regions[r].*list) {
        int& set = sets[cell];
        set = extended(set, static_cast<int>(r) + 1);
      }
    return sets;
  }

  /// The set with one more region.
  int extended(int set, int region) {
    const auto [place, is_new] = extensions_.try_emplace({set, region}, static_cast<int>(sets_.size()));
    if (is_new) {
      std::vector<int> more = sets_[set];
      more.push_back(region);
      sets_.push_back(std::move(more));
    }
    return place->second;
  }

  void plan_points() {
    const std::vector<int> sets = sets_of(mesh_.vertices.rows(), &Region::vertices);
    for (std::size_t v = 0; v < sets.size(); ++v) {
      if (sets[v] == 0) continue;
      const Vec3 position = mesh_.vertices.row(v).transpose();
      entities[0].push_back({sets_[sets[v]], Eigen::AlignedBox3d(position)});
      blocks.push_back({CellType::point, static_cast<int>(entities[0].size()), {static_cast<Index>(v)}});
    }
  }

  int entity_of(int dimension, int set) {
    std::vector<Entity>& all = entities[dimension];
    const auto [place, is_new] = tags_.try_emplace({dimension, set}, static_cast<int>(all.size()) + 1);
    // Gmsh's number for none: where some cells have a group, meshio asks for one of all
    const bool none = set == 0 && !mesh_.regions.empty();
    if (is_new) all.push_back({none ? std::vector{0} : sets_[set], {}});
    return place->second;
  }

  /// Cells are placed by their corners.
  template <std::size_t N>
  void plan_cells(CellType type, const std::vector<std::array<Index, N>>& cells, std::vector<Index> Region::*list,
                  std::size_t corners = N) {
    const int dimension = shape_of(type).dimension;
    const std::vector<int> sets = sets_of(cells.size(), list);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const int entity = entity_of(dimension, sets[c]);
      Eigen::AlignedBox3d& box = entities[dimension][entity - 1].box;
      for (std::size_t i = 0; i < corners; ++i) box.extend(Vec3(mesh_.vertices.row(cells[c][i]).transpose()));
      if (blocks.empty() || blocks.back().type != type || blocks.back().entity != entity)
        blocks.push_back({type, entity, {}});
      std::vector<Index>& vertices = blocks.back().vertices;
      vertices.insert(vertices.end(), cells[c].begin(), cells[c].end());
      if (type != CellType::quadratic_tetrahedron) continue;
      const EdgeNodes nodes = reordered(mesh_.edge_nodes[c]);
      vertices.insert(vertices.end(), nodes.begin(), nodes.end());
    }
  }

  const Mesh& mesh_;
  std::vector<std::vector<int>> sets_ = {{}};      // of regions that cells are in; set 0 is empty
  std::map<std::pair<int, int>, int> extensions_;  // of a set by a region
  std::map<std::pair<int, int>, int> tags_;        // of an entity by dimension and set
};

/// Values of a 4.1 file in memory: words, one record a line, or binary in the byte order of this machine.
class Sink {
 public:
  explicit Sink(bool binary) : binary_(binary) {}

  void text(std::string_view text) { content_ += text; }
  void open_section(const std::string& name) { content_ += '$' + name + '\n'; }
  void close_section(const std::string& name) { content_ += (binary_ ? "\n$End" : "$End") + name + '\n'; }
  void int_value(std::int32_t value) { add(value); }
  void size_value(std::uint64_t value) { add(value); }
  void real(double value) { add(value); }
  void end_record() {
    if (!binary_) content_.back() = '\n';
  }
  [[nodiscard]] const std::string& content() const { return content_; }

 private:
  /// In text the shortest form that reads back exactly.
  template <class T>
  void add(T value) {
    if (binary_) {
      content_.append(reinterpret_cast<const char*>(&value), sizeof(T));
      return;
    }
    char buffer[32];
    const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
    content_.append(buffer, result.ptr);
    content_ += ' ';
  }

  std::string content_;
  bool binary_;
};

/// Comments, which the format allows before all else.
void write_mark(Sink& out) {
  out.open_section("Comments");
  out.text(std::string(made_by_softkin) + "\n$EndComments\n");
}

void write_format(Sink& out, bool binary) {
  out.open_section("MeshFormat");
  out.text(binary ? "4.1 1 8\n" : "4.1 0 8\n");
  if (binary) out.int_value(1);
  out.close_section("MeshFormat");
}

void write_names(Sink& out, const std::vector<Region>& regions) {
  if (regions.empty()) return;
  out.open_section("PhysicalNames");
  out.text(std::to_string(regions.size()) + "\n");
  for (std::size_t r = 0; r < regions.size(); ++r) {
    // lines are not kept, only their vertices
    const int dimension = regions[r].dimension == 1 ? 0 : regions[r].dimension;
    out.text(std::to_string(dimension) + " " + std::to_string(r + 1) + " \"" + regions[r].name + "\"\n");
  }
  out.text("$EndPhysicalNames\n");
}

void write_point(Sink& out, const Vec3& point) {
  for (int axis = 0; axis < 3; ++axis) out.real(point[axis]);
}

void write_entities(Sink& out, const Layout& layout) {
  out.open_section("Entities");
  for (const auto& entities : layout.entities) out.size_value(entities.size());
  out.end_record();
  for (std::size_t dimension = 0; dimension < 4; ++dimension) {
    std::int32_t tag = 0;
    for (const Entity& entity : layout.entities[dimension]) {
      out.int_value(++tag);
      write_point(out, entity.box.min());
      if (dimension > 0) write_point(out, entity.box.max());
      out.size_value(entity.groups.size());
      for (const int group : entity.groups) out.int_value(group);
      if (dimension > 0) out.size_value(0);  // bounding entities
      out.end_record();
    }
  }
  out.close_section("Entities");
}

/// What $Nodes and $Elements begin with: number of blocks, of items, and their least and greatest number.
void write_counts(Sink& out, std::uint64_t blocks, std::uint64_t items) {
  for (const std::uint64_t value : {blocks, items, std::uint64_t{1}, items}) out.size_value(value);
  out.end_record();
}

// All in one block, on the first volume: softkin has no geometry that they could lie on.
void write_nodes(Sink& out, const Points& vertices) {
  const auto count = static_cast<std::uint64_t>(vertices.rows());
  out.open_section("Nodes");
  write_counts(out, 1, count);
  for (const std::int32_t value : {3, 1, 0}) out.int_value(value);
  out.size_value(count);
  out.end_record();
  for (std::uint64_t number = 1; number <= count; ++number) {
    out.size_value(number);
    out.end_record();
  }
  for (Eigen::Index row = 0; row < vertices.rows(); ++row) {
    write_point(out, vertices.row(row).transpose());
    out.end_record();
  }
  out.close_section("Nodes");
}

void write_elements(Sink& out, const std::vector<Block>& blocks) {
  std::uint64_t count = 0, number = 0;
  for (const Block& block : blocks) count += block.count();
  out.open_section("Elements");
  write_counts(out, blocks.size(), count);
  for (const Block& block : blocks) {
    const CellShape shape = shape_of(block.type);
    for (const int value : {shape.dimension, block.entity, static_cast<int>(block.type)}) out.int_value(value);
    out.size_value(block.count());
    out.end_record();
    for (auto vertex = block.vertices.begin(); vertex != block.vertices.end();) {
      out.size_value(++number);
      for (int i = 0; i < shape.nodes; ++i) out.size_value(static_cast<std::uint64_t>(*vertex++) + 1);
      out.end_record();
    }
  }
  out.close_section("Elements");
}

}  // namespace

}  // namespace gmsh

void write_gmsh(const std::filesystem::path& path, const Mesh& mesh, bool binary) {
  gmsh::Checker(path.string(), mesh).check();
  const gmsh::Layout layout(mesh);
  gmsh::Sink out(binary);
  gmsh::write_mark(out);
  gmsh::write_format(out, binary);
  gmsh::write_names(out, mesh.regions);
  gmsh::write_entities(out, layout);
  gmsh::write_nodes(out, mesh.vertices);
  gmsh::write_elements(out, layout.blocks);
  write_file(path, out.content());
}

}  // namespace softkin
