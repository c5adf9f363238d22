#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/model/compile/curving.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/mesh/smooth_bulges.hpp>

namespace softkin {

namespace {

constexpr double least_loss = 0.02;      // of a section
constexpr double still_straight = 1e-3;  // a node's distance from the middle, over its edge's length

/// The volume of all elements with their curved edges [mm^3].
double curved_volume(const Mesh& mesh) {
  double volume = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    volume += std::abs(shape_integrals(nodes_of(mesh.vertices, mesh.tetrahedra[t], mesh.edge_nodes[t])).sum());
  return volume;
}

const char* word_of(const GivenSurface& surface) {
  constexpr const char* kinds[] = {"sphere", "cylinder", "file"};
  return kinds[surface.shape.index()];
}

std::string held_text(const CurvedEdges& done) {
  if (done.held_back == 0) return ".";
  return "; " + counted(done.held_back, "node was", "nodes were") + " held back lest elements fold, the farthest at " +
         decimal(100 * done.least_share, 0) + " % of its way.";
}

/// The mesh's regions, and those that a scene makes of lists of elements; shapes cut a mesh in steps.
std::vector<Region> regions_of(const RobotSpec& spec, const Mesh& mesh) {
  std::vector<Region> regions = mesh.regions;
  for (const RegionSpec& region : spec.regions)
    if (const auto* list = std::get_if<ElementList>(&region.selector))
      regions.push_back({region.name, 3, list->tetrahedra, {}, {}, {}, {}});
  return regions;
}

/// Why edges were left straight.
std::string doubt_text(const CurvedEdges& done) {
  const Vec3& place = done.doubtful_place;
  const std::string where =
      "near (" + number(place[0], 4) + ", " + number(place[1], 4) + ", " + number(place[2], 4) + ") mm ";
  return counted(done.left_straight, "edge stays", "edges stay") + " straight, because " + where +
         (done.would_fold ? "elements are too coarse to follow the round surface without folding"
                          : "the mesh is too coarse to determine whether the surface is flat, full or hollow");
}

/// "up to 5 % too small", "up to 4 % too large", or both.
std::string section_text(const SectionChange& change) {
  const auto percent = [](double value) { return "up to " + decimal(100 * std::abs(value), 0) + " % too "; };
  const bool small = change.most > least_loss, large = change.least < -least_loss;
  if (small && large) return percent(change.most) + "small and elsewhere " + percent(change.least) + "large";
  return small ? percent(change.most) + "small, and bend by twice that too easily"
               : percent(change.least) + "large, and bend by twice that too little";
}

}  // namespace

bool has_straight_edges(const Mesh& mesh) {
  return largest_bulge(mesh) <= still_straight;
}

CurvedEdges curve_mesh(const RobotSpec& spec, Mesh& mesh, std::vector<std::string>& notes) {
  const CurveSpec& curve = *spec.mesh_options.curve;
  if (mesh.tetrahedra.empty())
    throw InvalidInput(curve.origin, "'curve' moves nodes of elements, and the mesh is of triangles alone");
  if (!has_straight_edges(mesh))
    throw InvalidInput(curve.origin, "the mesh's edges are curved already, by up to " +
                                         number(100 * largest_bulge(mesh), 3) +
                                         " % of their length: leave 'curve' out");
  const double before = curved_volume(mesh);
  const CurvedEdges done = curve_edges(mesh, labels_of(mesh, regions_of(spec, mesh)), curve);
  for (std::size_t g = 0; g < curve.surfaces.size(); ++g)
    if (done.taken[g] == 0)
      throw InvalidInput(curve.surfaces[g].origin, std::string("no edge of the mesh's surface has both ends on this ") +
                                                       word_of(curve.surfaces[g]) +
                                                       ", within 2 % of the edge's length: check its numbers");
  if (done.left_straight > 0)
    notes.push_back("'curve': " + doubt_text(done) +
                    "; take a finer mesh there, or name the surfaces ('cylinder', 'sphere' or 'file').");
  if (done.moved == 0) {
    if (done.left_straight == 0)
      notes.emplace_back("'curve' moved no node: the mesh's surface is flat between its creases.");
    return done;
  }
  notes.push_back("'curve' moved " + counted(done.moved, "node") + " of edges, by up to " +
                  number(done.farthest_mm, 3) + " mm; the volume of all elements changed by " +
                  number(100 * (curved_volume(mesh) / before - 1), 3) + " %" + held_text(done));
  return done;
}

void doubt_straight_edges(Compilation& c) {
  Model& model = c.model;
  if (model.formulation != Formulation::physical || model.elements.edge_nodes.empty()) return;
  if (c.spec.mesh_options.curve || c.spec.mesh_options.curved || !has_straight_edges(c.mesh)) return;
  const std::vector<Index> labels = labels_of(c.mesh, regions_of(c.spec, c.mesh));
  CurveSpec smooth;
  smooth.smooth = true;
  const SmoothBulges found(c.mesh, labels, smooth.crease_degrees);
  if (!(std::abs(found.change().largest()) > least_loss)) return;
  Mesh curved = c.mesh;
  const CurvedEdges done = curve_edges(curved, labels, smooth);
  const MeshSections sections(c.mesh);
  const SectionChange change = section_change(sections.volumes(c.mesh.vertices), sections.volumes(curved.vertices));
  if (done.left_straight > 0)
    model.notes.push_back("The edges are straight where the surface may be round, and 'curve: true' would not help: " +
                          doubt_text(done) + "; take a finer mesh there, or one with curved edges.");
  if (!(std::abs(change.largest()) > least_loss)) return;
  model.warnings.push_back(
      "The edges are straight where the surface through the vertices is round: sections of the body are " +
      section_text(change) +
      "; take 'mesh: {file: F, order: 2, curve: true}', or a mesh with curved edges (Gmsh: "
      "gmsh.model.mesh.setOrder(2)).");
}

}  // namespace softkin
