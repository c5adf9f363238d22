#include <algorithm>
#include <cmath>
#include <softkin/calibration/constrained_fit.hpp>
#include <softkin/calibration/ogden_fit.hpp>
#include <softkin/calibration/tensile_fit.hpp>
#include <softkin/core/dense.hpp>
#include <softkin/core/elastic_stability.hpp>
#include <softkin/core/error.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/names.hpp>

namespace softkin::calibration {

namespace {

/// Slope of the isochoric energy by s, where the stretches are s, s^-1/2, s^-1/2.
double isochoric_slope(const IncompressibleLaw& law, double s) {
  double of_terms = 0;
  for (const OgdenTerm& term : law.ogden)
    if (term.alpha != 0) of_terms += term.mu * (std::pow(s, term.alpha - 1) - std::pow(s, -term.alpha / 2 - 1));
  const double excess = s * s + 2 / s - 3;
  const double limited = law.jm > 0 ? law.jm / (law.jm - excess) : 1;
  const double slope_1 = law.c10 * limited + 2 * law.c20 * excess + 3 * law.c30 * excess * excess;
  return 2 * (s - 1 / (s * s)) * (slope_1 + law.c01 / s) + of_terms;
}

/// The change of shape of a law as scenes have it.
IncompressibleLaw shape_part(const ElasticLaw& law) {
  IncompressibleLaw part{law.law, law.c10, law.c01, law.c20, law.c30, law.jm};
  if (law.law == Law::gent) part.c10 = law.mu / 2;
  std::copy(std::begin(law.ogden), std::end(law.ogden), std::begin(part.ogden));
  return part;
}

/// The bulk modulus times J - 1 balances the isochoric pull on the sides; both as functions of their stretch t.
double excess_pressure(const IncompressibleLaw& law, double bulk, double stretch, double t) {
  const double s = std::pow(stretch / t, 2.0 / 3);
  const double j = stretch * t * t;
  return 3 * bulk * (j - 1) * j - isochoric_slope(law, s) * s;
}

double nearly_incompressible_stress(const ElasticLaw& scene_law, double stretch) {
  const IncompressibleLaw law = shape_part(scene_law);
  const double bulk = scene_law.bulk;
  double low = 1 / std::sqrt(stretch), high = low;  // no change of volume at low
  for (int grow = 0; excess_pressure(law, bulk, stretch, high) < 0; ++grow) {
    if (grow > 200) throw InvalidInput("under tension this law finds no stretch of its sides");
    high *= 1.05;
  }
  for (int halve = 0; halve < 100 && high - low > 1e-15; ++halve) {
    const double middle = 0.5 * (low + high);
    (excess_pressure(law, bulk, stretch, middle) < 0 ? low : high) = middle;
  }
  const double t = 0.5 * (low + high), s = std::pow(stretch / t, 2.0 / 3);
  // from the isochoric part: J - 1 of a nearly incompressible law has few digits
  return isochoric_slope(law, s) * s / stretch;
}

constexpr std::size_t min_points = 5;
constexpr double min_modulus = 0.01;  // of the data's mean secant modulus

FitQuality quality_of(const Eigen::VectorXd& data, const Eigen::VectorXd& fitted) {
  const Eigen::VectorXd off = data - fitted;
  FitQuality quality;
  const double about_mean = (data.array() - data.mean()).square().sum();
  quality.r_squared = about_mean > 0 ? 1 - off.squaredNorm() / about_mean : 0;
  quality.rms_mpa = std::sqrt(off.squaredNorm() / static_cast<double>(off.size()));
  quality.largest_mpa = off.cwiseAbs().maxCoeff();
  return quality;
}

struct Points2 {
  Eigen::VectorXd strain, stress;
};

Points2 points_of(const TensileCurve& curve, double most) {
  if (curve.strain.size() != curve.stress.size()) throw InvalidInput("a tensile test needs a stress for every strain");
  std::size_t count = 0;
  while (count < curve.strain.size() && (most == 0 || curve.strain[count] <= most)) ++count;
  const Index size = count;
  return {Eigen::Map<const Eigen::VectorXd>(curve.strain.data(), size),
          Eigen::Map<const Eigen::VectorXd>(curve.stress.data(), size)};
}

/// The law with one constant alone, for each.
std::vector<IncompressibleLaw> unit_laws(Law law) {
  std::vector<IncompressibleLaw> units{{law, 1, 0, 0, 0}};
  if (law == Law::mooney_rivlin) units.push_back({law, 0, 1, 0, 0});
  if (law == Law::yeoh) units.insert(units.end(), {{law, 0, 0, 1, 0}, {law, 0, 0, 0, 1}});
  return units;
}

/// The stress for each constant alone, a column each.
Eigen::MatrixXd columns_of(Law law, const Eigen::VectorXd& strain) {
  const std::vector<IncompressibleLaw> units = unit_laws(law);
  Eigen::MatrixXd columns(strain.size(), units.size());
  for (Index c = 0; c < columns.cols(); ++c)
    for (Index i = 0; i < strain.size(); ++i) columns(i, c) = uniaxial_stress(units[c], strain[i]);
  return columns;
}

/// Which constants make up the modulus at rest, c10 + c01.
Eigen::VectorXd modulus_row(Law law) {
  if (law == Law::mooney_rivlin) return Eigen::Vector2d(1, 1);
  if (law == Law::yeoh) return Eigen::Vector3d(1, 0, 0);
  return Eigen::VectorXd::Ones(1);
}

/// Conditions on the constants, a row each: the energy of these changes of shape grows faster than linearly, at
/// stretches up to the largest one. They are linear in the constants.
Eigen::MatrixXd stability_rows(Law law, double largest_stretch, Index constants) {
  constexpr int steps = 40, directions = 12;
  Eigen::MatrixXd rows(std::size(stretch_modes) * steps * directions, constants);
  Index row = 0;
  for (const StretchMode mode : stretch_modes)
    for (int i = 1; i <= steps; ++i) {
      const Vec3 stretches = stretches_of(mode, std::exp(std::log(largest_stretch) * i / steps));
      std::vector<Mat3> units;
      for (const IncompressibleLaw& unit : unit_laws(law))
        units.push_back(logarithmic_stiffness(isochoric(unit), stretches));
      for (int d = 0; d < directions; ++d, ++row) {
        const double angle = std::acos(-1.0) * d / directions;
        const Vec3 along =
            std::cos(angle) * Vec3(1, -1, 0) / std::sqrt(2.0) + std::sin(angle) * Vec3(1, 1, -2) / std::sqrt(6.0);
        for (Index c = 0; c < constants; ++c) rows(row, c) = along.dot(units[c] * along);
      }
    }
  return rows;
}

struct BoundedFit {
  Eigen::VectorXd constants;
  bool at_bound = false;
  std::optional<double> free_rms;
};

/// Least squares with row . c >= bound, and with the conditions of stability where these are requested.
BoundedFit bounded_fit(const LawChoice& choice, const Eigen::MatrixXd& columns, const Points2& points, double bound) {
  const Eigen::VectorXd scale = columns.colwise().norm().transpose().cwiseInverse();
  const Eigen::MatrixXd scaled = columns * scale.asDiagonal();
  const LeastSquares fit = least_squares(scaled, points.stress);
  if (!scale.allFinite() || fit.rank < columns.cols())
    throw InvalidInput("the tensile test has too few different strains for the constants of this law");
  const Eigen::VectorXd row = modulus_row(choice.law);
  BoundedFit result{scale.cwiseProduct(fit.solution), false, std::nullopt};
  result.at_bound = row.dot(result.constants) < bound;
  Eigen::MatrixXd conditions = scale.cwiseProduct(row).transpose();
  Eigen::VectorXd bounds = Eigen::VectorXd::Constant(1, bound);
  const auto constrained = [&] {
    return Eigen::VectorXd(scale.cwiseProduct(constrained_fit(scaled, points.stress, conditions, bounds)));
  };
  if (result.at_bound) result.constants = constrained();
  if (!choice.stable) return result;
  const Eigen::MatrixXd stability = stability_rows(choice.law, 1 + points.strain.maxCoeff(), columns.cols());
  const Eigen::VectorXd size = stability.cwiseAbs() * result.constants.cwiseAbs();
  if (!((stability * result.constants).array() < -1e-9 * size.array()).any()) return result;
  result.free_rms = std::sqrt((columns * result.constants - points.stress).squaredNorm() / points.stress.size());
  conditions.conservativeResize(1 + stability.rows(), Eigen::NoChange);
  conditions.bottomRows(stability.rows()) = stability * scale.asDiagonal();
  bounds.conservativeResize(1 + stability.rows());
  bounds.tail(stability.rows()).setZero();
  result.constants = constrained();
  return result;
}

IncompressibleLaw law_of(Law law, const Eigen::VectorXd& c) {
  IncompressibleLaw result{law, c[0], 0, 0, 0};
  if (law == Law::mooney_rivlin) result.c01 = c[1];
  if (law == Law::yeoh) {
    result.c20 = c[1];
    result.c30 = c[2];
  }
  return result;
}

bool is_fitted(Law law) {
  const std::vector<LawChoice>& all = fitted_laws();
  return std::any_of(all.begin(), all.end(), [law](const LawChoice& each) { return each.law == law; });
}

Index number_of_constants(const LawChoice& choice) {
  if (choice.law == Law::ogden) return 2 * choice.terms;
  return choice.law == Law::gent ? 2 : modulus_row(choice.law).size();
}

/// The constants; whether they are at a bound goes into the fit.
IncompressibleLaw fitted_law(const LawChoice& choice, const Points2& points, LawFit& fit) {
  IncompressibleLaw law{choice.law};
  if (choice.law == Law::ogden) {
    const std::vector<OgdenTerm> terms = fit_ogden(points.strain, points.stress, choice.terms);
    std::copy(terms.begin(), terms.end(), law.ogden);
    return law;
  }
  if (choice.law == Law::gent) {
    const GentConstants constants = fit_gent(points.strain, points.stress);
    law.c10 = constants.shear_modulus / 2;
    law.jm = constants.jm;
    return law;
  }
  const double secant = points.stress.dot(points.strain) / points.strain.squaredNorm();
  const BoundedFit found =
      bounded_fit(choice, columns_of(choice.law, points.strain), points, min_modulus * std::max(secant, 0.0) / 6);
  fit.at_bound = found.at_bound;
  fit.free_rms_mpa = found.free_rms;
  return law_of(choice.law, found.constants);
}

/// The strain nearest to 0, on either side, at which the stress stops to grow.
std::optional<double> falls_at(const IncompressibleLaw& law, double end) {
  constexpr int steps = 400;
  std::optional<double> nearest;
  for (const double side : {end, -0.5}) {
    double before = 0;
    for (int i = 1; i <= steps; ++i) {
      const double strain = side * i / steps;
      if (law.jm > 0 && std::pow(1 + strain, 2) + 2 / (1 + strain) - 3 >= law.jm) break;  // it has no energy there
      const double stress = uniaxial_stress(law, strain) * (side > 0 ? 1 : -1);
      if (stress <= before) {
        if (!nearest || std::abs(strain) < std::abs(*nearest)) nearest = strain;
        break;
      }
      before = stress;
    }
  }
  return nearest;
}

struct Line {
  double slope = 0, offset = 0;  // of the line through the origin; of the free one
};

Line line_of(double x, double y, double xx, double xy, double n) {
  const double spread = xx - x * x / n;
  return {xy / xx, spread > 0 ? (y - (xy - x * y / n) / spread * x) / n : 0};
}

}  // namespace

double uniaxial_stress(const IncompressibleLaw& law, double strain) {
  return isochoric_slope(law, 1 + strain);
}

double uniaxial_stress(const ElasticLaw& law, double strain) {
  if (!(strain >= 0) || !std::isfinite(strain)) throw InvalidInput("a tensile strain must not be below 0");
  const double stretch = 1 + strain;
  if (law.law == Law::neo_hookean) {
    const double j = 1 + law.mu * (1 - 1 / stretch) / (law.lambda + law.mu);  // nothing pulls the sides
    return law.mu * (stretch - j / (stretch * stretch));
  }
  if (!forbids_inversion(law.law))
    throw InvalidInput(std::string("a law of rubber is needed for tension, not ") + law_name(law.law));
  return nearly_incompressible_stress(law, stretch);
}

LinearRange linear_range(const TensileCurve& curve, double tolerance) {
  const Points2 points = points_of(curve, 0);
  const std::size_t total = points.strain.size();
  if (total < min_points) throw InvalidInput("a tensile test needs at least five points");
  LinearRange range;
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t n = 1; n <= total; ++n) {
    const Index last = n - 1;
    const double strain = points.strain[last], stress = points.stress[last];
    x += strain, y += stress, xx += strain * strain, xy += strain * stress;
    if (n < min_points || !(xx > 0)) continue;
    const Line line = line_of(x, y, xx, xy, static_cast<double>(n));
    const Index count = n;
    const double off = (points.stress.head(count) - line.slope * points.strain.head(count)).cwiseAbs().maxCoeff();
    if (!(line.slope > 0 && off <= tolerance * line.slope * strain)) continue;
    range.modulus_mpa = line.slope;
    range.end_strain = strain;
    range.points = n;
    range.offset_mpa = line.offset;
  }
  if (range.points == 0)
    throw InvalidInput(
        "the tensile test has no linear range: no line through the origin passes its first five points "
        "or more within the tolerance; was the test zeroed?");
  const Index count = range.points;
  range.whole = range.points == total;
  range.quality = quality_of(points.stress.head(count), range.modulus_mpa * points.strain.head(count));
  return range;
}

