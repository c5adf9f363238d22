#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/model/growth.hpp>
#include <softkin/statics/physical/pressures.hpp>

namespace softkin::physical {

std::unique_ptr<const Pressures> pressures_of(const Model& model, const Pressures* like) {
  if (std::none_of(model.elements.materials.begin(), model.elements.materials.end(),
                   [](const Material& m) { return m.mixed; }))
    return nullptr;
  constexpr double scale = 30;  // unit of pressures: this many shear moduli over the diagonal in mm
  auto pressures = std::make_unique<Pressures>();
  pressures->first = model.rest.rows();
  pressures->of.assign(model.elements.tetrahedra.size(), {-1, -1, -1, -1});
  double shear = 0;
  const Growers growers = growers_of(model);
  std::map<std::array<Index, 3>, Index> known;  // by material, growth and corner
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    const Index material = model.elements.tetrahedron_roles[e].material;
    const Material& of = model.elements.materials[material];
    if (!of.mixed) continue;
    shear = std::max(shear, shear_modulus(of.elastic));
    const Index grower = growers.tetrahedra.empty() ? -1 : growers.tetrahedra[e];
    for (std::size_t i = 0; i < 4; ++i) {
      const Index corner = model.elements.tetrahedra[e][i];
      const auto [at, is_new] =
          known.emplace(std::array{material, grower, corner}, pressures->first + pressures->count());
      if (is_new) pressures->corners.push_back(corner);
      pressures->of[e][i] = at->second;
    }
  }
  if (pressures->corners.empty()) return nullptr;
  // a power of two, so that the conversion from and to MPa is exact
  pressures->unit = like ? like->unit : std::exp2(std::round(std::log2(scale * shear / model.diagonal_mm)));
  return pressures;
}

std::unique_ptr<const Model> with_vertices(const Model& model, const Pressures& pressures) {
  auto own = std::make_unique<Model>(model);
  const std::size_t all = pressures.first + pressures.count();
  const auto extend = [&](Points& points) {
    if (points.rows() == 0) return;
    points.conservativeResize(all, 3);
    points.bottomRows(pressures.count()).setZero();
  };
  extend(own->rest);
  extend(own->held.at);
  extend(own->loads.dead);
  own->held.fixed.resize(all, {false, true, true});
  own->held.support_of.resize(all, {-1, -1, -1});
  own->elements.used.resize(all, false);
  return own;
}

SplitLaw split(const ElasticLaw& law, bool quadratic) {
  constexpr double max_kept = 2;  // of the bulk part, over the shear modulus
  SplitLaw result{law};
  double& bulk = bulk_part(result.law);
  const double whole = bulk, shear = shear_modulus(law);
  bulk = std::min(max_kept * shear, 0.5 * whole);
  result.softness = 1 / (whole - bulk);
  if (!quadratic) result.smoothing = 1 / shear;
  return result;
}

}  // namespace softkin::physical
