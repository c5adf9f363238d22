#include <algorithm>
#include <softkin/model/mesh/mesh_joining.hpp>

namespace softkin {

namespace {

void shift_indices(std::vector<Index>& indices, std::size_t first) {
  for (Index& i : indices) i += first;
}

template <class Cell>
void append_cells(std::vector<Cell>& all, const std::vector<Cell>& part, Index first) {
  for (Cell cell : part) {
    for (Index& vertex : cell) vertex += first;
    all.push_back(cell);
  }
}

void append_indices(std::vector<Index>& all, const std::vector<Index>& part) {
  all.insert(all.end(), part.begin(), part.end());
}

}  // namespace

Region renumbered(Region region, const Mesh& before) {
  shift_indices(region.tetrahedra, before.tetrahedra.size());
  shift_indices(region.prisms, before.prisms.size());
  shift_indices(region.triangles, before.triangles.size());
  shift_indices(region.quads, before.quads.size());
  shift_indices(region.vertices, before.vertices.rows());
  return region;
}

void append(Mesh& all, const Mesh& part) {
  for (const Region& each : part.regions) {
    Region region = renumbered(each, all);
    const auto found = std::find_if(all.regions.begin(), all.regions.end(), [&](const Region& known) {
      return known.name == region.name && known.dimension == region.dimension;
    });
    if (found == all.regions.end()) {
      all.regions.push_back(std::move(region));
      continue;
    }
    append_indices(found->tetrahedra, region.tetrahedra);
    append_indices(found->prisms, region.prisms);
    append_indices(found->triangles, region.triangles);
    append_indices(found->quads, region.quads);
    append_indices(found->vertices, region.vertices);
  }
  all.missing.insert(all.missing.end(), part.missing.begin(), part.missing.end());
  all.no_sidecars = all.no_sidecars || part.no_sidecars;
  const Index first = all.vertices.rows();
  append_cells(all.tetrahedra, part.tetrahedra, first);
  append_cells(all.edge_nodes, part.edge_nodes, first);
  append_cells(all.prisms, part.prisms, first);
  append_cells(all.triangles, part.triangles, first);
  append_cells(all.quads, part.quads, first);
  append_cells(all.sheet_edges, part.sheet_edges, first);
  all.vertices.conservativeResize(first + part.vertices.rows(), 3);
  all.vertices.bottomRows(part.vertices.rows()) = part.vertices;
}

}  // namespace softkin
