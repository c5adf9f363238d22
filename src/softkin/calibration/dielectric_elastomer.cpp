#include <algorithm>
#include <cmath>
#include <softkin/calibration/dielectric_elastomer.hpp>
#include <softkin/core/error.hpp>
#include <string>

namespace softkin::calibration {

namespace {

constexpr double chain_fraction = 0.95;  // of a Gent chain's limit at which a curve without pull-in ends
constexpr double chain_stiffening = 1 / (1 - chain_fraction);
constexpr int scan_steps = 20000;
constexpr double farthest_stretch = 100;  // over the prestretch; a neo-hookean maximum lies before it

/// eps in MPa per (kV/mm)^2.
double permittivity(const Dielectric& d) {
  constexpr double pascal_per_square_field = 1e12, mpa_per_pascal = 1e-6;
  return d.relative_permittivity * vacuum_permittivity * pascal_per_square_field * mpa_per_pascal;
}

/// The first invariant less 3, and its derivatives by the stretches.
struct Invariant {
  double value, along, across;

  explicit Invariant(const PlaneStretch& at) {
    const double l = at.along, m = at.across, area = l * m;
    value = l * l + m * m + 1 / (area * area) - 3;
    along = 2 * (l - 1 / (l * area * area));
    across = 2 * (m - 1 / (m * area * area));
  }
};

/// Gent's stiffening and its derivatives by the stretches.
struct Stiffening {
  double value = 1, along = 0, across = 0;

