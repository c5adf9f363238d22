#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/named_material.hpp>
#include <softkin/model/names.hpp>

namespace softkin {

namespace {

struct Constants {
  const ElasticSpec& spec;
  const std::string& owner;
  const Origin& origin;

  [[noreturn]] void refuse(const std::string& what) const { throw InvalidInput(origin, owner + what); }

  double required(const std::optional<double>& value, const std::string& name) const {
    if (!value) refuse(" needs " + name + ": its law takes it");
    return finite(*value, name);
  }
  double optional(const std::optional<double>& value, const std::string& name) const {
    return value ? finite(*value, name) : 0;
  }
  double finite(double value, const std::string& name) const {
    if (!std::isfinite(value)) refuse(": " + name + " must be finite, not " + number(value));
    return value;
  }
  double positive(double value, const std::string& name) const {
    if (!(value > 0)) refuse(": " + name + " must be above 0, not " + number(value));
    return value;
  }
  double poisson_ratio() const {
    const double nu = required(spec.poisson_ratio, "poisson_ratio");
    if (!(nu > -1 && nu <= 0.5)) refuse(": poisson_ratio must lie between -1 and 0.5, not be " + number(nu));
    if (nu == 0.5 && !has_bulk_part(spec.law))
      refuse(
          ": poisson_ratio 0.5 keeps the volume, which laws st-venant-kirchhoff and corotational have no part for: "
          "take " +
          laws_with_bulk_part() + ", or 0.49");
    return nu;
  }
  /// Refuses constants that are not among those taken.
  void only(const std::vector<std::string>& taken) const {
    const std::pair<const char*, bool> all[] = {{"youngs_modulus", spec.youngs_modulus.has_value()},
                                                {"c10", spec.c10.has_value()},
                                                {"c01", spec.c01.has_value()},
                                                {"c20", spec.c20.has_value()},
                                                {"c30", spec.c30.has_value()},
                                                {"bulk_modulus", spec.bulk_modulus.has_value()},
                                                {"shear_modulus", spec.shear_modulus.has_value()},
                                                {"jm", spec.jm.has_value()},
                                                {"mu1", !spec.ogden.empty()}};
    for (const auto& [name, is_there] : all)
      if (is_there && std::find(taken.begin(), taken.end(), name) == taken.end())
        refuse(std::string(" has ") + name + ", which its law does not take");
  }
};

double bulk_modulus(const Constants& c, double shear) {
  if (c.spec.bulk_modulus && c.spec.poisson_ratio)
    c.refuse(" has bulk_modulus and poisson_ratio: it needs one of the two");
  if (c.spec.bulk_modulus) return c.positive(c.required(c.spec.bulk_modulus, "bulk_modulus"), "bulk_modulus");
  if (!c.spec.poisson_ratio) c.refuse(" needs bulk_modulus or poisson_ratio");
  const double nu = c.poisson_ratio();
  return nu == 0.5 ? incompressible_bulk * shear : c.finite(2 * shear * (1 + nu) / (3 * (1 - 2 * nu)), "bulk modulus");
}

void set_lame(const Constants& c, ElasticLaw& law) {
  c.only({"youngs_modulus"});
  const double e = c.positive(c.required(c.spec.youngs_modulus, "youngs_modulus"), "youngs_modulus");
  const double nu = c.poisson_ratio();
  law.mu = c.finite(e / (2 * (1 + nu)), "shear modulus");
  law.lambda = nu == 0.5 ? incompressible_bulk * law.mu : c.finite(e * nu / ((1 + nu) * (1 - 2 * nu)), "lambda");
}

void set_coefficients(const Constants& c, ElasticLaw& law) {
  const bool yeoh = law.law == Law::yeoh;
  if (yeoh)
    c.only({"c10", "c20", "c30", "bulk_modulus"});
  else
    c.only({"c10", "c01", "bulk_modulus"});
  law.c10 = c.required(c.spec.c10, "c10");
  if (!yeoh) law.c01 = c.required(c.spec.c01, "c01");
  law.c20 = c.optional(c.spec.c20, "c20");
  law.c30 = c.optional(c.spec.c30, "c30");
  const std::string sum = yeoh ? "c10" : "c10 + c01";
  const double half_shear = c.positive(c.finite(law.c10 + law.c01, sum), sum);
  law.bulk = bulk_modulus(c, 2 * half_shear);
}

void set_limited(const Constants& c, ElasticLaw& law) {
  c.only({"shear_modulus", "jm", "bulk_modulus"});
  law.mu = c.positive(c.required(c.spec.shear_modulus, "shear_modulus"), "shear_modulus");
  law.jm = c.positive(c.required(c.spec.jm, "jm"), "jm");
  law.bulk = bulk_modulus(c, law.mu);
}

void set_ogden(const Constants& c, ElasticLaw& law) {
  c.only({"mu1", "bulk_modulus"});
  const std::vector<OgdenTerm>& terms = c.spec.ogden;
  if (terms.empty()) c.refuse(" needs mu1 and alpha1: its law takes them");
  if (terms.size() > max_ogden_terms)
    c.refuse(" has " + std::to_string(terms.size()) + " terms of Ogden's law, which has at most " +
             std::to_string(max_ogden_terms));
  for (std::size_t p = 0; p < terms.size(); ++p) {
    const std::string place = std::to_string(p + 1);
    law.ogden[p] = {c.finite(terms[p].mu, "mu" + place), c.finite(terms[p].alpha, "alpha" + place)};
    if (law.ogden[p].alpha == 0) c.refuse(": alpha" + place + " must not be 0: such a term stores no energy");
  }
  const char* sum = "the shear modulus at small strain, half the sum of mu and alpha of every term,";
  law.bulk = bulk_modulus(c, c.positive(c.finite(shear_modulus(law.ogden), sum), sum));
}

/// Has a material elements with pressures as unknowns? Unless its description says so, where it keeps its volume.
bool takes_mixed(const MaterialSpec& spec, const ElasticLaw& law, const std::string& owner) {
  const bool incompressible = spec.elastic->poisson_ratio == 0.5;
  if (!spec.mixed.value_or(incompressible)) {
    if (incompressible)
      throw InvalidInput(spec.origin,
                         owner + " has elements: plain and poisson_ratio 0.5, which needs elements: mixed");
    return false;
  }
  if (!has_bulk_part(law.law))
    throw InvalidInput(spec.origin, owner +
                                        " has elements: mixed, which go with a law that has a part of the volume "
                                        "alone: " +
                                        laws_with_bulk_part());
  ElasticLaw own = law;
  if (!(bulk_part(own) > 0))
    throw InvalidInput(spec.origin, owner + " has elements: mixed, which need a poisson_ratio above 0");
  return true;
}

Material checked_material(const MaterialSpec& spec, Formulation formulation) {
  const std::string owner = "the material of region '" + spec.region + "'";
  const bool physical = formulation == Formulation::physical;
  if (!physical && !spec.shape_ratio)
    throw InvalidInput(spec.origin, owner + " needs shape_ratio, R_omega of the target shapes");
  if (physical && !spec.elastic)
    throw InvalidInput(spec.origin, owner + " needs elastic constants: the formulation is physical");
  if (spec.shape_ratio && !(*spec.shape_ratio >= 0 && *spec.shape_ratio <= 1))
    throw InvalidInput(spec.origin, owner + ": shape_ratio must lie in [0, 1], not be " + number(*spec.shape_ratio));
  if (!(spec.weight > 0 && std::isfinite(spec.weight)))
    throw InvalidInput(spec.origin, owner + ": weight must be above 0, not " + number(spec.weight));
  if (spec.linear_range && !(*spec.linear_range > 0 && std::isfinite(*spec.linear_range)))
    throw InvalidInput(spec.origin, owner + ": linear_range must be above 0, not " + number(*spec.linear_range));
  if (!(spec.density >= 0 && std::isfinite(spec.density)))
    throw InvalidInput(spec.origin, owner + ": density must be 0 or above, not " + number(spec.density));
  for (const ViscousBranch& branch : spec.viscosity)
    if (!(branch.modulus_MPa > 0 && std::isfinite(branch.modulus_MPa) && branch.time_s > 0 &&
          std::isfinite(branch.time_s)))
      throw InvalidInput(spec.origin, owner +
                                          ": a branch of its viscosity needs a modulus above 0 MPa and a time above "
                                          "0 s, not " +
                                          number(branch.modulus_MPa) + " and " + number(branch.time_s));
  if (!physical && !spec.viscosity.empty())
    throw InvalidInput(spec.origin, owner + " has viscosity, which needs the physical formulation");
  if (spec.permittivity && !(*spec.permittivity >= 1 && std::isfinite(*spec.permittivity)))
    throw InvalidInput(spec.origin, owner + ": permittivity must be 1 or above, not " + number(*spec.permittivity));
  Material material;
  material.region = spec.region;
  material.viscosity = spec.viscosity;
  if (spec.shape_ratio) material.shape_ratio = *spec.shape_ratio;
  material.weight = spec.weight;
  if (physical) material.elastic = elastic_law(*spec.elastic, owner, spec.origin);
  if (physical) material.mixed = takes_mixed(spec, material.elastic, owner);
  material.density = spec.density;
  material.permittivity = spec.permittivity.value_or(1);
  material.linear_range = spec.linear_range;
  if (physical) material.named = spec.named;
  return material;
}

// Target shapes: an actuator's elements have no material. Physical: those of a dea have one too.
std::size_t assign(const std::vector<Index>& elements, const std::vector<Index>& at, Index material, bool actuated_too,
                   std::vector<ElementRole>& roles) {
  std::size_t count = 0;
  for (const Index i : elements) {
    if (at[i] < 0 || (roles[at[i]].actuator >= 0 && !actuated_too)) continue;
    roles[at[i]].material = material;
    ++count;
  }
  return count;
}

void refuse_bare_elements(const Compilation& c) {
  const Model& model = c.model;
  const bool physical = c.spec.formulation == Formulation::physical;
  std::map<Index, std::size_t> bare;  // by region
  for (const auto* roles : {&model.elements.tetrahedron_roles, &model.elements.prism_roles})
    for (const ElementRole& role : *roles)
      if (role.material < 0 && (role.actuator < 0 || physical)) ++bare[role.region];
  if (bare.empty()) return;
  std::string text;
  for (const auto& [region, count] : bare) {
    const std::string where = region < 0 ? "of no region" : "of region '" + model.elements.region_names[region] + "'";
    text += (text.empty() ? "" : " and ") + counted(count, "element") + " " + where;
  }
  const bool single = bare.size() == 1 && bare.begin()->second == 1;
  throw InvalidInput(c.origin, text + (single ? " has" : " have") + " no material: give one, or make the region void");
}

/// Do all elements of a region belong to actuators? Their materials matter to the physical formulation alone.
bool only_actuated(const Compilation& c, const Region& region) {
  const auto actuated = [](const std::vector<Index>& elements, const std::vector<Index>& at,
                           const std::vector<ElementRole>& roles) {
    return std::all_of(elements.begin(), elements.end(),
                       [&](Index i) { return at[i] >= 0 && roles[at[i]].actuator >= 0; });
  };
  return !(region.tetrahedra.empty() && region.prisms.empty()) &&
         actuated(region.tetrahedra, c.tetrahedron_at, c.model.elements.tetrahedron_roles) &&
         actuated(region.prisms, c.prism_at, c.model.elements.prism_roles);
}

/// The field in a layer under voltage goes with its permittivity.
void require_permittivity(const Compilation& c) {
  for (const Actuator& actuator : c.model.actuators) {
    if (!under_voltage(actuator)) continue;
    for (const Index e : actuator.as<DeaDrive>()->prisms) {
      const MaterialSpec& material = c.spec.materials[c.model.elements.prism_roles[e].material];
      if (!material.permittivity)
        throw InvalidInput(material.origin, "the material of region '" + material.region +
                                                "' needs 'permittivity', over that of the vacuum: actuator '" +
                                                actuator.name + "' puts it under voltage");
    }
  }
}

}  // namespace

namespace {

/// "set 'yeoh' E 0.47 MPa, set 'ogden' ..."
std::string other_sets(const NamedMaterial& named) {
  std::string text;
  for (const NamedMaterial::Set& set : named.sets)
    if (set.name != named.set)
      text += (text.empty() ? "" : ", ") + set.name + " " + number(set.youngs_modulus_MPa, 3) + " MPa";
  return text;
}

/// Returns the note on a material of the table: how much its sources differ.
std::string note_of(const NamedMaterial& named, const std::string& regions) {
  double own = 0, least = 0, most = 0;
  for (const NamedMaterial::Set& set : named.sets) {
    if (set.name == named.set) own = set.youngs_modulus_MPa;
    least = least == 0 ? set.youngs_modulus_MPa : std::min(least, set.youngs_modulus_MPa);
    most = std::max(most, set.youngs_modulus_MPa);
  }
  const std::string begin = "Material '" + named.name + "' of " + regions + " has set '" + named.set +
                            "', a Young's modulus of " + number(own, 3) + " MPa at small strain";
  if (named.sets.size() == 1)
    return begin +
           "; softkin has no measured curve of it, and where it has one the data sheet's modulus is 1.2 to 4.5 "
           "times that of the curve.";
  return begin + "; its other sets have " + other_sets(named) + ": its sources differ by a factor of " +
         number(most / least, 2) + ", and 'set' chooses between them.";
}

/// One note for each material of the table and set.
void note_named_materials(Compilation& c) {
  if (c.spec.formulation != Formulation::physical) return;
  std::map<std::pair<std::string, std::string>, std::pair<const NamedMaterial*, std::string>> seen;
  for (const Material& material : c.model.elements.materials) {
    if (!material.named) continue;
    auto& [named, regions] = seen[{material.named->name, material.named->set}];
    named = material.named.get();
    regions += (regions.empty() ? "region '" : ", '") + material.region + "'";
  }
  for (const auto& [key, each] : seen) c.model.notes.push_back(note_of(*each.first, each.second));
}

}  // namespace

ElasticLaw elastic_law(const ElasticSpec& spec, const std::string& owner, const Origin& origin) {
  const Constants constants{spec, owner, origin};
  ElasticLaw law;
  law.law = spec.law;
  switch (law_traits(spec.law).constants) {
    case LawConstants::lame:
      set_lame(constants, law);
      break;
    case LawConstants::coefficients:
      set_coefficients(constants, law);
      break;
    case LawConstants::limited:
      set_limited(constants, law);
      break;
    case LawConstants::ogden:
      set_ogden(constants, law);
      break;
  }
  return law;
}

void compile_materials(Compilation& c) {
  Model& model = c.model;
  const bool physical = c.spec.formulation == Formulation::physical;
  for (const MaterialSpec& spec : c.spec.materials) {
    if (!physical && spec.elastic && only_actuated(c, c.regions.find(spec.region, spec.origin))) continue;
    const Index index = model.elements.materials.size();
    model.elements.materials.push_back(checked_material(spec, c.spec.formulation));
    const Region& region = c.regions.find(spec.region, spec.origin);
    if (model.elements.materials.back().mixed && !region.prisms.empty())
      throw InvalidInput(spec.origin, "the material of region '" + spec.region + "' has elements: mixed" +
                                          (spec.mixed ? "" : ", as its poisson_ratio is 0.5,") +
                                          " which prisms are not: take a poisson_ratio of 0.49 and elements: plain");
    if (assign(region.tetrahedra, c.tetrahedron_at, index, physical, model.elements.tetrahedron_roles) +
            assign(region.prisms, c.prism_at, index, physical, model.elements.prism_roles) ==
        0)
      throw InvalidInput(spec.origin, "region '" + spec.region +
                                          "' has a material but no element of the body: its elements are void, belong "
                                          "to actuators, or it is not a volume");
  }
  refuse_bare_elements(c);
  require_permittivity(c);
  note_named_materials(c);
}

}  // namespace softkin
