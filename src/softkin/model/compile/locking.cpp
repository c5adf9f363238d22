#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/walls.hpp>

namespace softkin {

namespace {

constexpr std::size_t max_samples = 300;  // of thousands of faces: the mean holds to a few percent
constexpr double min_excess = 0.1;        // elastic constants are hardly known better than that
constexpr double mixed_ratio = 1.0 / 3;   // Poisson's, of what mixed elements leave to their strains (physical::split)
constexpr double worthwhile = 0.7;        // of the excess, that mixed elements must not leave

struct Wall {
  double compliance = 0;                // in bending, of a piece of unit length
  double across2 = 0;                   // squares of the element's extents over the wall's thickness
  double excess = 0, excess_mixed = 0;  // as the elements are, and if they were mixed
};

/// Of a chain of walls: by how much it is too stiff.
double excess_of(const std::vector<Wall>& walls, double Wall::*excess) {
  double whole = 0, locked = 0;
  for (const Wall& wall : walls) {
    whole += wall.compliance;
    locked += wall.compliance / (1 + wall.*excess);
  }
  return whole > 0 ? whole / locked - 1 : 0;
}

std::vector<bool> rigid_vertices(const Model& model) {
  std::vector<bool> rigid(model.rest.rows());
  for (const RigidRegion& region : model.rigid)
    for (const Index v : region.vertices) rigid[v] = true;
  return rigid;
}

std::vector<Wall> walls_of(const Model& model) {
  const std::vector<bool> rigid = rigid_vertices(model);
  const auto is_rigid = [&rigid](Index v) { return rigid[v]; };
  std::vector<Wall> walls;
  for (const WallSample& sample :
       wall_samples(model.rest, model.elements.tetrahedra, model.elements.prisms, max_samples)) {
    const std::size_t element = sample.element;
    const Tetrahedron& corners = model.elements.tetrahedra[element];
    if (std::all_of(corners.begin(), corners.end(), is_rigid)) continue;
    const std::size_t material = model.elements.tetrahedron_roles[element].material;
    const Material& of = model.elements.materials[material];
    const StiffnessAtRest stiffness = stiffness_at_rest(of.elastic);
    const double least = std::min(mixed_ratio, stiffness.poisson_ratio);
    const double as_mixed = bending_excess(sample, has_bulk_part(of.elastic.law) ? least : stiffness.poisson_ratio);
    const double across = sample.across_mm / sample.thickness_mm;
    walls.push_back({sample.area_mm2 / (stiffness.youngs_modulus_MPa * std::pow(sample.thickness_mm, 3)),
                     across * across, of.mixed ? as_mixed : bending_excess(sample, stiffness.poisson_ratio), as_mixed});
  }
  return walls;
}

}  // namespace

StiffnessAtRest stiffness_at_rest(const ElasticLaw& law) {
  const bool rubber = law_traits(law.law).constants != LawConstants::lame;
  const double shear = shear_modulus(law);
  const double bulk = rubber ? law.bulk : law.lambda + 2 * law.mu / 3;
  return {9 * bulk * shear / (3 * bulk + shear), (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear))};
}

void doubt_linear_tetrahedra(Compilation& c) {
  Model& model = c.model;
  if (model.formulation != Formulation::physical || model.elements.tetrahedra.empty() ||
      !model.elements.edge_nodes.empty())
    return;
  // thin and soft walls bend: their compliances add up, as of springs in series
  const std::vector<Wall> walls = walls_of(model);
  const double excess = excess_of(walls, &Wall::excess), as_mixed = excess_of(walls, &Wall::excess_mixed);
  if (!(excess > min_excess)) return;
  double whole = 0, across2 = 0;
  for (const Wall& wall : walls) {
    whole += wall.compliance;
    across2 += wall.compliance * wall.across2;
  }
  const std::string thick = decimal(std::sqrt(whole / across2), 1);
  const std::string stiff =
      excess < 1 ? "about " + decimal(100 * excess, 0) + " % too stiff" : "more than twice as stiff as they should be";
  std::string cure = model.elements.prisms.empty() ? "take 'mesh: {file: F, order: 2}'"
                                                   : "take a finer mesh, as prisms allow no 'order: 2'";
  if (as_mixed < worthwhile * excess)
    cure += "; 'elements: mixed' of the material, whose volume hardly changes, takes about " +
            decimal(100 * (1 - as_mixed / excess), 0) + " % of that off";
  (c.spec.mesh_options.linear_by_choice ? model.notes : model.warnings)
      .push_back("The walls that bend most are about " + thick +
                 " elements thick, of tetrahedra of order 1: where they bend they are " + stiff + "; " + cure + ".");
}

}  // namespace softkin
