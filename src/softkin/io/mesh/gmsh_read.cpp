#include <set>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/gmsh.hpp>
#include <softkin/io/mesh/gmsh_read.hpp>

namespace softkin {

namespace gmsh {

void number_node(const Source& in, Builder& builder, std::int64_t number) {
  if (!builder.number_node(number)) in.fail("two nodes have the number " + std::to_string(number));
}

void place_node(Source& in, Builder& builder, Index row) {
  const double x = in.real("x of a node"), y = in.real("y of a node"), z = in.real("z of a node");
  builder.place_node(row, {x, y, z});
}

CellType known_type(const Source& in, std::int64_t type) {
  const std::string refusal = refusal_of_type(type);
  if (!refusal.empty()) in.fail(refusal);
  return static_cast<CellType>(type);
}

void add_element(const Source& in, Builder& builder, CellType type, std::span<const Index> vertices,
                 std::span<Region* const> groups) {
  const std::string failure = builder.add_element(type, vertices, groups);
  if (!failure.empty()) in.fail(failure);
}

Index vertex(const Source& in, const Builder& builder, std::int64_t element, std::int64_t number) {
  const Index row = builder.find_node(number);
  if (row < 0)
    in.fail("element " + std::to_string(element) + " names node " + std::to_string(number) + ", which does not exist");
  return row;
}

namespace {

class Reader {
 public:
  Reader(const std::string& file, std::string_view content) : in_(file, content) {}

  Mesh read() {
    for (std::string name = in_.open_section(); !name.empty(); name = in_.open_section()) read_section(name);
    if (!seen_.contains("Nodes")) in_.fail_file("has no section $Nodes");
    if (!seen_.contains("Elements")) in_.fail_file("has no section $Elements");
    if (!builder_.has_volume_elements())
      in_.fail_file("holds no volume elements: mesh in three dimensions, with tetrahedra or prisms");
    const std::string failure = builder_.make_regions();
    if (!failure.empty()) in_.fail_file(failure);
    return builder_.take();
  }

 private:
  void read_section(const std::string& name) {
    refuse(name);
    if (!is_read(name)) return in_.skip_section();
    if (!seen_.insert(name).second) in_.fail_section("the file has a second section $" + name);
    if (name == "PhysicalNames") read_physical_names();
    if (name == "Entities") read_entities();
    if (name == "Nodes") in_.version_4() ? read_nodes_4(in_, builder_) : read_nodes_2(in_, builder_);
    if (name == "Elements") read_elements();
    in_.close_section();
  }

  [[nodiscard]] bool is_read(const std::string& name) const {
    return name == "PhysicalNames" || name == "Nodes" || name == "Elements" || (name == "Entities" && in_.version_4());
  }

  void refuse(const std::string& name) const {
    if (name == "MeshFormat") in_.fail_section("the file has a second section $MeshFormat");
    if (name == "PartitionedEntities")
      in_.fail_section("partitioned meshes are not supported: save without partitions");
    if (name == "ParametricNodes")
      in_.fail_section("parametric nodes are not supported: save without parametric coordinates");
  }

  void read_physical_names() {
    const std::int64_t count = in_.text_count("number of physical names");
    for (std::int64_t i = 0; i < count; ++i) {
      const auto [dimension, tag, name] = in_.physical_name();
      const std::string failure = builder_.name_group(dimension, tag, name);
      if (!failure.empty()) in_.fail(failure);
    }
  }

  void read_entities() {
    if (seen_.contains("Elements")) in_.fail_section("$Entities must stand before $Elements");
    entities_ = read_entities_4(in_);
  }

  void read_elements() {
    if (!seen_.contains("Nodes")) in_.fail_section("$Nodes must stand before $Elements");
    if (in_.version_4())
      read_elements_4(in_, builder_, entities_);
    else
      read_elements_2(in_, builder_);
  }

  Source in_;
  Builder builder_;
  std::set<std::string> seen_;
  std::optional<Entities> entities_;
};

}  // namespace

Mesh read(const std::string& file, std::string_view content) {
  return Reader(file, content).read();
}

}  // namespace gmsh

Mesh read_gmsh(const std::filesystem::path& path) {
  return gmsh::read(path.string(), read_file(path));
}

}  // namespace softkin
