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

/// A line of the deck or of a file that it includes.
struct AbaqusLine {
  std::uint32_t file = 0;  // index into AbaqusCards::files
  std::uint32_t line = 0;  // from 1
};

struct AbaqusNode {
  std::int64_t id = 0;
  Vec3 position;
  AbaqusLine line;
};

/// line: of a truss or beam. triangle, quad: of a shell or a flat element.
enum class AbaqusShape { line, triangle, quad, tetrahedron, prism };

struct AbaqusElement {
  std::int64_t id = 0;
  AbaqusShape shape = AbaqusShape::tetrahedron;
  std::array<std::int64_t, 10> nodes{};  // corners first
  std::size_t count = 0;
  AbaqusLine line;
};

/// A set by name, or the numbers first, first + step, ... last.
struct AbaqusItem {
  std::string name;
  std::int64_t first = 0, last = 0, step = 1;
  int face = 0;                // of a surface: 1 to 5; 0: the shell itself
  bool element_nodes = false;  // the nodes of the element set `name`
  AbaqusLine line;
};

enum class AbaqusSetKind { nodes, elements, surface };

/// One *NSET, *ELSET or *SURFACE, or the set that a *NODE or *ELEMENT names; the same name again adds to the set.
struct AbaqusSet {
  std::string name;
  AbaqusSetKind kind = AbaqusSetKind::nodes;
  bool in_assembly = false;
  std::vector<AbaqusItem> items;
  AbaqusLine line;
};

struct AbaqusCards {
  std::vector<std::string> files;  // the deck, then what it includes
  std::vector<AbaqusNode> nodes;
  std::vector<AbaqusElement> elements;
  std::vector<AbaqusSet> sets;
  AbaqusLine last_line;

  [[nodiscard]] Origin origin(AbaqusLine at) const { return {files[at.file], at.line}; }
};

/// Flat files, or one part with at most one instance that is not moved. Keywords that say nothing about the mesh are
/// passed over. What *INCLUDE names is read in its place: a file in the deck's folder or below it, named relative to
/// it.
[[nodiscard]] AbaqusCards read_abaqus_cards(const std::filesystem::path& path);

}  // namespace softkin
