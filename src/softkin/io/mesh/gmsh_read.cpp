#include <optional>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/gmsh_builder.hpp>
#include <softkin/io/mesh/mesh_io.hpp>

namespace softkin {

namespace gmsh {

namespace {

/// Physical tags of the geometric entities of a 4.1 file, by dimension and tag.
using Entities = std::map<std::pair<int, std::int64_t>, std::vector<int>>;

constexpr const char* kElement = "number of an element";
constexpr const char* kNode = "node of an element";
constexpr const char* kDimension = "dimension of an entity";
constexpr const char* kTag = "tag of an entity";

class Reader {
 public:
  Reader(const std::string& file, std::string_view content) : in_(file, content) {}

  Mesh read() {
    for (std::string name = in_.open_section(); !name.empty(); name = in_.open_section()) read_section(name);
    if (!seen_.contains("Nodes")) in_.fail_file("has no section $Nodes");
    if (!seen_.contains("Elements")) in_.fail_file("has no section $Elements");
    return builder_.take();
  }

 private:
  void read_section(const std::string& name) {
    refuse(name);
    if (!is_read(name)) return in_.skip_section();
    if (!seen_.insert(name).second) in_.fail_section("the file has a second section $" + name);
    if (name == "PhysicalNames") read_physical_names();
    if (name == "Entities") read_entities();
    if (name == "Nodes") in_.version_4() ? read_nodes_4() : read_nodes_2();
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
      builder_.name_group(dimension, tag, name);
    }
  }

  void read_elements() {
    if (!seen_.contains("Nodes")) in_.fail_section("$Nodes must stand before $Elements");
    in_.version_4() ? read_elements_4() : read_elements_2();
  }

  void place_node(Index row) {
    const double x = in_.real("x of a node"), y = in_.real("y of a node"), z = in_.real("z of a node");
    builder_.place_node(row, {x, y, z});
  }

  // MSH 2.2

  void read_nodes_2() {
    const std::int64_t count = in_.text_count("number of nodes");
    in_.require(count, 8, 28, "nodes");
    builder_.begin_nodes(count);
    for (std::int64_t i = 0; i < count; ++i) {
      builder_.number_node(in_.int_value("number of a node", 1, kMaxInt));
      place_node(i);
      in_.end_record();
    }
  }

  /// In text every element has a type and a number of tags, in binary those of a block come before it.
  void read_elements_2() {
    const std::int64_t count = in_.text_count("number of elements");
    in_.require(count, 9, 8, "elements");
    for (std::int64_t done = 0; done < count;) {
      std::int64_t element = in_.binary() ? 0 : in_.int_value(kElement, 0, kMaxInt);
      const CellType type = in_.cell_type("type of an element");
      const std::int64_t block = in_.binary() ? in_.int_value("number of elements of one type", 1, count - done) : 1;
      const std::int64_t tags = in_.int_value("number of tags of an element", 0, kMaxInt);
      for (std::int64_t i = 0; i < block; ++i) {
        if (in_.binary()) element = in_.int_value(kElement, 0, kMaxInt);
        read_element(element, type, tags);
      }
      done += block;
    }
  }

  /// Tags and nodes of an element, the rest of its record.
  void read_element(std::int64_t element, CellType type, std::int64_t tags) {
    const auto physical = static_cast<int>(read_tags(tags));
    const CellShape shape = shape_of(type);
    std::array<Index, kMaxNodes> vertices{};
    for (int i = 0; i < shape.nodes; ++i) vertices[i] = builder_.vertex(element, in_.int_value(kNode, 1, kMaxInt));
    in_.end_record();
    const std::span<const Index> nodes(vertices.data(), shape.nodes);
    if (physical == 0) return builder_.add_element(type, nodes, {});
    Region* const groups[] = {&builder_.group(shape.dimension, physical)};
    builder_.add_element(type, nodes, groups);
  }

  /// The physical group among the tags of an element, 0 for none; older files mark orientation by its sign.
  std::int64_t read_tags(std::int64_t count) {
    std::int64_t physical = 0;
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t tag = in_.int_value("tag of an element", -kMaxInt, kMaxInt);
      if (i == 0) physical = tag < 0 ? -tag : tag;
    }
    return physical;
  }

  // MSH 4.1

  void read_entities() {
    if (seen_.contains("Elements")) in_.fail_section("$Entities must stand before $Elements");
    entities_.emplace();
    std::array<std::int64_t, 4> counts{};
    for (std::int64_t& count : counts) count = in_.size_value("number of entities", 0, kMaxSize);
    in_.end_record();
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::int64_t i = 0; i < counts[dimension]; ++i) read_entity(dimension);
  }

  void read_entity(int dimension) {
    const std::int64_t tag = in_.int_value(kTag, -kMaxInt, kMaxInt);
    in_.skip_reals(dimension == 0 ? 3 : 6, "box of an entity");
    std::vector<int> physical = read_physical_tags();
    if (dimension > 0) {
      const std::int64_t bounds = in_.size_value("number of bounding entities", 0, kMaxSize);
      for (std::int64_t i = 0; i < bounds; ++i) (void)in_.int_value("bounding entity", -kMaxInt, kMaxInt);
    }
    in_.end_record();
    if (!entities_->emplace(std::pair(dimension, tag), std::move(physical)).second)
      in_.fail("two entities of dimension " + std::to_string(dimension) + " have the tag " + std::to_string(tag));
  }

