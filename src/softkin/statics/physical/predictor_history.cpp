#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/predictor_history.hpp>

namespace softkin::physical {

namespace {

/// Returns the weights of the Lagrange polynomial through `degree` + 1 values at `nodes`, from `first` on, for its
/// value at `at`.
std::vector<double> lagrange(const std::vector<double>& nodes, std::size_t first, int degree, double at) {
  std::vector<double> weights(degree + 1, 1.0);
  for (std::size_t i = 0; i < weights.size(); ++i)
    for (std::size_t j = 0; j < weights.size(); ++j)
      if (j != i) weights[i] *= (at - nodes[first + j]) / (nodes[first + i] - nodes[first + j]);
  return weights;
}

double length_of(const LoadState& from, const LoadState& to) {
  return std::hypot((to.actuation - from.actuation).norm(), to.load_factor - from.load_factor);
}

}  // namespace

void PredictorHistory::add(const LoadState& load_state, const std::vector<bool>& active, const Iterate& at,
                           const PredictionOptions& options) {
  if (!passed_.empty() && passed_.front().active != active) clear();
  if (!passed_.empty() && length_of(passed_.front().load_state, load_state) == 0) passed_.erase(passed_.begin());
  const std::size_t most = options.max_stored;
  if (passed_.size() > most) passed_.resize(most);
  if (passed_.size() == most) {
    std::rotate(passed_.begin(), passed_.end() - 1, passed_.end());
    passed_.front() = {load_state, active, at};
  } else {
    passed_.insert(passed_.begin(), {load_state, active, at});
  }
}

void PredictorHistory::note_tangent(const LoadState& from, const LoadState& to, double missed_mm) {
  const double length = length_of(from, to);
  if (length > 0) curvature_ = missed_mm / (length * length);
}

/// Returns the parameters of the equilibria along the next step: 0 at the last one, 1 at the end of the step. The list
/// ends at the first equilibrium that is too near to another one.
std::vector<double> PredictorHistory::parameters(const LoadState& to, double min_spacing) const {
  const LoadState& here = passed_.front().load_state;
  const Eigen::VectorXd path = to.actuation - here.actuation;
  const double square = std::pow(length_of(here, to), 2);
  std::vector<double> result;
  for (const Passed& passed : passed_) {
    const double along = path.dot(passed.load_state.actuation - here.actuation) +
                         (to.load_factor - here.load_factor) * (passed.load_state.load_factor - here.load_factor);
    const double next = along / square;
    if (std::any_of(result.begin(), result.end(), [&](double t) { return std::abs(t - next) < min_spacing; })) break;
    result.push_back(next);
  }
  return result;
}

bool PredictorHistory::extrapolate(const LoadState& here, const LoadState& to, const std::vector<bool>& active,
                                   double tolerance_mm, const PredictionOptions& options, Iterate& at) const {
  if (passed_.size() < 3 || passed_.front().active != active || passed_.front().at.positions != at.positions)
    return false;
  const double length = length_of(here, to);
  if (length_of(passed_.front().load_state, here) > 0 || !(length > 0)) return false;
  const std::vector<double> nodes = parameters(to, options.min_spacing);
  if (nodes.size() < 3) return false;
  // the error of each degree in a prediction of the last equilibrium, and from that an estimate for the next one
  const Points& last = passed_.front().at.positions;
  const Index stride = std::max<Index>(1, static_cast<Index>(last.rows()) / options.max_compared);
  int best = 0;
  double least = options.max_error_tolerances * tolerance_mm;
  if (curvature_ >= 0) least = std::min(least, options.max_error * curvature_ * length * length);
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
