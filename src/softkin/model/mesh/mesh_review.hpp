#pragma once

#include <cstddef>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/model/mesh/mesh_check.hpp>
#include <string>
#include <vector>

namespace softkin {

struct RegionMeasures {
  std::string name;
  int dimension = 3;
  std::size_t cells = 0;     // dimension 3: elements, 2: faces
  std::size_t vertices = 0;  // of the cells, edge nodes included, or the region's own
  double measure = 0;        // dimension 3: volume [mm^3], 2: area [mm^2]
};

/// What is wrong with a mesh that has no volume element, and what to do, without a full stop; "" where it has one.
[[nodiscard]] std::string missing_volume(const Mesh& mesh);

/// Counts and sizes of a mesh. Reversed elements count with their volume as if they were not; sizes and quality of
/// elements of order 2 are those of their corners.
struct MeshMeasures {
  int order = 1;
  std::size_t vertices = 0, tetrahedra = 0, prisms = 0, triangles = 0, quads = 0, parts = 0;
  Vec3 low, high;              // bounding box of the elements [mm]
  double volume = 0;           // [mm^3]
  double boundary = 0;         // area [mm^2]
  double quality[3] = {};      // of MeshCheck: least, first percentile, median
  double edge_length[3] = {};  // least, median, most [mm]
  std::vector<RegionMeasures> regions;
};

/// mesh in mm, with an element. check: of the mesh.
[[nodiscard]] MeshMeasures measure_mesh(const Mesh& mesh, const MeshCheck& check);

/// Sizes of a mesh of order 2 with its edges as they are curved.
struct CurvedMeasures {
  double volume = 0;    // [mm^3]
  double boundary = 0;  // area [mm^2]
  std::vector<double>
      regions;  // dimension 3: volume [mm^3], 2: area [mm^2] where its faces are such of elements; else 0
};

/// Exact for the volume; reversed elements count as if they were not.
[[nodiscard]] CurvedMeasures measure_curved(const Mesh& mesh);

struct PartMeasures {
  std::size_t vertices = 0;
  double volume = 0;  // [mm^3]
  Vec3 centroid;      // mean of its elements' means, weighted by volume; of its vertices where it has no volume [mm]
};

/// In the order of check.parts.
[[nodiscard]] std::vector<PartMeasures> measure_parts(const Mesh& mesh, const MeshCheck& check);

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

/// "overlapping elements"
[[nodiscard]] std::string words_of(const MeshFinding& finding);
/// "tetrahedra 0, 1 at (1, 1, 1.5) mm"
[[nodiscard]] std::string text_of(const MeshPlace& place);

/// Every kind that a mesh of its order can be checked for, worst first.
[[nodiscard]] std::vector<MeshFinding> findings_of(const Mesh& mesh, const MeshCheck& check);

}  // namespace softkin
