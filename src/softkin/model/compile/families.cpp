#include <algorithm>
#include <cmath>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/compile/samples.hpp>
#include <softkin/model/families.hpp>
#include <softkin/model/growth.hpp>

namespace softkin {

namespace {

void check_family(const MaterialSpec& material, const FamilySpec& family) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(material.origin,
                       "the material of region '" + material.region + "' has a family of fibres " + why);
  };
  if (!(family.k1_MPa > 0 && std::isfinite(family.k1_MPa)))
    refuse("that needs k1 above 0 MPa, not " + number(family.k1_MPa));
  if (!(family.k2 >= 0 && std::isfinite(family.k2))) refuse("that needs k2 of 0 or more, not " + number(family.k2));
  if (!(family.dispersion >= 0 && family.dispersion <= 1.0 / 3))
    refuse("that needs a dispersion of 0 to 1/3, not " + number(family.dispersion));
}

/// The elements of a material, and the directions of its fibres there.
std::shared_ptr<const Families> families_of(const Model& model, const MaterialSpec& material, Index index) {
  auto families = std::make_shared<Families>();
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e)
    if (model.elements.tetrahedron_roles[e].material == index) families->tetrahedra.push_back(e);
  for (std::size_t e = 0; e < model.elements.prisms.size(); ++e)
    if (model.elements.prism_roles[e].material == index) families->prisms.push_back(e);
  const std::string owner = "the material of region '" + material.region + "': the direction of its fibres";
  for (const FamilySpec& spec : material.families->families) {
    check_family(material, spec);
    Families::Family& family = families->families.emplace_back();
    family.k1_MPa = spec.k1_MPa;
    family.k2 = spec.k2;
    family.dispersion = spec.dispersion;
    const Directions directions(spec.direction, owner, material.origin);
    for (const Index e : families->tetrahedra) family.directions.push_back(directions.of(model, e));
    for (const Index e : families->prisms)
      family.directions.push_back(directions.of(model, model.elements.tetrahedra.size() + static_cast<std::size_t>(e)));
  }
  return families;
}

/// Their strain is that of the whole deformation.
void refuse_growth(const Compilation& c, const Families& families, const MaterialSpec& material) {
  const Growers growers = growers_of(c.model);
  const auto grows = [](const std::vector<Index>& elements, const std::vector<Index>& grower) {
    return !grower.empty() && std::any_of(elements.begin(), elements.end(), [&](Index e) { return grower[e] >= 0; });
  };
  if (grows(families.tetrahedra, growers.tetrahedra) || grows(families.prisms, growers.prisms))
    throw InvalidInput(material.origin, "the material of region '" + material.region +
                                            "' has families of fibres, and an actuator lets it grow: one of the two");
}

}  // namespace

void compile_families(Compilation& c) {
  for (std::size_t m = 0; m < c.spec.materials.size(); ++m) {
    const MaterialSpec& spec = c.spec.materials[m];
    if (!spec.families) continue;
    if (c.spec.formulation != Formulation::physical)
      throw InvalidInput(spec.origin, "the material of region '" + spec.region +
                                          "' has families of fibres, which need the physical formulation");
    if (spec.families->families.empty())
      throw InvalidInput(spec.origin, "the material of region '" + spec.region + "' has no family of fibres");
    auto families = families_of(c.model, spec, m);
    refuse_growth(c, *families, spec);
    c.model.elements.materials[m].families = std::move(families);
  }
}

}  // namespace softkin
