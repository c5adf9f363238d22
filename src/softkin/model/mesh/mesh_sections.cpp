#include <algorithm>
#include <cmath>
#include <softkin/model/mesh/disjoint_sets.hpp>
#include <softkin/model/mesh/mesh_sections.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>

namespace softkin {

MeshSections::MeshSections(const Mesh& mesh)
    : mesh_(mesh), part_of_vertex_(mesh.vertices.rows(), 0), section_of_(mesh.tetrahedra.size(), 0) {
  DisjointSets sets(mesh.vertices.rows());
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (int i = 1; i < 4; ++i) sets.join(t[0], t[i]);
  struct Box {
    Vec3 low = Vec3::Constant(HUGE_VAL), high = Vec3::Constant(-HUGE_VAL);
  };
  std::vector<Box> boxes;
  std::vector<Index> number(mesh.vertices.rows(), -1);  // of the part, by the vertex that stands for its set
  for (const Tetrahedron& t : mesh.tetrahedra) {
    Index& part = number[sets.find(t[0])];
    if (part < 0) {
      part = std::ssize(boxes);
      boxes.emplace_back();
    }
    for (const Index v : t) {
      part_of_vertex_[v] = part;
      boxes[part].low = boxes[part].low.cwiseMin(vertex_at(mesh.vertices, v));
      boxes[part].high = boxes[part].high.cwiseMax(vertex_at(mesh.vertices, v));
    }
  }
  sections_ = per_part * boxes.size();
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const std::size_t part = part_of_vertex_[mesh.tetrahedra[e][0]];
    Index axis = 0;
    const double length = (boxes[part].high - boxes[part].low).maxCoeff(&axis);
    double middle = 0;
    for (const Index v : mesh.tetrahedra[e]) middle += mesh.vertices(v, axis) / 4;
    const double place = std::clamp((middle - boxes[part].low[axis]) / length, 0.0, 1.0) * per_part;
    section_of_[e] = per_part * part + std::min(per_part - 1, static_cast<std::size_t>(place));
  }
}

std::vector<double> MeshSections::volumes(const Points& positions) const {
  std::vector<double> volumes(sections_, 0.0);
  for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) {
    const double volume = shape_integrals(nodes_of(positions, mesh_.tetrahedra[e], mesh_.edge_nodes[e])).sum();
    volumes[section_of_[e]] += signed_volume(mesh_.vertices, mesh_.tetrahedra[e]) < 0 ? -volume : volume;
  }
  return volumes;
}

}  // namespace softkin
