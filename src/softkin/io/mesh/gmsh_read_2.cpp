#include <softkin/io/mesh/gmsh_read.hpp>

namespace softkin::gmsh {

namespace {

// The physical group among the tags of an element, 0 for none; older files mark orientation by its sign.
std::int64_t read_tags(Source& in, std::int64_t count) {
  std::int64_t physical = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t tag = in.int_value("tag of an element", -kMaxInt, kMaxInt);
    if (i == 0) physical = tag < 0 ? -tag : tag;
  }
  return physical;
}

// Tags and nodes of an element, the rest of its record.
void read_element(Source& in, Builder& builder, std::int64_t element, CellType type, std::int64_t tags) {
  const auto physical = static_cast<int>(read_tags(in, tags));
  const CellShape shape = shape_of(type);
  std::array<Index, kMostNodes> vertices{};
  for (int i = 0; i < shape.nodes; ++i)
    vertices[static_cast<std::size_t>(i)] =
        vertex(in, builder, element, in.int_value("node of an element", 1, kMaxInt));
  in.end_record();
  const std::span<const Index> nodes(vertices.data(), static_cast<std::size_t>(shape.nodes));
  if (physical == 0) return add_element(in, builder, type, nodes, {});
  Region* const groups[] = {&builder.group(shape.dimension, physical)};
  add_element(in, builder, type, nodes, groups);
}

constexpr const char* kElement = "number of an element";
constexpr const char* kType = "type of an element";
constexpr const char* kTags = "number of tags of an element";

void read_text_elements(Source& in, Builder& builder, std::int64_t count) {
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t element = in.int_value(kElement, 0, kMaxInt);
    const CellType type = known_type(in, in.int_value(kType, -kMaxInt, kMaxInt));
    read_element(in, builder, element, type, in.int_value(kTags, 0, kMaxInt));
  }
}

void read_binary_elements(Source& in, Builder& builder, std::int64_t count) {
  for (std::int64_t done = 0; done < count;) {
    const CellType type = known_type(in, in.int_value(kType, -kMaxInt, kMaxInt));
    const std::int64_t block = in.int_value("number of elements of one type", 1, count - done);
    const std::int64_t tags = in.int_value(kTags, 0, kMaxInt);
    for (std::int64_t i = 0; i < block; ++i) read_element(in, builder, in.int_value(kElement, 0, kMaxInt), type, tags);
    done += block;
  }
}

}  // namespace

void read_nodes_2(Source& in, Builder& builder) {
  const std::int64_t count = in.text_count("number of nodes");
  in.require(count, 8, 28, "nodes");
  builder.begin_nodes(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    number_node(in, builder, in.int_value("number of a node", 1, kMaxInt));
    place_node(in, builder, static_cast<Index>(i));
    in.end_record();
  }
}

void read_elements_2(Source& in, Builder& builder) {
  const std::int64_t count = in.text_count("number of elements");
  in.require(count, 9, 8, "elements");
  if (in.binary())
    read_binary_elements(in, builder, count);
  else
    read_text_elements(in, builder, count);
}

}  // namespace softkin::gmsh
