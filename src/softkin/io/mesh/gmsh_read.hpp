#pragma once

#include <array>
#include <map>
#include <optional>
#include <softkin/io/mesh/gmsh_builder.hpp>
#include <softkin/io/mesh/gmsh_source.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softkin::gmsh {

/// Physical tags of the geometric entities of a 4.1 file, by dimension and tag.
using Entities = std::map<std::pair<int, std::int64_t>, std::vector<int>>;

/// A .msh file that is in memory; file is for messages.
[[nodiscard]] Mesh read(const std::string& file, std::string_view content);

// The bodies of the sections, without the lines that open and close them.
void read_nodes_2(Source& in, Builder& builder);
void read_elements_2(Source& in, Builder& builder);
[[nodiscard]] Entities read_entities_4(Source& in);
void read_nodes_4(Source& in, Builder& builder);
/// entities: nothing where the file has no $Entities; elements are then in no group.
void read_elements_4(Source& in, Builder& builder, const std::optional<Entities>& entities);

// Used by both versions.
/// Gives the next vertex the number at the cursor, which must be new.
void number_node(const Source& in, Builder& builder, std::int64_t number);
/// Reads the three coordinates of the vertex of that row.
void place_node(Source& in, Builder& builder, Index row);
/// The type, or the failure that says why it is refused.
[[nodiscard]] CellType known_type(const Source& in, std::int64_t type);
/// Adds an element that is complete; fails where it cannot stand beside the others.
void add_element(const Source& in, Builder& builder, CellType type, std::span<const Index> vertices,
                 std::span<Region* const> groups);
/// Turns the node number at the cursor into a vertex.
[[nodiscard]] Index vertex(const Source& in, const Builder& builder, std::int64_t element, std::int64_t number);

}  // namespace softkin::gmsh
