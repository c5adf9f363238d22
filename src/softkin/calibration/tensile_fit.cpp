#include <algorithm>
#include <cmath>
#include <softkin/calibration/tensile_fit.hpp>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/model/compile/parts.hpp>

namespace softkin::calibration {

namespace {

/// Slope of the isochoric energy by s, where the stretches are s, s^-1/2, s^-1/2.
template <class AnyLaw>
double isochoric_slope(const AnyLaw& law, double s) {
  const double excess = s * s + 2 / s - 3;
  const double limited = law.jm > 0 ? law.jm / (law.jm - excess) : 1;
  const double slope_1 = law.c10 * limited + 2 * law.c20 * excess + 3 * law.c30 * excess * excess;
  return 2 * (s - 1 / (s * s)) * (slope_1 + law.c01 / s);
}

/// The bulk modulus times J - 1 balances the isochoric pull on the sides; both as functions of their stretch t.
double excess_pressure(const ElasticLaw& law, double stretch, double t) {
  const double s = std::pow(stretch / t, 2.0 / 3);
  const double j = stretch * t * t;
  return 3 * law.bulk * (j - 1) * j - isochoric_slope(law, s) * s;
}

double nearly_incompressible_stress(const ElasticLaw& law, double stretch) {
  double low = 1 / std::sqrt(stretch), high = low;  // no change of volume at low
  for (int grow = 0; excess_pressure(law, stretch, high) < 0; ++grow) {
    if (grow > 200) throw InvalidInput("under tension this law finds no stretch of its sides");
    high *= 1.05;
  }
  for (int halve = 0; halve < 100 && high - low > 1e-15; ++halve) {
    const double middle = 0.5 * (low + high);
    (excess_pressure(law, stretch, middle) < 0 ? low : high) = middle;
  }
  const double t = 0.5 * (low + high), s = std::pow(stretch / t, 2.0 / 3);
  // from the isochoric part: J - 1 of a nearly incompressible law has few digits
  return isochoric_slope(law, s) * s / stretch;
}

constexpr std::size_t least_points = 5;
constexpr double least_modulus = 0.01;  // of the data's mean secant modulus

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

/// The stress for each constant alone, a column each.
Eigen::MatrixXd columns_of(Law law, const Eigen::VectorXd& strain) {
  std::vector<IncompressibleLaw> units{{law, 1, 0, 0, 0}};
  if (law == Law::mooney_rivlin) units.push_back({law, 0, 1, 0, 0});
  if (law == Law::yeoh) units.insert(units.end(), {{law, 0, 0, 1, 0}, {law, 0, 0, 0, 1}});
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

/// Least squares with row . c >= bound: one inequality, so the optimum is free or on it.
Eigen::VectorXd bounded_fit(const Eigen::MatrixXd& columns, const Eigen::VectorXd& stress, const Eigen::VectorXd& row,
                            double bound, bool& at_bound) {
  const Eigen::VectorXd scale = columns.colwise().norm().transpose().cwiseInverse();
  const LeastSquares fit = least_squares(columns * scale.asDiagonal(), stress);
  if (!scale.allFinite() || fit.rank < columns.cols())
    throw InvalidInput("the tensile test has too few different strains for the constants of this law");
  const Eigen::VectorXd free = scale.cwiseProduct(fit.solution);
  at_bound = row.dot(free) < bound;
  if (!at_bound) return free;
  const Eigen::MatrixXd normal = (scale.asDiagonal() * columns.transpose() * columns * scale.asDiagonal());
  const Eigen::VectorXd away = scale.cwiseProduct(solve_symmetric(normal, scale.cwiseProduct(row)));
  return free + away * (bound - row.dot(free)) / row.dot(away);
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

/// The strain nearest to 0, on either side, at which the stress stops to grow.
std::optional<double> falls_at(const IncompressibleLaw& law, double end) {
  constexpr int steps = 400;
  std::optional<double> nearest;
  for (const double side : {end, -0.5}) {
    double before = 0;
    for (int i = 1; i <= steps; ++i) {
      const double strain = side * i / steps;
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
  if (law.law != Law::mooney_rivlin && law.law != Law::yeoh)
    throw InvalidInput("tension is known of neo-hookean, mooney-rivlin and yeoh alone");
  return nearly_incompressible_stress(law, stretch);
}

LinearRange linear_range(const TensileCurve& curve, double tolerance) {
  const Points2 points = points_of(curve, 0);
  const std::size_t total = points.strain.size();
  if (total < least_points) throw InvalidInput("a tensile test needs at least five points");
  LinearRange range;
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t n = 1; n <= total; ++n) {
    const Index last = n - 1;
    const double strain = points.strain[last], stress = points.stress[last];
    x += strain, y += stress, xx += strain * strain, xy += strain * stress;
    if (n < least_points || !(xx > 0)) continue;
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

LawFit fit_law(const TensileCurve& curve, Law law, double most) {
  if (law != Law::neo_hookean && law != Law::mooney_rivlin && law != Law::yeoh)
    throw InvalidInput("a tensile test is fitted by neo-hookean, mooney-rivlin and yeoh alone");
  const Points2 points = points_of(curve, most);
  const Eigen::VectorXd row = modulus_row(law);
  if (points.strain.size() < row.size() || points.strain.size() < 1)
    throw InvalidInput("the tensile test has fewer points than this law has constants");
  const double secant = points.stress.dot(points.strain) / points.strain.squaredNorm();
  const Eigen::MatrixXd columns = columns_of(law, points.strain);
  LawFit fit;
  const Eigen::VectorXd constants =
      bounded_fit(columns, points.stress, row, least_modulus * std::max(secant, 0.0) / 6, fit.at_bound);
  if (!constants.allFinite() || !(row.dot(constants) > 0))
    throw InvalidInput("the tensile test has no fit with a modulus above 0: its stress does not grow with strain");
  fit.law = law_of(law, constants);
  fit.falls_at = falls_at(fit.law, points.strain[points.strain.size() - 1]);
  fit.quality = quality_of(points.stress, columns * constants);
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
  spec.c10 = scale * law.c10;
  if (law.law == Law::mooney_rivlin) {
    spec.c01 = scale * law.c01;
  } else {
    spec.c20 = scale * law.c20;
    spec.c30 = scale * law.c30;
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
