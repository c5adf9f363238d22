#include <algorithm>
#include <set>
#include <softkin/model/layer.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/runs/body_surface.hpp>

namespace softkin::runs {

namespace {

/// Faces of layers some vertex of which is of no element, each once.
std::vector<Triangle> sheets_of(const Model& model) {
  const std::vector<bool> of_element = vertices_of_elements(model);
  std::vector<Triangle> sheets;
  std::set<Triangle> known;
  for (const auto& layer : model.reinforcement.layers)
    for (const CavityFace& face : layer->faces) {
      const Triangle& t = face.corners;
      if (std::all_of(t.begin(), t.end(), [&](Index v) { return of_element[v]; })) continue;
      Triangle key = t;
      std::sort(key.begin(), key.end());
      if (!known.insert(key).second) continue;
      const std::vector<Triangle> flat = flat_triangles(face);
      sheets.insert(sheets.end(), flat.begin(), flat.end());
    }
  return sheets;
}

}  // namespace

BodySurface body_surface(const Model& model) {
  std::vector<Tetrahedron> tetrahedra;
  std::vector<EdgeNodes> edge_nodes;
  std::vector<Index> numbers;
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    if (!is_solid(model, e)) continue;
    tetrahedra.push_back(model.elements.tetrahedra[e]);
    numbers.push_back(e);
    if (!model.elements.edge_nodes.empty()) edge_nodes.push_back(model.elements.edge_nodes[e]);
  }
  for (std::size_t p = 0; p < model.elements.prisms.size(); ++p)
    numbers.push_back(model.elements.tetrahedra.size() + p);
  BodySurface surface;
  surface.triangles = boundary_triangles(tetrahedra, edge_nodes, model.elements.prisms, &surface.elements);
  for (Index& element : surface.elements) element = numbers[element];
  for (const Triangle& sheet : sheets_of(model)) {
    surface.triangles.push_back(sheet);
    surface.elements.push_back(-1);
  }
  return surface;
}

bool is_solid(const Model& model, std::size_t element) {
  return element >= model.elements.tetrahedra.size() || model.elements.tetrahedron_roles[element].material >= 0;
}

const ElementRole& role_of(const Model& model, std::size_t element) {
  const std::size_t tetrahedra = model.elements.tetrahedra.size();
  return element < tetrahedra ? model.elements.tetrahedron_roles[element]
                              : model.elements.prism_roles[element - tetrahedra];
}

}  // namespace softkin::runs
