#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/mesh_review.hpp>

namespace softkin {

namespace {

/// The elements of the robot and its chambers alone, as they stand in the mesh, and their numbers there.
struct Used {
  Mesh mesh;
  std::vector<Index> tetrahedra, prisms;
};

struct IndexRange {
  std::size_t begin = 0, end = 0;
};

Used without_void(const Compilation& c, const IndexRange& tetrahedra, const IndexRange& prisms) {
  Used used;
  used.mesh.vertices = c.mesh.vertices;
  for (std::size_t i = tetrahedra.begin; i < tetrahedra.end; ++i) {
    if (c.tetrahedron_at[i] < 0 && c.chamber_at[i] < 0) continue;
    used.mesh.tetrahedra.push_back(c.mesh.tetrahedra[i]);
    if (!c.mesh.edge_nodes.empty()) used.mesh.edge_nodes.push_back(c.mesh.edge_nodes[i]);
    used.tetrahedra.push_back(i);
  }
  for (std::size_t i = prisms.begin; i < prisms.end; ++i) {
    if (c.prism_at[i] < 0) continue;
    used.mesh.prisms.push_back(c.mesh.prisms[i]);
    used.prisms.push_back(i);
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

/// Refuses the errors of one robot's elements, or notes them.
void refuse_errors_of(Compilation& c, const RobotPart& robot, const IndexRange& tetrahedra, const IndexRange& prisms) {
  const std::string errors = errors_text(without_void(c, tetrahedra, prisms));
  if (errors.empty()) return;
  const std::string mesh = robot.name.empty() ? "the mesh" : "the mesh of robot '" + robot.name + "'";
  if (!robot.accept_mesh_errors)
    throw InvalidInput(robot.mesh_origin.file.empty() ? c.origin : robot.mesh_origin,
                       mesh + " has errors: " + errors + " (numbers from 0). `softkin mesh check " + c.origin.file +
                           "` lists them all: remesh, or take the mesh as it is with " +
                           "`mesh: {file: F, accept_errors: true}`");
  c.model.notes.push_back((robot.name.empty() ? "The mesh" : "The mesh of robot '" + robot.name + "'") +
                          " is taken in spite of its errors (accept_errors): " + errors + ".");
}

}  // namespace

void refuse_mesh_errors(Compilation& c) {
  const Model& model = c.model;
  if (!have_common_side(model.elements.tetrahedra, c.chamber_tetrahedra, model.elements.prisms, model.rest.rows()))
    return;
  std::vector<RobotPart> robots = c.spec.robots;
  if (robots.empty())
    robots.push_back({"", "", 0, 0, 0, c.spec.mesh_options.origin, c.spec.mesh_options.accept_errors});
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const auto range = [&](Index RobotPart::*first, std::size_t count) {
      return IndexRange{static_cast<std::size_t>(robots[r].*first),
                        r + 1 < robots.size() ? static_cast<std::size_t>(robots[r + 1].*first) : count};
    };
    refuse_errors_of(c, robots[r], range(&RobotPart::tetrahedra, c.mesh.tetrahedra.size()),
                     range(&RobotPart::prisms, c.mesh.prisms.size()));
  }
}

}  // namespace softkin
