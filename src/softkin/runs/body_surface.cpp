#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/runs/body_surface.hpp>

namespace softkin::runs {

BodySurface body_surface(const Model& model) {
  std::vector<Tetrahedron> tetrahedra;
  std::vector<EdgeNodes> edge_nodes;
  std::vector<Index> numbers;
  for (std::size_t e = 0; e < model.tetrahedra.size(); ++e) {
    if (!is_solid(model, e)) continue;
    tetrahedra.push_back(model.tetrahedra[e]);
    numbers.push_back(static_cast<Index>(e));
    if (!model.edge_nodes.empty()) edge_nodes.push_back(model.edge_nodes[e]);
  }
  for (std::size_t p = 0; p < model.prisms.size(); ++p)
    numbers.push_back(static_cast<Index>(model.tetrahedra.size() + p));
  BodySurface surface;
  surface.triangles = boundary_triangles(tetrahedra, edge_nodes, model.prisms, &surface.elements);
  for (Index& element : surface.elements) element = numbers[static_cast<std::size_t>(element)];
  return surface;
}

bool is_solid(const Model& model, std::size_t element) {
  return element >= model.tetrahedra.size() || model.tetrahedron_roles[element].material >= 0;
}

const ElementRole& role_of(const Model& model, std::size_t element) {
  const std::size_t tetrahedra = model.tetrahedra.size();
  return element < tetrahedra ? model.tetrahedron_roles[element] : model.prism_roles[element - tetrahedra];
}

}  // namespace softkin::runs
