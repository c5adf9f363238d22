#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <softkin/core/error.hpp>
#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

// The mesh part of an Abaqus input file as written, before numbers and names are looked up. Lines are for messages.

struct AbaqusNode {
  std::int64_t id = 0;
  Vec3 position;
  std::size_t line = 0;
};

/// line: of a truss or beam. triangle, quad: of a shell or a flat element.
enum class AbaqusShape { line, triangle, quad, tetrahedron, prism };

struct AbaqusElement {
  std::int64_t id = 0;
  AbaqusShape shape = AbaqusShape::tetrahedron;
  std::array<std::int64_t, 10> nodes{};  // corners first
  std::size_t count = 0;
  std::size_t line = 0;
};

/// A set by name, or the numbers first, first + step, ... last.
struct AbaqusItem {
  std::string name;
  std::int64_t first = 0, last = 0, step = 1;
  int face = 0;                // of a surface: 1 to 5; 0: the shell itself
  bool element_nodes = false;  // the nodes of the element set `name`
  std::size_t line = 0;
};

enum class AbaqusSetKind { nodes, elements, surface };

/// One *NSET, *ELSET or *SURFACE, or the set that a *NODE or *ELEMENT names; the same name again adds to the set.
struct AbaqusSet {
  std::string name;
  AbaqusSetKind kind = AbaqusSetKind::nodes;
  bool in_assembly = false;
  std::vector<AbaqusItem> items;
  std::size_t line = 0;
};

struct AbaqusCards {
  std::string file;
  std::vector<AbaqusNode> nodes;
  std::vector<AbaqusElement> elements;
  std::vector<AbaqusSet> sets;
  std::size_t last_line = 0;

  [[nodiscard]] Origin origin(std::size_t line) const { return {file, line}; }
};

/// Flat files, or one part with at most one instance that is not moved. Keywords that say nothing about the mesh are
/// passed over.
[[nodiscard]] AbaqusCards read_abaqus_cards(const std::filesystem::path& path);

}  // namespace softkin
