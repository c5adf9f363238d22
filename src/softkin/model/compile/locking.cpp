#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/walls.hpp>

namespace softkin {

namespace {

constexpr std::size_t most_samples = 300;  // of thousands of faces: the mean holds to a few percent
constexpr double least_excess = 0.1;       // elastic constants are hardly known better than that

struct Wall {
  double compliance = 0;  // in bending, of a piece of unit length
  double across2 = 0;     // squares of the element's extents over the wall's thickness
  double excess = 0;
};

std::vector<bool> rigid_vertices(const Model& model) {
  std::vector<bool> rigid(static_cast<std::size_t>(model.rest.rows()));
  for (const RigidRegion& region : model.rigid)
    for (const Index v : region.vertices) rigid[static_cast<std::size_t>(v)] = true;
  return rigid;
}

std::vector<Wall> walls_of(const Model& model) {
  const std::vector<bool> rigid = rigid_vertices(model);
  const auto is_rigid = [&rigid](Index v) { return rigid[static_cast<std::size_t>(v)]; };
  std::vector<Wall> walls;
  for (const WallSample& sample : wall_samples(model.rest, model.tetrahedra, model.prisms, most_samples)) {
    const auto element = static_cast<std::size_t>(sample.element);
    const Tetrahedron& corners = model.tetrahedra[element];
    if (std::all_of(corners.begin(), corners.end(), is_rigid)) continue;
    const auto material = static_cast<std::size_t>(model.tetrahedron_roles[element].material);
    const StiffnessAtRest stiffness = stiffness_at_rest(model.materials[material].elastic);
    const double across = sample.across_mm / sample.thickness_mm;
    walls.push_back({sample.area_mm2 / (stiffness.youngs_modulus_MPa * std::pow(sample.thickness_mm, 3)),
                     across * across, bending_excess(sample, stiffness.poisson_ratio)});
  }
  return walls;
}

}  // namespace

StiffnessAtRest stiffness_at_rest(const ElasticLaw& law) {
  const bool rubber = forbids_inversion(law.law);
  const double shear = rubber && law.law != Law::gent ? 2 * (law.c10 + law.c01) : law.mu;
  const double bulk = rubber ? law.bulk : law.lambda + 2 * law.mu / 3;
  return {9 * bulk * shear / (3 * bulk + shear), (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear))};
}

void doubt_linear_tetrahedra(Compilation& c) {
  Model& model = c.model;
  if (model.formulation != Formulation::physical || model.tetrahedra.empty() || !model.edge_nodes.empty()) return;
  // thin and soft walls bend: what they give way by adds up, as in a chain of springs
  double whole = 0, locked = 0, across2 = 0;
  for (const Wall& wall : walls_of(model)) {
    whole += wall.compliance;
    locked += wall.compliance / (1 + wall.excess);
    across2 += wall.compliance * wall.across2;
  }
  if (!(whole > 0)) return;
  const double excess = whole / locked - 1;
  if (!(excess > least_excess)) return;
  const std::string thick = decimal(std::sqrt(whole / across2), 1);
  const std::string stiff =
      excess < 1 ? "about " + decimal(100 * excess, 0) + " % too stiff" : "more than twice as stiff as they should be";
  const std::string cure =
      model.prisms.empty() ? "take 'mesh: {file: F, order: 2}'" : "take a finer mesh, as prisms allow no 'order: 2'";
  (c.spec.linear_by_choice ? model.notes : model.warnings)
      .push_back("The walls that bend most are about " + thick +
                 " elements thick, of tetrahedra of order 1: where they bend they are " + stiff + "; " + cure + ".");
}

}  // namespace softkin
