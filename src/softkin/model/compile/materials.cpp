#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/model/compile/parts.hpp>

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
          "take neo-hookean, mooney-rivlin, yeoh or gent, or 0.49");
    return nu;
  }
  void absent(const std::optional<double>& value, const std::string& name) const {
    if (value) refuse(" has " + name + ", which its law does not take");
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

void refuse_limit(const Constants& c) {
  c.absent(c.spec.shear_modulus, "shear_modulus");
  c.absent(c.spec.jm, "jm");
}

void set_lame(const Constants& c, ElasticLaw& law) {
  refuse_limit(c);
  c.absent(c.spec.c10, "c10");
  c.absent(c.spec.c01, "c01");
  c.absent(c.spec.c20, "c20");
  c.absent(c.spec.c30, "c30");
  c.absent(c.spec.bulk_modulus, "bulk_modulus");
  const double e = c.positive(c.required(c.spec.youngs_modulus, "youngs_modulus"), "youngs_modulus");
  const double nu = c.poisson_ratio();
  law.mu = c.finite(e / (2 * (1 + nu)), "shear modulus");
  law.lambda = nu == 0.5 ? incompressible_bulk * law.mu : c.finite(e * nu / ((1 + nu) * (1 - 2 * nu)), "lambda");
}

void set_coefficients(const Constants& c, ElasticLaw& law) {
  refuse_limit(c);
  c.absent(c.spec.youngs_modulus, "youngs_modulus");
  law.c10 = c.required(c.spec.c10, "c10");
  if (law.law == Law::mooney_rivlin) {
    law.c01 = c.required(c.spec.c01, "c01");
    c.absent(c.spec.c20, "c20");
    c.absent(c.spec.c30, "c30");
  } else {
    c.absent(c.spec.c01, "c01");
    law.c20 = c.optional(c.spec.c20, "c20");
    law.c30 = c.optional(c.spec.c30, "c30");
  }
  const std::string sum = law.law == Law::yeoh ? "c10" : "c10 + c01";
  const double half_shear = c.positive(c.finite(law.c10 + law.c01, sum), sum);
  law.bulk = bulk_modulus(c, 2 * half_shear);
}

void set_limited(const Constants& c, ElasticLaw& law) {
  c.absent(c.spec.youngs_modulus, "youngs_modulus");
  c.absent(c.spec.c10, "c10");
  c.absent(c.spec.c01, "c01");
  c.absent(c.spec.c20, "c20");
  c.absent(c.spec.c30, "c30");
  law.mu = c.positive(c.required(c.spec.shear_modulus, "shear_modulus"), "shear_modulus");
  law.jm = c.positive(c.required(c.spec.jm, "jm"), "jm");
  law.bulk = bulk_modulus(c, law.mu);
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
                                        "alone: neo-hookean, mooney-rivlin, yeoh or gent");
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

ElasticLaw elastic_law(const ElasticSpec& spec, const std::string& owner, const Origin& origin) {
  const Constants constants{spec, owner, origin};
  ElasticLaw law;
  law.law = spec.law;
  if (spec.law == Law::mooney_rivlin || spec.law == Law::yeoh)
    set_coefficients(constants, law);
  else if (spec.law == Law::gent)
    set_limited(constants, law);
  else
    set_lame(constants, law);
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
}

}  // namespace softkin
