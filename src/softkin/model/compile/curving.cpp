#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/model/compile/curving.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>

namespace softkin {

namespace {

constexpr double min_loss = 0.02;        // of a section
constexpr double max_doubt = 0.3;        // of what all sections lose
constexpr int slab_count = 10;           // across the robot's longest side
constexpr double min_slab = 0.03;        // of the volume in a slab that counts
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
         decimal(100 * done.min_fraction, 0) + " % of its path.";
}

/// The mesh's regions, and those that a scene makes of lists of elements; shapes cut a mesh in steps.
std::vector<Region> regions_of(const RobotSpec& spec, const Mesh& mesh) {
  std::vector<Region> regions = mesh.regions;
  for (const RegionSpec& region : spec.regions)
    if (const auto* list = std::get_if<ElementList>(&region.selector))
      regions.push_back({region.name, 3, list->tetrahedra, {}, {}, {}, {}});
  return regions;
}

/// The volume of a slab across the longest side of the body, and by how much it grows with other positions [mm^3].
struct Slab {
  double volume = 0, gain = 0;
};

std::array<Slab, slab_count> slabs_of(const Model& model, const Points& positions) {
  Vec3 low = Vec3::Constant(HUGE_VAL), high = -low;
  for (const Tetrahedron& t : model.elements.tetrahedra)
    for (const Index v : t) {
      low = low.cwiseMin(vertex_at(model.rest, v));
      high = high.cwiseMax(vertex_at(model.rest, v));
    }
  Index axis = 0;
  const double length = (high - low).maxCoeff(&axis);
  std::array<Slab, slab_count> all;
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    double middle = 0;
    for (const Index v : model.elements.tetrahedra[e]) middle += model.rest(v, axis) / 4;
    Slab& slab = all[std::min<std::size_t>(slab_count - 1,
                                           static_cast<std::size_t>((middle - low[axis]) / length * slab_count))];
    const double volume = model.elements.tetrahedron_volumes[e];
    slab.volume += volume;
    slab.gain +=
        shape_integrals(nodes_of(positions, model.elements.tetrahedra[e], model.elements.edge_nodes[e])).sum() - volume;
  }
  return all;
}

/// Returns the largest relative growth of a slab with curved edges; 0 where it is uncertain, as where the mesh is too
/// coarse to determine the depth of hollows of the surface.
double sure_gain(const Compilation& c) {
  const Model& model = c.model;
  const SmoothBulges bulges =
      smooth_bulges(c.mesh, labels_of(c.mesh, regions_of(c.spec, c.mesh)), CurveSpec{}.crease_degrees);
  if (bulges.hollow_crease) return 0;
  const auto slabs_with = [&](const Points& moves) {
    Points positions = model.rest;
    for (const auto& [low, high, node] : edges_with_nodes(c.mesh))
      positions.row(node) = 0.5 * (model.rest.row(low) + model.rest.row(high)) + moves.row(node);
    return slabs_of(model, positions);
  };
  const auto likely = slabs_with(bulges.likely), most = slabs_with(bulges.most);
  double whole = 0, largest = 0, gains = 0, doubt = 0;
  for (int s = 0; s < slab_count; ++s) {
    whole += likely[s].volume;
    gains += std::abs(likely[s].gain);
    doubt += std::abs(most[s].gain - likely[s].gain);
  }
  if (doubt > max_doubt * gains) return 0;
  for (const auto& [volume, gain] : likely)
    if (volume > min_slab * whole && std::abs(gain) > std::abs(largest) * volume) largest = gain / volume;
  return largest;
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
  if (done.moved == 0) {
    notes.emplace_back("'curve' moved no node: the mesh's surface is flat between its creases.");
    return done;
  }
  notes.push_back("'curve' moved " + counted(done.moved, "node") + " of edges, by up to " +
                  number(done.farthest_mm, 3) + " mm; the volume of all elements changed by " +
                  number(100 * (curved_volume(mesh) / before - 1), 3) + " %" + held_text(done));
  if (done.undetermined > 0)
    notes.push_back("The mesh is too coarse to determine how the surface runs at " +
                    counted(done.undetermined, "edge") + ", such as around " + point_text(done.undetermined_at) +
                    " mm, where it turns from hollow to full within an element: refine there.");
  return done;
}

void doubt_straight_edges(Compilation& c) {
  Model& model = c.model;
  if (model.formulation != Formulation::physical || model.elements.edge_nodes.empty()) return;
  if (c.spec.mesh_options.curve || c.spec.mesh_options.curved || !has_straight_edges(c.mesh)) return;
  const double gain = sure_gain(c);
  if (!(std::abs(gain) > min_loss)) return;
  const std::string fraction = decimal(100 * std::abs(gain), 0) + " %";
  model.warnings.push_back(
      "The edges are straight where the surface through the vertices is round: sections of the body are about " +
      fraction +
      (gain > 0 ? " too small, and bend by twice that too easily" : " too large, and bend by twice that too little") +
      "; take 'mesh: {file: F, order: 2, curve: true}', or a mesh with curved edges (Gmsh: "
      "gmsh.model.mesh.setOrder(2)).");
}

}  // namespace softkin
