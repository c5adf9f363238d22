#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/silicones.hpp>

namespace softkin {

namespace {

constexpr double psi_MPa = 0.006894757;

/// Of what Smooth-On's data sheets say: hardness, stress at twice the length, specific gravity.
Silicone by_data_sheet(const char* name, const char* hardness, double stress_psi, double density, const char* series) {
  constexpr double twice = 2 - 1.0 / 4;  // l - 1 / l^2 at l = 2
  return {name,       hardness,
          stress_psi, stress_psi * psi_MPa / twice,
          density,    "Smooth-On, technical bulletin of " + std::string(series)};
}

/// Young's modulus at small strain.
double youngs_modulus(const ElasticSpec& spec) {
  const double nu = spec.poisson_ratio.value_or(Silicone::usual_poisson_ratio);
  if (spec.youngs_modulus) return *spec.youngs_modulus;
  double twice_shear = 4 * (spec.c10.value_or(0) + spec.c01.value_or(0));
  for (const OgdenTerm& term : spec.ogden) twice_shear += term.mu * term.alpha;
  return (1 + nu) * twice_shear;
}

}  // namespace

ElasticSpec SiliconeSet::elastic(double poisson_ratio) const {
  ElasticSpec spec;
  spec.law = law;
  spec.poisson_ratio = poisson_ratio;
  switch (law) {
    case Law::mooney_rivlin:
      spec.c10 = constants.at(0);
      spec.c01 = constants.at(1);
      break;
    case Law::yeoh:
      spec.c10 = constants.at(0);
      spec.c20 = constants.at(1);
      spec.c30 = constants.at(2);
      break;
    case Law::ogden:
      for (std::size_t i = 0; i + 1 < constants.size(); i += 2) spec.ogden.push_back({constants[i], constants[i + 1]});
      break;
    case Law::st_venant_kirchhoff:
    case Law::corotational:
    case Law::gent:
    case Law::neo_hookean:
      spec.youngs_modulus = 2 * (1 + poisson_ratio) * constants.at(0);
      break;
  }
  return spec;
}

ElasticSpec Silicone::elastic(const std::string& set, double poisson_ratio, const Origin& origin) const {
  if (set == default_set) return elastic(poisson_ratio);
  for (const SiliconeSet& each : silicone_sets())
    if (each.material == name && each.name == set) return each.elastic(poisson_ratio);
  throw InvalidInput(origin, "softkin has no set " + excerpt(set) + " of " + name + suggest_name(set, sets()));
}

std::vector<std::string> Silicone::sets() const {
  std::vector<std::string> names{default_set};
  for (const SiliconeSet& each : silicone_sets())
    if (each.material == name) names.push_back(each.name);
  return names;
}

NamedMaterial Silicone::named(const std::string& set, double poisson_ratio) const {
  NamedMaterial named{name, set, source, {}};
  for (const std::string& each : sets()) named.sets.push_back({each, youngs_modulus(elastic(each, poisson_ratio, {}))});
  for (const SiliconeSet& each : silicone_sets())
    if (each.material == name && each.name == set)
      named.source = std::string(silicone_curves_source()) + "; fitted up to a strain of " + number(each.up_to_strain) +
                     ", rms " + number(each.rms_percent, 2) + " % of the largest stress";
  return named;
}

ElasticSpec Silicone::elastic(double poisson_ratio) const {
  ElasticSpec spec;
  spec.law = Law::neo_hookean;
  spec.youngs_modulus = 2 * (1 + poisson_ratio) * shear_modulus_MPa;
  spec.poisson_ratio = poisson_ratio;
  return spec;
}

const std::vector<Silicone>& silicones() {
  constexpr double sylgard_modulus_MPa = 1.32, third = 3;  // of an incompressible solid, E = 3 mu
  static const std::vector<Silicone> all{
      by_data_sheet("ecoflex-00-10", "00-10", 8, 1040, "Ecoflex"),
      by_data_sheet("ecoflex-00-20", "00-20", 8, 1070, "Ecoflex"),
      by_data_sheet("ecoflex-00-30", "00-30", 10, 1070, "Ecoflex"),
      by_data_sheet("ecoflex-00-50", "00-50", 12, 1070, "Ecoflex"),
      by_data_sheet("dragon-skin-10", "10 A", 22, 1070, "Dragon Skin"),
      by_data_sheet("dragon-skin-20", "20 A", 49, 1080, "Dragon Skin"),
      by_data_sheet("dragon-skin-30", "30 A", 86, 1080, "Dragon Skin"),
      by_data_sheet("mold-star-15", "15 A", 55, 1180, "Mold Star"),
      by_data_sheet("mold-star-30", "30 A", 96, 1120, "Mold Star"),
      by_data_sheet("smooth-sil-940", "40 A", 200, 1180, "Smooth-Sil"),
      by_data_sheet("smooth-sil-950", "50 A", 272, 1240, "Smooth-Sil"),
      {"sylgard-184", "44 A", 0, sylgard_modulus_MPa / third, 1030,
       "Johnston et al., J. Micromech. Microeng. 24 (2014) 035017: E of 10:1 cured at 25 C; density: Dow"}};
  return all;
}

const Silicone& silicone(const std::string& name, const Origin& origin) {
  std::vector<std::string> names;
  for (const Silicone& each : silicones()) {
    if (each.name == name) return each;
    names.push_back(each.name);
  }
  throw InvalidInput(origin, "softkin knows no silicone " + excerpt(name) + " (docs/scene.md has a table)" +
                                 suggest_name(name, names));
}

}  // namespace softkin
