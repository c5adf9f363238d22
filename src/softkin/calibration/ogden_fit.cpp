#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <softkin/calibration/constrained_fit.hpp>
#include <softkin/calibration/ogden_fit.hpp>

namespace softkin::calibration {

namespace {

constexpr double max_exponent = 30, min_exponent = 0.05;
constexpr double exponent_grid[] = {-8,  -6, -4.5, -3.5, -2.5, -2, -1.5, -1, -0.5, 0.25, 0.5, 0.75, 1,  1.25,
                                    1.5, 2,  2.5,  3,    3.5,  4,  5,    6,  7,    8,    10,  12,   15, 20};

using Exponents = std::vector<double>;

struct ExponentTrial {
  Exponents exponents;
  double squares = std::numeric_limits<double>::infinity();  // that are left over
};

/// The sum over terms of strengths k_p = mu_p alpha_p >= 0.
class OgdenSearch {
 public:
  OgdenSearch(const Eigen::VectorXd& strain, const Eigen::VectorXd& stress)
      : log_stretch_(strain.array().log1p()), stress_(stress) {}

  /// The nominal stress of mu alpha = 1.
  [[nodiscard]] Eigen::VectorXd column(double alpha) const {
    const Eigen::ArrayXd x = log_stretch_.array();
    return ((alpha - 1) * x).exp().matrix() / alpha - ((-alpha / 2 - 1) * x).exp().matrix() / alpha;
  }

  [[nodiscard]] Eigen::MatrixXd columns(const Exponents& exponents) const {
    Eigen::MatrixXd all(stress_.size(), static_cast<Eigen::Index>(exponents.size()));
    for (std::size_t p = 0; p < exponents.size(); ++p) all.col(static_cast<Eigen::Index>(p)) = column(exponents[p]);
    return all;
  }

  [[nodiscard]] Eigen::VectorXd strengths(const Exponents& exponents) const {
    const Eigen::MatrixXd all = columns(exponents);
    const Eigen::VectorXd scale = all.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
    return scale.cwiseProduct(non_negative_fit(all * scale.asDiagonal(), stress_));
  }

  [[nodiscard]] ExponentTrial tried(Exponents exponents) const {
    const Eigen::VectorXd left = columns(exponents) * strengths(exponents) - stress_;
    const double squares = left.squaredNorm();
    return {std::move(exponents), std::isfinite(squares) ? squares : std::numeric_limits<double>::infinity()};
  }

  /// Compass search: one exponent at a time, with steps that are halved where none is better.
  [[nodiscard]] ExponentTrial refined(ExponentTrial best) const {
    constexpr double first_step = 0.5, last_step = 2e-4;
    constexpr int max_tries = 600;
    int tries = 0;
    for (double step = first_step; step > last_step && tries < max_tries;) {
      bool better = false;
      for (std::size_t p = 0; p < best.exponents.size(); ++p)
        for (const double side : {step, -step}) {
          Exponents moved = best.exponents;
          moved[p] = std::clamp(moved[p] + side, -max_exponent, max_exponent);
          if (std::abs(moved[p]) < min_exponent) moved[p] = std::copysign(min_exponent, side);
          ExponentTrial candidate = tried(std::move(moved));
          ++tries;
          if (!(candidate.squares < best.squares)) continue;
          best = std::move(candidate);
          better = true;
          break;
        }
      step *= better ? 1.5 : 0.5;
    }
    return best;
  }

  [[nodiscard]] std::vector<OgdenTerm> terms(const Exponents& exponents) const {
    const Eigen::VectorXd k = strengths(exponents);
    std::vector<OgdenTerm> terms;
    for (std::size_t p = 0; p < exponents.size(); ++p)
      if (const double strength = k[static_cast<Eigen::Index>(p)]; strength > 0)
        terms.push_back({strength / exponents[p], exponents[p]});
    std::sort(terms.begin(), terms.end(), [](const OgdenTerm& a, const OgdenTerm& b) { return a.alpha < b.alpha; });
    return merged(terms);
  }

