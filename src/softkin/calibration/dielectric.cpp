#include <algorithm>
#include <cmath>
#include <softkin/calibration/dielectric.hpp>
#include <softkin/core/error.hpp>
#include <string>

namespace softkin::calibration {

namespace {

constexpr double chain_share = 0.95;  // of a Gent chain's limit at which a curve without pull-in ends
constexpr int scan_steps = 20000;
constexpr double farthest_stretch = 100;  // over the prestretch; a neo-hookean maximum lies before it

/// eps in MPa per (kV/mm)^2.
double permittivity(const Dielectric& d) {
  constexpr double pascal_per_square_field = 1e12, mpa_per_pascal = 1e-6;
  return d.relative_permittivity * vacuum_permittivity * pascal_per_square_field * mpa_per_pascal;
}

double invariant(double l) {
  return 2 * l * l + std::pow(l, -4) - 3;
}

/// Gent's stiffening and its derivative by the stretch.
struct Stiffening {
  double value = 1, slope = 0;
};

Stiffening stiffening(const Dielectric& d, double l) {
  if (d.law == DielectricLaw::neo_hookean) return {};
  const double value = d.stretch_limit / (d.stretch_limit - invariant(l));
  return {value, value * value * (4 * l - 4 * std::pow(l, -5)) / d.stretch_limit};
}

/// Force per undeformed section that stretches it to the prestretch, over the shear modulus.
double nominal_stress(const Dielectric& d) {
  const double p = d.prestretch;
  return stiffening(d, p).value * (p - std::pow(p, -5));
}

/// eps (U/H)^2 / mu, and its derivative by the stretch.
double drive(const Dielectric& d, double l) {
  return stiffening(d, l).value * (std::pow(l, -2) - std::pow(l, -8)) - nominal_stress(d) * std::pow(l, -3);
}

double drive_slope(const Dielectric& d, double l) {
  const Stiffening g = stiffening(d, l);
  return g.slope * (std::pow(l, -2) - std::pow(l, -8)) + g.value * (-2 * std::pow(l, -3) + 8 * std::pow(l, -9)) +
         3 * nominal_stress(d) * std::pow(l, -4);
}

/// The stretch between low and high at which a function that is positive at low turns negative.
template <class Function>
double falling_root(double low, double high, const Function& f) {
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (f(middle) > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Stretch at which the chains are so near to their limit.
double chain_end(const Dielectric& d) {
  const double most = std::sqrt((d.stretch_limit + 3) / 2);
  return falling_root(1, most, [&](double l) { return chain_share * d.stretch_limit - invariant(l); });
}

double last_stretch(const Dielectric& d) {
  return d.law == DielectricLaw::gent ? chain_end(d) : farthest_stretch * d.prestretch;
}

void check(const Dielectric& d) {
  const auto require = [](bool right, const char* what) {
    if (!right) throw InvalidInput(std::string("dielectric elastomer: ") + what);
  };
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  require(positive(d.shear_modulus_MPa), "the shear modulus must be above 0 MPa");
  require(positive(d.relative_permittivity), "the relative permittivity must be above 0");
  require(positive(d.thickness_mm), "the thickness must be above 0 mm");
  require(d.prestretch >= 1 && std::isfinite(d.prestretch), "the prestretch, a ratio of lengths, must be 1 or more");
  if (d.law != DielectricLaw::gent) return;
  require(positive(d.stretch_limit), "the limit J_lim of a Gent material must be above 0");
  require(d.prestretch < chain_end(d), "the prestretch is beyond 95 % of the limit J_lim of the Gent material");
}

}  // namespace

double voltage_of(const Dielectric& d, double stretch) {
  return d.thickness_mm * std::sqrt(std::max(0.0, drive(d, stretch)) * d.shear_modulus_MPa / permittivity(d));
}

double field_of(const Dielectric& d, double stretch, double voltage_kV) {
  return stretch * stretch * voltage_kV / d.thickness_mm;
}

std::optional<PullIn> pull_in(const Dielectric& d) {
  check(d);
  const double low = d.prestretch, high = last_stretch(d);
  double before = low;
  for (int i = 1; i <= scan_steps; ++i) {
    const double here = low * std::pow(high / low, static_cast<double>(i) / scan_steps);
    if (drive_slope(d, here) < 0) {
      PullIn found;
      found.stretch = falling_root(before, here, [&](double l) { return drive_slope(d, l); });
      found.voltage_kV = voltage_of(d, found.stretch);
      found.field_kV_mm = field_of(d, found.stretch, found.voltage_kV);
      return found;
    }
    before = here;
  }
  return std::nullopt;
}

DielectricCurve dielectric_curve(const Dielectric& d, int points, double breakdown_kV_mm) {
  if (points < 3) throw InvalidInput("a curve needs at least three points");
  if (!(breakdown_kV_mm >= 0 && std::isfinite(breakdown_kV_mm)))
    throw InvalidInput("dielectric elastomer: the breakdown field must be above 0 kV/mm");
  DielectricCurve curve;
  curve.pull_in = pull_in(d);
  double end = curve.pull_in ? curve.pull_in->stretch : last_stretch(d);
  const auto margin = [&](double l) { return breakdown_kV_mm - field_of(d, l, voltage_of(d, l)); };
  if (breakdown_kV_mm > 0 && margin(end) < 0) {  // the field rises with the stretch: both of its factors do
    end = falling_root(d.prestretch, end, margin);
    curve.broken_down = true;
  }
  for (int k = 0; k < points; ++k) {
    const double share = static_cast<double>(k) / (points - 1);
    const double stretch = d.prestretch + (end - d.prestretch) * share * share;  // even in voltage at the begin
    curve.voltages.push_back(k == 0 ? 0 : voltage_of(d, stretch));
    curve.area_ratios.push_back(std::pow(stretch / d.prestretch, 2));
  }
  curve.end_field_kV_mm = field_of(d, end, curve.voltages.back());
  return curve;
}

}  // namespace softkin::calibration
