#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/gmsh.hpp>
#include <softkin/io/mesh/gmsh_write.hpp>

namespace softkin {

namespace gmsh {

namespace {

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

// All in one block, on the first volume: softkin knows no geometry that they could lie on.
void write_nodes(Sink& out, const Points& vertices) {
  const auto count = static_cast<std::uint64_t>(vertices.rows());
  out.open_section("Nodes");
  for (const std::uint64_t value : {std::uint64_t{1}, count, std::uint64_t{1}, count}) out.size_value(value);
  out.end_record();
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

class ElementWriter {
 public:
  ElementWriter(Sink& out, const Mesh& mesh, const Layout& layout) : out_(out), mesh_(mesh), layout_(layout) {}

  void write() {
    std::uint64_t count = 0;
    for (const Block& block : layout_.blocks) count += static_cast<std::uint64_t>(block.count);
    out_.open_section("Elements");
    for (const std::uint64_t value : {std::uint64_t{layout_.blocks.size()}, count, std::uint64_t{1}, count})
      out_.size_value(value);
    out_.end_record();
    for (const Block& block : layout_.blocks) write_block(block);
    out_.close_section("Elements");
  }

 private:
  void write_block(const Block& block) {
    for (const int value : {shape_of(block.type).dimension, block.entity, static_cast<int>(block.type)})
      out_.int_value(value);
    out_.size_value(static_cast<std::uint64_t>(block.count));
    out_.end_record();
    switch (block.type) {
      case CellType::point:
        return write_element(std::array<Index, 1>{block.first});
      case CellType::triangle:
        return write_cells(mesh_.triangles, block);
      case CellType::quadratic_triangle:
        return write_cells(layout_.quadratic_triangles, block);
      case CellType::quad:
        return write_cells(mesh_.quads, block);
      case CellType::tetrahedron:
        return write_cells(mesh_.tetrahedra, block);
      case CellType::quadratic_tetrahedron:
        return write_quadratic_tetrahedra(block);
      case CellType::prism:
        return write_cells(mesh_.prisms, block);
      case CellType::line:
      case CellType::quadratic_line:
        return;  // lay_out makes none
    }
  }

  template <std::size_t N>
  void write_cells(const std::vector<std::array<Index, N>>& cells, const Block& block) {
    for (Index i = 0; i < block.count; ++i) write_element(cells[static_cast<std::size_t>(block.first + i)]);
  }

  void write_quadratic_tetrahedra(const Block& block) {
    for (Index i = 0; i < block.count; ++i) {
      const auto place = static_cast<std::size_t>(block.first + i);
      const EdgeNodes edge_nodes = reordered(mesh_.edge_nodes[place]);
      std::array<Index, 10> nodes;
      std::copy(edge_nodes.begin(), edge_nodes.end(),
                std::copy(mesh_.tetrahedra[place].begin(), mesh_.tetrahedra[place].end(), nodes.begin()));
      write_element(nodes);
    }
  }

  template <std::size_t N>
  void write_element(const std::array<Index, N>& vertices) {
    out_.size_value(++number_);
    for (const Index vertex : vertices) out_.size_value(static_cast<std::uint64_t>(vertex) + 1);
    out_.end_record();
  }

  Sink& out_;
  const Mesh& mesh_;
  const Layout& layout_;
  std::uint64_t number_ = 0;
};

}  // namespace

}  // namespace gmsh

void write_gmsh(const std::filesystem::path& path, const Mesh& mesh, bool binary) {
  const std::string problem = gmsh::problem_of(mesh);
  if (!problem.empty()) throw InvalidInput({path.string()}, problem);
  const gmsh::Layout layout = gmsh::lay_out(mesh);
  gmsh::Sink out(binary);
  gmsh::write_format(out, binary);
  gmsh::write_names(out, mesh.regions);
  gmsh::write_entities(out, layout);
  gmsh::write_nodes(out, mesh.vertices);
  gmsh::ElementWriter(out, mesh, layout).write();
  write_file(path, out.content());
}

}  // namespace softkin
