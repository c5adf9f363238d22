#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/mesh_review.hpp>

namespace softkin {

namespace {

/// The elements of the robot and its chambers alone, as they stand in the mesh, and their numbers there.
struct Used {
  Mesh mesh;
  std::vector<Index> tetrahedra, prisms;
};

Used without_void(const Compilation& c) {
  Used used;
  used.mesh.vertices = c.mesh.vertices;
  for (std::size_t i = 0; i < c.mesh.tetrahedra.size(); ++i) {
    if (c.tetrahedron_at[i] < 0 && c.chamber_at[i] < 0) continue;
    used.mesh.tetrahedra.push_back(c.mesh.tetrahedra[i]);
    if (!c.mesh.edge_nodes.empty()) used.mesh.edge_nodes.push_back(c.mesh.edge_nodes[i]);
    used.tetrahedra.push_back(static_cast<Index>(i));
  }
  for (std::size_t i = 0; i < c.mesh.prisms.size(); ++i) {
    if (c.prism_at[i] < 0) continue;
    used.mesh.prisms.push_back(c.mesh.prisms[i]);
    used.prisms.push_back(static_cast<Index>(i));
  }
  return used;
}

/// "overlapping elements (9): on the same side of a common face, the first: tetrahedra 0, 3 at (1, 2, 3) mm; ..."
std::string errors_text(const Used& used) {
  std::string text;
  for (const MeshFinding& finding : findings_of(used.mesh, check_mesh(used.mesh))) {
    if (finding.severity != MeshSeverity::error || finding.count == 0) continue;
    MeshPlace first = finding.first.front();
    for (Index& i : first.tetrahedra) i = used.tetrahedra[i];
    for (Index& i : first.prisms) i = used.prisms[i];
    text += (text.empty() ? "" : "; ") + words_of(finding) + " (" + std::to_string(finding.count) +
            "): " + finding.meaning + ", the first: " + text_of(first);
  }
  return text;
}

}  // namespace

void refuse_mesh_errors(Compilation& c) {
  const Model& model = c.model;
  if (!share_a_side(model.tetrahedra, c.chamber_tetrahedra, model.prisms, static_cast<Index>(model.rest.rows())))
    return;
  const std::string errors = errors_text(without_void(c));
  if (errors.empty()) return;
  const Origin& origin = c.spec.mesh_origin.file.empty() ? c.origin : c.spec.mesh_origin;
  if (!c.spec.accept_mesh_errors)
    throw InvalidInput(origin, "the mesh has errors: " + errors + " (numbers from 0). `softkin mesh check " +
                                   c.origin.file + "` lists them all: remesh, or take the mesh as it is with " +
                                   "`mesh: {file: F, accept_errors: true}`");
  c.model.notes.push_back("The mesh is taken in spite of its errors (accept_errors): " + errors + ".");
}

}  // namespace softkin
