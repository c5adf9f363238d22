#include <softkin/io/mesh/gmsh_read.hpp>

namespace softkin::gmsh {

namespace {

constexpr const char* kDimension = "dimension of an entity";
constexpr const char* kTag = "tag of an entity";

std::vector<int> read_physical_tags(Source& in) {
  const std::int64_t count = in.size_value("number of physical tags", 0, kMaxSize);
  in.require(count, 2, 4, "physical tags");
  std::vector<int> tags;
  tags.reserve(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    const auto tag = static_cast<int>(in.int_value("physical tag", -kMaxInt, kMaxInt));
    // 0 is no group; the sign is the orientation, which regions do not have
    if (tag != 0) tags.push_back(tag < 0 ? -tag : tag);
  }
  return tags;
}

void read_entity(Source& in, int dimension, Entities& entities) {
  const std::int64_t tag = in.int_value(kTag, -kMaxInt, kMaxInt);
  in.skip_reals(dimension == 0 ? 3 : 6, "box of an entity");
  std::vector<int> physical = read_physical_tags(in);
  if (dimension > 0) {
    const std::int64_t bounds = in.size_value("number of bounding entities", 0, kMaxSize);
    for (std::int64_t i = 0; i < bounds; ++i) (void)in.int_value("bounding entity", -kMaxInt, kMaxInt);
  }
  in.end_record();
  if (!entities.emplace(std::pair(dimension, tag), std::move(physical)).second)
    in.fail("two entities of dimension " + std::to_string(dimension) + " have the tag " + std::to_string(tag));
}

// What $Nodes and $Elements begin with: number of blocks, of items, and their least and greatest number.
struct Header {
  std::int64_t blocks;
  std::int64_t items;
};

Header read_header(Source& in, const char* items, std::size_t text_bytes, std::size_t binary_bytes) {
  Header header{};
  header.blocks = in.size_value("number of entity blocks", 0, kMaxSize);
  header.items = in.size_value(("number of " + std::string(items)).c_str(), 0, kMaxIndex);
  in.require(header.items, text_bytes, binary_bytes, items);
  for (const char* bound : {"least number", "greatest number"}) (void)in.size_value(bound, 0, kMaxSize);
  in.end_record();
  return header;
}

std::int64_t read_block_size(Source& in, const char* what, std::int64_t left) {
  const std::int64_t count = in.size_value(what, 0, kMaxSize);
  if (count > left)
    in.fail(std::string(what) + " is " + std::to_string(count) + ", more than the " + std::to_string(left) +
            " that are left of those announced");
  in.end_record();
  return count;
}

void must_be_complete(const Source& in, const char* what, std::int64_t left) {
  if (left > 0)
    in.fail(std::string("the blocks hold fewer ") + what + " than announced: " + std::to_string(left) + " missing");
}

void read_node_block(Source& in, Builder& builder, std::int64_t& left) {
  const auto dimension = static_cast<int>(in.int_value(kDimension, 0, 3));
  (void)in.int_value(kTag, -kMaxInt, kMaxInt);
  const bool parametric = in.int_value("mark of parametric nodes", 0, 1) == 1;
  const std::int64_t count = read_block_size(in, "number of nodes in the block", left);
  in.require(count, 8, 32, "nodes");
  const Index first = builder.node_count();
  for (std::int64_t i = 0; i < count; ++i) {
    number_node(in, builder, in.size_value("number of a node", 1, kMaxSize));
    in.end_record();
  }
  for (Index row = first; row < builder.node_count(); ++row) {
    place_node(in, builder, row);
    if (parametric) in.skip_reals(dimension, "parametric coordinate");
    in.end_record();
  }
  left -= count;
}

std::vector<Region*> groups_of(const Source& in, Builder& builder, const std::optional<Entities>& entities,
                               int dimension, std::int64_t tag) {
  std::vector<Region*> groups;
  if (!entities) return groups;
  const auto entity = entities->find({dimension, tag});
  if (entity == entities->end())
    in.fail("elements of entity " + std::to_string(tag) + " of dimension " + std::to_string(dimension) +
            ", which is not in $Entities");
  for (const int physical : entity->second) groups.push_back(&builder.group(dimension, physical));
  return groups;
}

void read_element_block(Source& in, Builder& builder, const std::optional<Entities>& entities, std::int64_t& left) {
  const auto dimension = static_cast<int>(in.int_value(kDimension, 0, 3));
  const std::int64_t tag = in.int_value(kTag, -kMaxInt, kMaxInt);
  const std::vector<Region*> groups = groups_of(in, builder, entities, dimension, tag);
  const std::int64_t number = in.int_value("type of elements", -kMaxInt, kMaxInt);
  const CellType type = known_type(in, number);
  const CellShape shape = shape_of(type);
  if (shape.dimension != dimension)
    in.fail("elements of type " + std::to_string(number) + " in an entity of dimension " + std::to_string(dimension));
  const std::int64_t count = read_block_size(in, "number of elements in the block", left);
  std::array<Index, kMostNodes> vertices{};
  const std::span<const Index> nodes(vertices.data(), static_cast<std::size_t>(shape.nodes));
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t element = in.size_value("number of an element", 0, kMaxSize);
    for (int k = 0; k < shape.nodes; ++k)
      vertices[static_cast<std::size_t>(k)] =
          vertex(in, builder, element, in.size_value("node of an element", 1, kMaxSize));
    in.end_record();
    add_element(in, builder, type, nodes, groups);
  }
  left -= count;
}

}  // namespace

Entities read_entities_4(Source& in) {
  std::array<std::int64_t, 4> counts{};
  for (std::int64_t& count : counts) count = in.size_value("number of entities", 0, kMaxSize);
  in.end_record();
  Entities entities;
  for (int dimension = 0; dimension < 4; ++dimension)
    for (std::int64_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i) read_entity(in, dimension, entities);
  return entities;
}

void read_nodes_4(Source& in, Builder& builder) {
  const Header header = read_header(in, "nodes", 8, 32);
  builder.begin_nodes(static_cast<std::size_t>(header.items));
  std::int64_t left = header.items;
  for (std::int64_t i = 0; i < header.blocks; ++i) read_node_block(in, builder, left);
  must_be_complete(in, "nodes", left);
}

void read_elements_4(Source& in, Builder& builder, const std::optional<Entities>& entities) {
  const Header header = read_header(in, "elements", 4, 16);
  std::int64_t left = header.items;
  for (std::int64_t i = 0; i < header.blocks; ++i) read_element_block(in, builder, entities, left);
  must_be_complete(in, "elements", left);
}

}  // namespace softkin::gmsh