  std::vector<int> read_physical_tags() {
    const std::int64_t count = in_.size_value("number of physical tags", 0, kMaxSize);
    in_.require(count, 2, 4, "physical tags");
    std::vector<int> tags;
    tags.reserve(count);
    for (std::int64_t i = 0; i < count; ++i) {
      const auto tag = static_cast<int>(in_.int_value("physical tag", -kMaxInt, kMaxInt));
      // 0 is no group; the sign is the orientation, which regions do not have
      if (tag != 0) tags.push_back(tag < 0 ? -tag : tag);
    }
    return tags;
  }

  void read_nodes_4() {
    begin_blocks("nodes", 8, 32);
    builder_.begin_nodes(left_);
    for (std::int64_t i = 0; i < blocks_; ++i) read_node_block();
    must_be_complete("nodes");
  }

  void read_elements_4() {
    begin_blocks("elements", 4, 16);
    for (std::int64_t i = 0; i < blocks_; ++i) read_element_block();
    must_be_complete("elements");
  }

  /// What $Nodes and $Elements begin with: number of blocks, of items, and their least and greatest number.
  void begin_blocks(const char* items, std::size_t text_bytes, std::size_t binary_bytes) {
    blocks_ = in_.size_value("number of entity blocks", 0, kMaxSize);
    left_ = in_.size_value(("number of " + std::string(items)).c_str(), 0, kMaxIndex);
    in_.require(left_, text_bytes, binary_bytes, items);
    for (const char* bound : {"least number", "greatest number"}) (void)in_.size_value(bound, 0, kMaxSize);
    in_.end_record();
  }

  std::int64_t read_block_size(const char* what) {
    const std::int64_t count = in_.size_value(what, 0, kMaxSize);
    if (count > left_)
      in_.fail(std::string(what) + " is " + std::to_string(count) + ", more than the " + std::to_string(left_) +
               " that are left of those announced");
    in_.end_record();
    left_ -= count;
    return count;
  }

  void must_be_complete(const char* what) const {
    if (left_ > 0)
      in_.fail(std::string("the blocks hold fewer ") + what + " than announced: " + std::to_string(left_) + " missing");
  }

  void read_node_block() {
    const auto dimension = static_cast<int>(in_.int_value(kDimension, 0, 3));
    (void)in_.int_value(kTag, -kMaxInt, kMaxInt);
    const bool parametric = in_.int_value("mark of parametric nodes", 0, 1) == 1;
    const std::int64_t count = read_block_size("number of nodes in the block");
    in_.require(count, 8, 32, "nodes");
    const Index first = builder_.node_count();
    for (std::int64_t i = 0; i < count; ++i) {
      builder_.number_node(in_.size_value("number of a node", 1, kMaxSize));
      in_.end_record();
    }
    for (Index row = first; row < builder_.node_count(); ++row) {
      place_node(row);
      if (parametric) in_.skip_reals(dimension, "parametric coordinate");
      in_.end_record();
    }
  }

  void read_element_block() {
    const auto dimension = static_cast<int>(in_.int_value(kDimension, 0, 3));
    const std::int64_t tag = in_.int_value(kTag, -kMaxInt, kMaxInt);
    const std::vector<Region*> groups = groups_of(dimension, tag);
    const CellType type = in_.cell_type("type of elements");
    const CellShape shape = shape_of(type);
    if (shape.dimension != dimension)
      in_.fail("elements of type " + std::to_string(static_cast<int>(type)) + " in an entity of dimension " +
               std::to_string(dimension));
    const std::int64_t count = read_block_size("number of elements in the block");
    std::array<Index, kMaxNodes> vertices{};
    const std::span<const Index> nodes(vertices.data(), shape.nodes);
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t element = in_.size_value(kElement, 0, kMaxSize);
      for (int k = 0; k < shape.nodes; ++k) vertices[k] = builder_.vertex(element, in_.size_value(kNode, 1, kMaxSize));
      in_.end_record();
      builder_.add_element(type, nodes, groups);
    }
  }

  /// Without $Entities elements are in no group.
  std::vector<Region*> groups_of(int dimension, std::int64_t tag) {
    std::vector<Region*> groups;
    if (!entities_) return groups;
    const auto entity = entities_->find({dimension, tag});
    if (entity == entities_->end())
      in_.fail("elements of entity " + std::to_string(tag) + " of dimension " + std::to_string(dimension) +
               ", which is not in $Entities");
    for (const int physical : entity->second) groups.push_back(&builder_.group(dimension, physical));
    return groups;
  }

  Source in_;
  Builder builder_{in_};
  std::set<std::string> seen_;
  std::optional<Entities> entities_;
  std::int64_t blocks_ = 0, left_ = 0;  // of $Nodes or $Elements; left: items still to come
};

}  // namespace

}  // namespace gmsh

Mesh read_gmsh(const std::string& file, std::string_view content) {
  return gmsh::Reader(file, content).read();
}

Mesh read_gmsh(const std::filesystem::path& path) {
  return read_gmsh(path.string(), read_file(path));
}

}  // namespace softkin
