#include <algorithm>
#include <cmath>
#include <optional>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/outliers.hpp>

namespace softkin::estimate {

namespace {

/// Number of standard deviations by which the misfit of readings may exceed its expectation: the probability of more is
/// about 1e-5.
constexpr double agrees_below = 4.3;
/// Degrees of freedom that must remain for readings to be able to contradict each other.
constexpr double min_freedoms = 0.9;
/// Fraction of a reading's variance that its residual retains at least, however closely the fit follows the reading.
constexpr double min_variance = 0.01;

/// How often a fit that agrees with its readings but has not converged is continued.
constexpr int max_returns = 3;
/// Maximum number of sets of readings that a search tries.
constexpr std::size_t max_searches = 8;
/// Factor by which the cost of a linear fit must fall for each group that is left out, for that set to be tried before
/// larger sets of readings.
constexpr double worthwhile_gain = 4;

using Set = std::vector<std::size_t>;

/// The misfit of the readings, of all together and of each group.
struct Judgement {
  double freedoms = 0;
  double all = 0;  // excess
  std::vector<double> groups;

  [[nodiscard]] bool agrees() const {
    return all < agrees_below &&
           std::all_of(groups.begin(), groups.end(), [](double excess) { return excess < agrees_below; });
  }
};

std::vector<Index> read_of(const ReadingGroup& group, const Eigen::VectorXd& weights) {
  std::vector<Index> read;
  for (const Index c : group.columns)
    if (weights[c] > 0) read.push_back(c);
  return read;
}

/// Slopes and residuals of the readings of a group, over their standard deviations.
struct Weighted {
  Eigen::MatrixXd slopes;
  Eigen::VectorXd off;  // from the fit
};

Weighted weighted(const Fit& fit, const ReadingGroup& group, const Eigen::VectorXd& values,
                  const Eigen::VectorXd& weights) {
  const std::vector<Index> read = read_of(group, weights);
  const Index count = read.size();
  Weighted of{Eigen::MatrixXd(count, fit.slopes.cols()), Eigen::VectorXd(count)};
  for (Index i = 0; i < count; ++i) {
    const Index r = read[i];
    of.slopes.row(i) = std::sqrt(weights[r]) * fit.slopes.row(r);
    of.off[i] = std::sqrt(weights[r]) * (fit.estimated.computed[r] - values[r]);
  }
  return of;
}

Judgement judge(const Fit& fit, const std::vector<ReadingGroup>& groups, const Eigen::VectorXd& values,
                const Eigen::VectorXd& weights) {
  const CholeskyFactor factor(fit.normal.matrix);
  Judgement judgement;
  double chi_square = 0;
  for (const ReadingGroup& group : groups) {
    const auto [own, off] = weighted(fit, group, values, weights);
    const Index count = off.size();
    const Eigen::MatrixXd estimated = own * factor.solve(Eigen::MatrixXd(own.transpose()));
    const Eigen::MatrixXd left = (1 + min_variance) * Eigen::MatrixXd::Identity(count, count) - estimated;
    chi_square += off.squaredNorm();
    judgement.freedoms += static_cast<double>(count) - estimated.trace();
    judgement.groups.push_back(count == 0 ? 0
                                          : excess(off.dot(solve_symmetric(left, off)), static_cast<double>(count)));
  }
  judgement.all = excess(chi_square, judgement.freedoms);
  return judgement;
}

/// Does a fit agree with a group of readings that it did not use?
bool agrees_with(const Fit& fit, const ReadingGroup& group, const Eigen::VectorXd& values,
                 const Eigen::VectorXd& weights) {
  const auto [own, off] = weighted(fit, group, values, weights);
  const Index count = off.size();
  const CholeskyFactor factor(fit.normal.matrix);
  const Eigen::MatrixXd spread =
      Eigen::MatrixXd::Identity(count, count) + own * factor.solve(Eigen::MatrixXd(own.transpose()));
  return count == 0 || excess(off.dot(solve_symmetric(spread, off)), static_cast<double>(count)) < agrees_below;
}

/// Tries readings with some groups left out.
class Trials {
 public:
  Trials(const std::vector<ReadingGroup>& groups, const Eigen::VectorXd& values, const Eigen::VectorXd& weights,
         const Fits& fits)
      : groups_(groups), values_(values), weights_(weights), fits_(fits) {}

  /// Continues from the last estimate: a prediction with its slopes determines which group, if any, to leave out.
  void track() {
    const Fit predicted = fits_.predicted(weights_);
    std::optional<Set> best;
    double least = 0;
    if (!agrees(predicted, {}))
      for (const Set& out : sets(1)) {
        const Fit fit = fits_.predicted(without(out));
        if (!agrees(fit, out) || (best && fit.normal.cost >= least)) continue;
        best = out;
        least = fit.normal.cost;
      }
    if (best && take(fits_.tracked(without(*best)), *best, false)) return;
    if (!interrupted_) (void)take(fits_.tracked(weights_), {}, false);
  }

