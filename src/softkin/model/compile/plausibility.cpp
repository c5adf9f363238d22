#include <algorithm>
#include <cmath>
#include <softkin/core/elastic_stability.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/compile/parts.hpp>

namespace softkin {

namespace {

/// What a number may have been meant as: so many times what it was taken as.
struct OtherUnit {
  const char* words;
  double factor;
};

struct Range {
  double least, most;

  [[nodiscard]] bool holds(double value) const { return value >= least && value <= most; }
};

// Usual values of soft robots, with a margin on both sides. Numbers outside of them are not refused, but warned of.
constexpr Range sizes_mm{1, 1e4}, usual_sizes_mm{5, 3000};
// 0.1 m/s^2 is less than on any moon that has been landed on, 100 m/s^2 four times Jupiter's
constexpr Range gravities{0.1, 100}, usual_gravities{1, 30};
// from aerogels to platinum
constexpr Range densities{5, 22000}, usual_densities{300, 8000};
// from the softest gels in use to steel, the stiffest insert; a body that is stiff throughout is no soft robot
constexpr Range moduli_MPa{0.005, 2.5e5}, usual_moduli_MPa{0.02, 4000};
constexpr double stiffest_soft_MPa = 1e4;

/// "; taken as g/cm^3 it would be 1080 kg/m^3: is it that?", of the first unit that makes the number a usual
/// one; else ".".
std::string taken_as(double value, const std::string& unit, const Range& usual, const std::vector<OtherUnit>& others) {
  for (const OtherUnit& other : others)
    if (usual.holds(value * other.factor))
      return "; " + std::string(other.words) + " would be " + number(value * other.factor, 4) + " " + unit +
             ": is it that?";
  return ".";
}

void doubt_size(Model& model) {
  const double size = model.diagonal_mm;
  if (sizes_mm.holds(size)) return;
  model.warnings.push_back("The robot is " + number(size, 6) + " mm across, where robots measure 1 mm to 10 m" +
                           taken_as(size, "mm", usual_sizes_mm,
                                    {{"a thousand times that (m taken for mm)", 1e3},
                                     {"a thousandth of that (mm taken for m, or um for mm)", 1e-3},
                                     {"a millionth of that (um taken for m)", 1e-6}}) +
                           " The scene's 'units: {length: U}' is the unit of its lengths and of the mesh.");
}

void doubt_gravity(const Vec3& gravity, std::vector<std::string>& warnings) {
  const double size = gravity.norm();
  if (size == 0 || gravities.holds(size)) return;
  warnings.push_back(
      "Gravity is " + number(size) + " m/s^2, where the Earth's is 9.81 m/s^2" +
      taken_as(size, "m/s^2", usual_gravities,
               {{"taken as mm/s^2 it", 1e-3}, {"taken as cm/s^2 it", 1e-2}, {"taken as mm/ms^2 it", 1e3}}) +
      " The scene's 'gravity' is in m/s^2.");
}

void doubt_density(const Material& material, std::vector<std::string>& warnings) {
  if (material.density == 0 || densities.holds(material.density)) return;
  warnings.push_back("The density of region '" + material.region + "' is " + number(material.density) +
                     " kg/m^3, where silicones and plastics have about 1000 kg/m^3" +
                     taken_as(material.density, "kg/m^3", usual_densities,
                              {{"taken as g/cm^3 it", 1e3},
                               {"taken as g/mm^3 it", 1e6},
                               {"taken as kg/mm^3 it", 1e9},
                               {"taken as t/mm^3 it", 1e12},
                               {"taken as g/m^3 it", 1e-3}}) +
                     " 'density' is in kg/m^3.");
}

void doubt_moduli(Model& model) {
  double softest = HUGE_VAL;
  for (const Material& material : model.elements.materials)
    softest = std::min(softest, stiffness_at_rest(material.elastic).youngs_modulus_MPa);
  for (const Material& material : model.elements.materials) {
    const double e = stiffness_at_rest(material.elastic).youngs_modulus_MPa;
    if (moduli_MPa.holds(e) && softest <= stiffest_soft_MPa) continue;
    model.warnings.push_back("The material of region '" + material.region + "' has a Young's modulus of " +
                             number(e, 6) + " MPa at small strain, where soft robots' have 0.01 to 10000 MPa" +
                             taken_as(e, "MPa", usual_moduli_MPa,
                                      {{"taken as Pa it", 1e-6}, {"taken as kPa it", 1e-3}, {"taken as GPa it", 1e3}}) +
                             " Elastic constants are in MPa.");
  }
}

/// Laws of rubber whose constants are of no material at strains that every soft robot comes to.
void doubt_stability(Model& model) {
  constexpr double largest_stretch = 1.5;
  for (const Material& material : model.elements.materials) {
    if (!forbids_inversion(material.elastic.law)) continue;
    const auto limit = stability_limit(material.elastic, largest_stretch);
    if (!limit) continue;
    model.warnings.push_back("The law '" + std::string(law_traits(material.elastic.law).name) + "' of region '" +
                             material.region + "' loses its stability (Drucker's condition) at a strain of " +
                             decimal(limit->stretch - 1, 2) + " along " +
                             (limit->mode == StretchMode::uniaxial ? "one axis"
                              : limit->mode == StretchMode::planar ? "one axis at a fixed width"
                                                                   : "two axes") +
                             ": its constants are of no material there, and shapes beyond it may not be found.");
  }
}

/// Pressures that no elastomer takes: Pa for kPa.
void doubt_pressures(const Compilation& c, std::vector<std::string>& warnings) {
  constexpr double highest_kPa = 10000, in_stiffest_moduli = 20;
  double stiffest_kPa = 0;
  for (const Material& material : c.model.elements.materials)
    stiffest_kPa = std::max(stiffest_kPa, 1000 * stiffness_at_rest(material.elastic).youngs_modulus_MPa);
  if (c.model.elements.materials.empty()) return;  // of layers alone, whose stiffness is for their thickness
  const double most = std::min(highest_kPa, in_stiffest_moduli * stiffest_kPa);
  for (const Actuator& actuator : c.model.actuators) {
    const double kPa = std::max(std::abs(actuator.low), std::abs(actuator.high));
    if (!actuator.is<ChamberDrive>() || actuator.control != Control::load || kPa <= most) continue;
    warnings.push_back("The range of chamber '" + actuator.name + "' goes to " + number(kPa) +
                       " kPa, where the robot's stiffest material has a Young's modulus of " + number(stiffest_kPa) +
                       " kPa" + taken_as(kPa, "kPa", {0.01, most}, {{"taken as Pa it", 1e-3}}) +
                       " Pressures are in kPa (1 bar is 100 kPa).");
  }
}

}  // namespace

void doubt_units(Compilation& c) {
  Model& model = c.model;
  doubt_size(model);
  if (model.formulation != Formulation::physical) return;
  doubt_moduli(model);
  doubt_stability(model);
  doubt_pressures(c, model.warnings);
  doubt_gravity(c.spec.loads.gravity, model.warnings);
  if (c.spec.loads.gravity.isZero(0)) return;
  for (const Material& material : model.elements.materials) doubt_density(material, model.warnings);
}

}  // namespace softkin
