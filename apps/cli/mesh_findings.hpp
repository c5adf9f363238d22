#pragma once

#include <cstddef>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/model/mesh/mesh_check.hpp>
#include <vector>

namespace softkin::cli {

enum class Severity { remark, warning, error };

/// One place of a finding: elements, or vertices (of a face or an edge, too), numbered from 0.
struct Place {
  std::vector<Index> tetrahedra, prisms, vertices;
  Vec3 position;  // mean [mm]
};

/// One kind of finding, also where there is none of it (count 0).
struct Finding {
  const char* kind;     // "degenerate_elements"
  const char* meaning;  // for people: what it is or does
  Severity severity;
  std::size_t count = 0;
  std::vector<Place> first;  // at most five
};

/// Every kind that a mesh of its order can be checked for, worst first.
[[nodiscard]] std::vector<Finding> findings_of(const Mesh& mesh, const MeshCheck& check);

}  // namespace softkin::cli