  Stiffening(const Dielectric& d, const PlaneStretch& at) {
    if (d.law == DielectricLaw::neo_hookean) return;
    const Invariant i(at);
    value = d.stretch_limit / (d.stretch_limit - i.value);
    along = value * value * i.along / d.stretch_limit;
    across = value * value * i.across / d.stretch_limit;
  }
};

/// The stretch between low and high at which a function that is positive at low turns negative.
template <class Function>
double falling_root(double low, double high, const Function& f) {
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (f(middle) > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Without voltage.
PlaneStretch stretch_at_rest(const Dielectric& d) {
  if (d.loading == DielectricLoading::equal_biaxial) return {d.prestretch, d.prestretch};
  if (d.loading == DielectricLoading::uniaxial) return {d.prestretch, 1 / std::sqrt(d.prestretch)};
  return {d.prestretch, d.prestretch_across};
}

/// In the direction that is free to grow.
double free_stretch(const Dielectric& d, const PlaneStretch& at) {
  return d.loading == DielectricLoading::uniaxial ? at.across : at.along;
}

/// dW/dl1 over the shear modulus.
double stress_along(const Dielectric& d, const PlaneStretch& at) {
  return Stiffening(d, at).value * (at.along - 1 / (at.along * at.area() * at.area()));
}

/// Force per undeformed section that stretches it to the prestretch, over the shear modulus.
double nominal_stress(const Dielectric& d) {
  return stress_along(d, stretch_at_rest(d));
}

/// Where nothing pulls across, l1 dW/dl1 - l2 dW/dl2 = s1 l1, so that g (l^2 - m^2) = s l with a stiffening g.
double balanced_along(double stress, double stiffening, double across) {
  const double half = stress / (2 * stiffening);
  return half + std::sqrt(half * half + across * across);
}

/// That balance where the stiffening itself depends on the stretch: what the chains lack to their limit falls with it.
double balanced_along(const Dielectric& d, double across) {
  const double stress = nominal_stress(d), most = balanced_along(stress, 1, across);
  if (d.law == DielectricLaw::neo_hookean) return most;
  return falling_root(across, most, [&](double l) {
    const double lack = d.stretch_limit - Invariant({l, across}).value;
    return stress * l * lack - d.stretch_limit * (l * l - across * across);
  });
}

/// Derivative of plane_stretch.
PlaneStretch growth(const Dielectric& d, const PlaneStretch& at) {
  if (d.loading == DielectricLoading::equal_biaxial) return {1, 1};
  if (d.loading == DielectricLoading::constrained) return {1, 0};
  const Stiffening g(d, at);
  const double l = at.along, m = at.across, difference = l * l - m * m;
  return {(2 * g.value * m - g.across * difference) / (g.along * difference + 2 * g.value * l - nominal_stress(d)), 1};
}

/// eps (U/H)^2 / mu of the balance along the force.
double drive(const Dielectric& d, double stretch) {
  const PlaneStretch at = plane_stretch(d, stretch);
  return (stress_along(d, at) - nominal_stress(d)) / (at.area() * at.across);
}

/// Its derivative by the stretch.
double drive_slope(const Dielectric& d, double stretch) {
  const PlaneStretch at = plane_stretch(d, stretch), grows = growth(d, at);
  const double l = at.along, m = at.across, square = at.area() * at.area(), net = l - 1 / (l * square);
  const Stiffening g(d, at);
  const double value = (g.value * net - nominal_stress(d)) / (l * m * m);
  const double along = (g.along * net + g.value * (1 + 3 / (l * l * square))) / (l * m * m) - value / l;
  const double across = (g.across * net + g.value * 2 / (l * m * square)) / (l * m * m) - 2 * value / m;
  return along * grows.along + across * grows.across;
}

/// Stretch at which the chains are so near to their limit.
double chain_end(const Dielectric& d) {
  const double stress = nominal_stress(d);
  const auto at = [&](double t) -> PlaneStretch {
    if (d.loading == DielectricLoading::equal_biaxial) return {t, t};
    if (d.loading == DielectricLoading::constrained) return {t, d.prestretch_across};
    return {balanced_along(stress, chain_stiffening, t), t};
  };
  return falling_root(free_stretch(d, stretch_at_rest(d)), std::sqrt(d.stretch_limit + 3),
                      [&](double t) { return chain_fraction * d.stretch_limit - Invariant(at(t)).value; });
}

double last_stretch(const Dielectric& d) {
  if (d.law == DielectricLaw::gent) return chain_end(d);
  return (d.loading == DielectricLoading::constrained ? constrained_end : farthest_stretch) * d.prestretch;
}

void check(const Dielectric& d) {
  const auto require = [](bool right, const char* what) {
    if (!right) throw InvalidInput(std::string("dielectric elastomer: ") + what);
  };
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  const auto ratio = [](double value) { return value >= 1 && std::isfinite(value); };
  require(positive(d.shear_modulus_MPa), "the shear modulus must be above 0 MPa");
  require(positive(d.relative_permittivity), "the relative permittivity must be above 0");
  require(positive(d.thickness_mm), "the thickness must be above 0 mm");
  require(ratio(d.prestretch), "the prestretch, a ratio of lengths, must be 1 or more");
  require(ratio(d.prestretch_across), "the prestretch across, a ratio of lengths, must be 1 or more");
  if (d.law != DielectricLaw::gent) return;
  require(positive(d.stretch_limit), "the limit J_lim of a Gent material must be above 0");
  require(Invariant(stretch_at_rest(d)).value < chain_fraction * d.stretch_limit,
          "the prestretch is beyond 95 % of the limit J_lim of the Gent material");
}

/// True electric field at a stretch and its voltage [kV/mm].
double field_of(const Dielectric& d, double stretch, double voltage_kV) {
  return plane_stretch(d, stretch).area() * voltage_kV / d.thickness_mm;
}

double area_ratio(const Dielectric& d, double stretch) {
  return plane_stretch(d, stretch).area() / stretch_at_rest(d).area();
}

}  // namespace

PlaneStretch plane_stretch(const Dielectric& d, double stretch) {
  if (d.loading == DielectricLoading::equal_biaxial) return {stretch, stretch};
  if (d.loading == DielectricLoading::constrained) return {stretch, d.prestretch_across};
  return {balanced_along(d, stretch), stretch};
}

double voltage_of(const Dielectric& d, double stretch) {
  return d.thickness_mm * std::sqrt(std::max(0.0, drive(d, stretch)) * d.shear_modulus_MPa / permittivity(d));
}

std::optional<PullIn> pull_in(const Dielectric& d) {
  check(d);
  const double low = free_stretch(d, stretch_at_rest(d)), high = last_stretch(d);
  double before = low;
  for (int i = 1; i <= scan_steps; ++i) {
    const double here = low * std::pow(high / low, static_cast<double>(i) / scan_steps);
    if (drive_slope(d, here) < 0) {
      PullIn found;
      found.stretch = falling_root(before, here, [&](double l) { return drive_slope(d, l); });
      found.area_ratio = area_ratio(d, found.stretch);
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
  const double begin = free_stretch(d, stretch_at_rest(d));
  double end = curve.pull_in ? curve.pull_in->stretch : last_stretch(d);
  const auto margin = [&](double l) { return breakdown_kV_mm - field_of(d, l, voltage_of(d, l)); };
  if (breakdown_kV_mm > 0 && margin(end) < 0) {  // the field rises with the stretch: both of its factors do
    end = falling_root(begin, end, margin);
    curve.broken_down = true;
  }
  for (int k = 0; k < points; ++k) {
    const double fraction = static_cast<double>(k) / (points - 1);
    const double stretch = begin + (end - begin) * fraction * fraction;  // even in voltage at the begin
    curve.voltages.push_back(k == 0 ? 0 : voltage_of(d, stretch));
    curve.area_ratios.push_back(k == 0 ? 1 : area_ratio(d, stretch));
  }
  curve.end_field_kV_mm = field_of(d, end, curve.voltages.back());
  return curve;
}

}  // namespace softkin::calibration
