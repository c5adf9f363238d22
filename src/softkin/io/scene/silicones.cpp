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

}  // namespace

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