int IncompressibleLaw::terms() const {
  return static_cast<int>(
      std::count_if(std::begin(ogden), std::end(ogden), [](const OgdenTerm& t) { return t.alpha != 0; }));
}

ElasticLaw isochoric(const IncompressibleLaw& law) {
  ElasticLaw result;
  result.law = law.law;
  result.c10 = law.c10;
  result.c01 = law.c01;
  result.c20 = law.c20;
  result.c30 = law.c30;
  result.jm = law.jm;
  if (law.law == Law::gent || law.law == Law::neo_hookean) {
    result.mu = 2 * law.c10;
    result.c10 = 0;
  }
  std::copy(std::begin(law.ogden), std::end(law.ogden), std::begin(result.ogden));
  return result;
}

std::string LawChoice::name() const {
  return law_name(law) + (law == Law::ogden ? "-" + std::to_string(terms) : "");
}

const std::vector<LawChoice>& fitted_laws() {
  static const std::vector<LawChoice> all{{Law::neo_hookean}, {Law::mooney_rivlin}, {Law::yeoh},    {Law::gent},
                                          {Law::ogden, 1},    {Law::ogden, 2},      {Law::ogden, 3}};
  return all;
}

bool has_points_for(const TensileCurve& curve, const LawChoice& choice, double most) {
  return points_of(curve, most).strain.size() >= number_of_constants(choice);
}