  /// Terms of one exponent are one term.
  [[nodiscard]] static std::vector<OgdenTerm> merged(const std::vector<OgdenTerm>& terms) {
    constexpr double same = 1e-3;
    std::vector<OgdenTerm> kept;
    for (const OgdenTerm& term : terms) {
      if (kept.empty() || term.alpha - kept.back().alpha > same) {
        kept.push_back(term);
      } else {
        kept.back().mu += term.mu;
      }
    }
    return kept;
  }

 private:
  Eigen::VectorXd log_stretch_;
  const Eigen::VectorXd& stress_;
};

/// Adds a candidate to the best ones, of which so many are kept.
void keep_best(std::vector<ExponentTrial>& best, ExponentTrial candidate, std::size_t max_kept) {
  best.push_back(std::move(candidate));
  std::sort(best.begin(), best.end(),
            [](const ExponentTrial& a, const ExponentTrial& b) { return a.squares < b.squares; });
  if (best.size() > max_kept) best.pop_back();
}

/// Starts of n exponents: those of one fewer and one of the grid.
std::vector<ExponentTrial> exponent_starts(const OgdenSearch& search, const std::vector<ExponentTrial>& fewer,
                                           std::size_t max_kept) {
  std::vector<ExponentTrial> best;
  for (const ExponentTrial& each : fewer)
    for (const double alpha : exponent_grid) {
      Exponents exponents = each.exponents;
      if (std::any_of(exponents.begin(), exponents.end(), [&](double e) { return std::abs(e - alpha) < 0.1; }))
        continue;
      exponents.push_back(alpha);
      keep_best(best, search.tried(std::move(exponents)), max_kept);
    }
  return best;
}

}  // namespace

std::vector<OgdenTerm> fit_ogden(const Eigen::VectorXd& strain, const Eigen::VectorXd& stress, int terms) {
  constexpr std::size_t max_starts = 6;
  const OgdenSearch search(strain, stress);
  // every exponent of the grid is the start of a pair: the best one alone may be in no good pair
  std::vector<ExponentTrial> best =
      exponent_starts(search, {ExponentTrial{}}, terms == 1 ? max_starts : std::size(exponent_grid));
  for (int n = 2; n <= terms; ++n) {
    best = exponent_starts(search, best, max_starts);
    if (n < terms)
      for (ExponentTrial& each : best) each = search.refined(std::move(each));
  }
  ExponentTrial found;
  for (ExponentTrial& each : best) {
    each = search.refined(std::move(each));
    if (each.squares < found.squares) found = each;
  }
  return search.terms(found.exponents);
}

GentConstants fit_gent(const Eigen::VectorXd& strain, const Eigen::VectorXd& stress) {
  const Eigen::ArrayXd s = strain.array() + 1, excess = s.square() + 2 / s - 3, base = s - s.square().inverse();
  const double most = excess.maxCoeff();
  const auto fitted = [&](double log_room) {
    const double jm = most * (1 + std::exp(log_room));
    const Eigen::VectorXd column = base * jm / (jm - excess);
    const double mu = column.dot(stress) / column.squaredNorm();
    return std::pair{GentConstants{mu, jm}, (mu * column - stress).squaredNorm()};
  };
  double best = 0, least = std::numeric_limits<double>::infinity();
  for (double log_room = std::log(1e-4); log_room <= std::log(1e4); log_room += 0.2)
    if (const double squares = fitted(log_room).second; squares < least) least = squares, best = log_room;
  double low = best - 0.2, high = best + 0.2;
  constexpr double golden = 0.3819660112501051;
  for (int round = 0; round < 60; ++round) {
    const double a = low + golden * (high - low), b = high - golden * (high - low);
    if (fitted(a).second < fitted(b).second)
      high = b;
    else
      low = a;
  }
  return fitted(0.5 * (low + high)).first;
}

}  // namespace softkin::calibration
