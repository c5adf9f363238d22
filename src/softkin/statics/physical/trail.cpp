#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/trail.hpp>

namespace softkin::physical {

namespace {

constexpr std::size_t most_passed = 8;
/// Equilibria nearer to each other than this share of the step have too much to say.
constexpr double least_spacing = 0.2;
/// Vertices by which predictions are judged.
constexpr Index most_looked_at = 1000;
/// A prediction is worth it that misses less than this share of what a first-order one does, and less than so many
/// tolerances: one that misses more may come to where the stiffness is not stable.
constexpr double worth = 0.3, most_tolerances = 100;

/// Weights of the polynomial through values at `nodes`, from `first` on, `degree` + 1 of them, at zero.
std::vector<double> lagrange(const std::vector<double>& nodes, std::size_t first, int degree, double at) {
  std::vector<double> weights(degree + 1, 1.0);
  for (std::size_t i = 0; i < weights.size(); ++i)
    for (std::size_t j = 0; j < weights.size(); ++j)
      if (j != i) weights[i] *= (at - nodes[first + j]) / (nodes[first + i] - nodes[first + j]);
  return weights;
}

double length_of(const Demand& from, const Demand& to) {
  return std::hypot((to.actuation - from.actuation).norm(), to.share - from.share);
}

}  // namespace

void Trail::add(const Demand& demand, const std::vector<bool>& active, const Iterate& at) {
  if (!passed_.empty() && passed_.front().active != active) clear();
  if (!passed_.empty() && length_of(passed_.front().demand, demand) == 0) passed_.erase(passed_.begin());
  if (passed_.size() == most_passed) {
    std::rotate(passed_.begin(), passed_.end() - 1, passed_.end());
    passed_.front() = {demand, active, at};
  } else {
    passed_.insert(passed_.begin(), {demand, active, at});
  }
}

void Trail::note_tangent(const Demand& from, const Demand& to, double missed_mm) {
  const double length = length_of(from, to);
  if (length > 0) curvature_ = missed_mm / (length * length);
}

/// Of the equilibria, along the step to come: 0 at the last one, 1 at its end; as many as are apart.
std::vector<double> Trail::parameters(const Demand& to) const {
  const Demand& here = passed_.front().demand;
  const Eigen::VectorXd way = to.actuation - here.actuation;
  const double square = std::pow(length_of(here, to), 2);
  std::vector<double> result;
  for (const Passed& passed : passed_) {
    const double along = way.dot(passed.demand.actuation - here.actuation) +
                         (to.share - here.share) * (passed.demand.share - here.share);
    const double next = along / square;
    if (std::any_of(result.begin(), result.end(), [&](double t) { return std::abs(t - next) < least_spacing; })) break;
    result.push_back(next);
  }
  return result;
}

bool Trail::lead(const Demand& here, const Demand& to, const std::vector<bool>& active, double tolerance_mm,
                 Iterate& at) const {
  if (passed_.size() < 3 || passed_.front().active != active || passed_.front().at.positions != at.positions)
    return false;
  const double length = length_of(here, to);
  if (length_of(passed_.front().demand, here) > 0 || !(length > 0)) return false;
  const std::vector<double> nodes = parameters(to);
  if (nodes.size() < 3) return false;
  // how each degree would have foretold the last equilibrium, and from that what it misses at the next one
  const Points& last = passed_.front().at.positions;
  const Index stride = std::max<Index>(1, static_cast<Index>(last.rows()) / most_looked_at);
  int best = 0;
  double least = most_tolerances * tolerance_mm;
  if (curvature_ >= 0) least = std::min(least, worth * curvature_ * length * length);
  for (int degree = 1; degree + 2 <= static_cast<int>(nodes.size()); ++degree) {
    const std::vector<double> weights = lagrange(nodes, 1, degree, 0);
    double ratio = 1;  // of the products of distances that the error is proportional to
    for (std::size_t i = 0; i < weights.size(); ++i) ratio *= std::abs((1 - nodes[i]) / nodes[i + 1]);
    double square = 0;
    for (Index v = 0; v < last.rows(); v += stride) {
      Eigen::RowVector3d missed = -last.row(v);
      for (std::size_t i = 0; i < weights.size(); ++i) missed += weights[i] * passed_[i + 1].at.positions.row(v);
      square = std::max(square, missed.squaredNorm());
    }
    const double error = ratio * std::sqrt(square);
    if (!(error < least)) continue;
    least = error;
    best = degree;
  }
  if (best == 0) return false;
  const std::vector<double> weights = lagrange(nodes, 0, best, 1);
  Points positions = Points::Zero(last.rows(), 3);
  Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(at.multipliers.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    positions += weights[i] * passed_[i].at.positions;
    multipliers += weights[i] * passed_[i].at.multipliers;
  }
  at.positions = std::move(positions);
  at.multipliers = std::move(multipliers);
  return true;
}

}  // namespace softkin::physical
