#pragma once

#include <cstddef>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/model/mesh/mesh_check.hpp>
#include <vector>

namespace softkin {

enum class MeshSeverity { remark, warning, error };

/// One place of a finding: elements, or vertices (of a face or an edge, too), numbered from 0.
struct MeshPlace {
  std::vector<Index> tetrahedra, prisms, vertices;
  Vec3 position;  // mean [mm]
};

/// One kind of finding, also where there is none of it (count 0).
struct MeshFinding {
  const char* kind;     // "degenerate_elements"
  const char* meaning;  // for people: what it is or does
  MeshSeverity severity;
  std::size_t count = 0;
  std::vector<MeshPlace> first;  // at most five
};

/// Every kind that a mesh of its order can be checked for, worst first.
[[nodiscard]] std::vector<MeshFinding> findings_of(const Mesh& mesh, const MeshCheck& check);

}  // namespace softkin