  /// Searches without a start, first the sets of readings with the lowest predicted cost.
  void search() {
    std::vector<std::pair<double, Set>> promise{{forecast({}), {}}};
    for (std::size_t size = 1; size <= 2; ++size)
      for (const Set& out : sets(size)) promise.emplace_back(std::pow(worthwhile_gain, size) * forecast(out), out);
    std::sort(promise.begin(), promise.end());
    promise.resize(std::min(promise.size(), max_searches));
    for (const auto& [cost, out] : promise) {
      if (take(fits_.anew(without(out)), out, true) || interrupted_ || fits_.exhausted()) return;
    }
  }

  /// Fits all readings, where no set of them agrees.
  void search_all() { (void)take(fits_.anew(weights_), {}, true); }

  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] bool interrupted() const { return interrupted_; }
  [[nodiscard]] const Set& out() const { return out_; }
  [[nodiscard]] Eigen::VectorXd kept() const { return without(out_); }
  /// Returns the fit whose readings agree; else the fit to all readings.
  Fit fit() { return std::move(fit_); }
  [[nodiscard]] bool any() const { return any_; }

 private:
  /// Accepts a fit whose readings agree, and puts back the groups that agree with it.
  bool take(Fit fit, Set out, bool anew) {
    found_ = !fit.interrupted && agrees(fit, out);
    for (int times = 0; found_ && !fit.converged && !fit.interrupted && times < max_returns; ++times)
      fit = fits_.near(without(out), fit, anew);
    interrupted_ = fit.interrupted;
    found_ = found_ && !interrupted_;
    if (found_) put_back(fit, out, anew);
    if (found_ || interrupted_ || (out.empty() && (!any_ || (fit.converged && !fit_.converged)))) {
      any_ = true;
      fit_ = std::move(fit);
      out_ = found_ ? std::move(out) : Set{};
    }
    return found_;
  }

  void put_back(Fit& fit, Set& out, bool anew) {
    for (const std::size_t g : Set(out)) {
      if (!agrees_with(fit, groups_[g], values_, weights_)) continue;
      Set fewer = out;
      std::erase(fewer, g);
      Fit more = fits_.near(without(fewer), fit, anew);
      interrupted_ = interrupted_ || more.interrupted;
      if (interrupted_) return;
      if (!agrees(more, fewer)) continue;
      fit = std::move(more);
      out = std::move(fewer);
    }
  }

  /// A fit that agrees before its cost is minimal shows that the minimum agrees as well.
  [[nodiscard]] bool agrees(const Fit& fit, const Set& out) const {
    if (!fit.at.solved() || fit.normal.matrix.size() == 0) return false;
    const Judgement judgement = judge(fit, groups_, values_, without(out));
    return judgement.agrees() && (out.empty() || judgement.freedoms >= min_freedoms);
  }

  /// Returns the predicted cost per reading, plus the expected cost of noise: where all readings agree within noise,
  /// none is to be left out.
  [[nodiscard]] double forecast(const Set& out) const {
    const Eigen::VectorXd weights = without(out);
    const auto read = static_cast<double>((weights.array() > 0).count());
    return 1 + fits_.forecast(weights) / std::max(1.0, read);
  }

  /// Returns all sets of `size` groups that have readings.
  [[nodiscard]] std::vector<Set> sets(std::size_t size) const {
    std::vector<Set> sets;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (read_of(groups_[g], weights_).empty()) continue;
      if (size == 1) sets.push_back({g});
      for (std::size_t h = 0; h < g && size == 2; ++h)
        if (!read_of(groups_[h], weights_).empty()) sets.push_back({h, g});
    }
    return sets;
  }

  [[nodiscard]] Eigen::VectorXd without(const Set& out) const {
    Eigen::VectorXd weights = weights_;
    for (const std::size_t g : out)
      for (const Index c : groups_[g].columns) weights[c] = 0;
    return weights;
  }

  const std::vector<ReadingGroup>& groups_;
  const Eigen::VectorXd& values_;
  const Eigen::VectorXd weights_;
  const Fits& fits_;
  Fit fit_;
  Set out_;
  bool any_ = false, found_ = false, interrupted_ = false;
};

}  // namespace

double excess(double chi_square, double freedoms) {
  if (!(freedoms > 0)) return 0;
  const double spread = 2 / (9 * freedoms);
  return (std::cbrt(chi_square / freedoms) - (1 - spread)) / std::sqrt(spread);
}

Fit agreeing_fit(const std::vector<ReadingGroup>& groups, const Eigen::VectorXd& values, Eigen::VectorXd& weights,
                 const Fits& fits, std::vector<std::size_t>& out) {
  Trials trials(groups, values, weights, fits);
  if (fits.tracked) trials.track();
  if (!trials.found() && !trials.interrupted()) trials.search();
  if (!trials.any() && !trials.interrupted()) trials.search_all();
  Fit fit = trials.fit();
  fit.interrupted = trials.interrupted();
  if (!trials.found()) return fit;
  out = trials.out();
  weights = trials.kept();
  return fit;
}

}  // namespace softkin::estimate