LawFit fit_law(const TensileCurve& curve, const LawChoice& choice, double most) {
  if (!is_fitted(choice.law))
    throw InvalidInput("a tensile test is fitted by neo-hookean, mooney-rivlin, yeoh, gent and ogden, not by " +
                       std::string(law_name(choice.law)));
  const Points2 points = points_of(curve, most);
  if (points.strain.size() < number_of_constants(choice))
    throw InvalidInput("the tensile test has fewer points than this law has constants");
  LawFit fit;
  fit.law = fitted_law(choice, points, fit);
  const double modulus = fit.law.youngs_modulus();
  if (!(std::isfinite(modulus) && modulus > 0))
    throw InvalidInput("the tensile test has no fit with a modulus above 0: its stress does not grow with strain");
  fit.falls_at = falls_at(fit.law, points.strain[points.strain.size() - 1]);
  Eigen::VectorXd fitted(points.strain.size());
  for (Index i = 0; i < fitted.size(); ++i) fitted[i] = uniaxial_stress(fit.law, points.strain[i]);
  fit.quality = quality_of(points.stress, fitted);
  fit.points = points.strain.size();
  return fit;
}

ElasticSpec scene_constants(const IncompressibleLaw& law, double poisson_ratio) {
  ElasticSpec spec;
  spec.law = law.law;
  spec.poisson_ratio = poisson_ratio;
  if (law.law == Law::neo_hookean) {
    spec.youngs_modulus = law.youngs_modulus();
    return spec;
  }
  const double scale = 3 / (2 * (1 + poisson_ratio));
  switch (law_traits(law.law).constants) {
    case LawConstants::lame:
      break;
    case LawConstants::coefficients:
      spec.c10 = scale * law.c10;
      if (law.law == Law::mooney_rivlin) spec.c01 = scale * law.c01;
      if (law.law == Law::yeoh) {
        spec.c20 = scale * law.c20;
        spec.c30 = scale * law.c30;
      }
      break;
    case LawConstants::limited:
      spec.shear_modulus = 2 * scale * law.c10;
      spec.jm = law.jm;
      break;
    case LawConstants::ogden:
      for (const OgdenTerm& term : law.ogden)
        if (term.alpha != 0) spec.ogden.push_back({scale * term.mu, term.alpha});
      break;
  }
  return spec;
}

FitQuality scene_quality(const TensileCurve& curve, const ElasticSpec& spec, double most) {
  const Points2 points = points_of(curve, most);
  const ElasticLaw law = elastic_law(spec, "the fitted material", {});
  Eigen::VectorXd fitted(points.strain.size());
  for (Index i = 0; i < fitted.size(); ++i) fitted[i] = uniaxial_stress(law, points.strain[i]);
  return quality_of(points.stress, fitted);
}

}  // namespace softkin::calibration
