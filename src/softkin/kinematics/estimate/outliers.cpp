#include <algorithm>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/outliers.hpp>

namespace softkin::estimate {

namespace {

/// Standard deviations by which readings may be farther off than theirs say: of one in some hundred thousand.
constexpr double agrees_below = 4.3;
/// Freedoms that must be left for readings to be able to contradict each other.
constexpr double least_freedoms = 0.9;
/// Of a reading's variance, that a residual keeps however well the fit follows it.
constexpr double least_variance = 0.01;

/// Searches anew for readings that contradict the others, of one group and of two.
constexpr std::size_t most_searches = 3;

/// How far off readings are, all together and each group.
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

Judgement judge(const Fit& fit, const std::vector<ReadingGroup>& groups, const Eigen::VectorXd& values,
                const Eigen::VectorXd& weights) {
  const Eigen::MatrixXd& slopes = fit.slopes.of_readings;
  const CholeskyFactor factor(fit.normal.matrix);
  Judgement judgement;
  double chi_square = 0;
  for (const ReadingGroup& group : groups) {
    const std::vector<Index> read = read_of(group, weights);
    const auto count = static_cast<Index>(read.size());
    Eigen::MatrixXd own(count, slopes.cols());
    Eigen::VectorXd off(count);
    for (Index i = 0; i < count; ++i) {
      const Index r = read[static_cast<std::size_t>(i)];
      own.row(i) = std::sqrt(weights[r]) * slopes.row(r);
      off[i] = std::sqrt(weights[r]) * (fit.at.computed[r] - values[r]);
    }
    const Eigen::MatrixXd told = own * factor.solve(Eigen::MatrixXd(own.transpose()));
    const Eigen::MatrixXd left = (1 + least_variance) * Eigen::MatrixXd::Identity(count, count) - told;
    chi_square += off.squaredNorm();
    judgement.freedoms += static_cast<double>(count) - told.trace();
    judgement.groups.push_back(count == 0 ? 0
                                          : excess(off.dot(solve_symmetric(left, off)), static_cast<double>(count)));
  }
  judgement.all = excess(chi_square, judgement.freedoms);
  return judgement;
}

/// Readings with some groups left out, of which the others agree best.
class Search {
 public:
  Search(const std::vector<ReadingGroup>& groups, const Eigen::VectorXd& values, const Eigen::VectorXd& weights,
         const Refit& refit, const Forecast& forecast)
      : groups_(groups), values_(values), weights_(weights), refit_(refit), forecast_(forecast) {}

  /// False: it was interrupted.
  bool try_without(const std::vector<std::size_t>& out, bool anew) {
    const Eigen::VectorXd weights = without(out);
    Fit fit = refit_(weights, anew);
    if (fit.interrupted) return false;
    if (!fit.converged) return true;
    const Judgement judgement = judge(fit, groups_, values_, weights);
    if (!judgement.agrees() || (!out.empty() && judgement.freedoms < least_freedoms)) return true;
    if (found_ && found_->normal.cost <= fit.normal.cost) return true;
    found_ = std::move(fit);
    out_ = out;
    kept_ = weights;
    return true;
  }

  bool try_each(bool anew) {
    std::vector<std::vector<std::size_t>> sets;
    for (std::size_t g = 0; g < groups_.size(); ++g) sets.push_back({g});
    return try_sets(std::move(sets), anew);
  }

  bool try_pairs() {
    std::vector<std::vector<std::size_t>> sets;
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (std::size_t h = 0; h < g; ++h) sets.push_back({h, g});
    return try_sets(std::move(sets), true);
  }

  [[nodiscard]] bool found() const { return found_.has_value(); }
  Fit take(Eigen::VectorXd& weights, std::vector<std::size_t>& out) {
    weights = kept_;
    out = out_;
    return std::move(*found_);
  }

 private:
  /// All from the last estimate on; anew those alone that promise most.
  bool try_sets(std::vector<std::vector<std::size_t>> sets, bool anew) {
    std::erase_if(sets, [&](const std::vector<std::size_t>& out) {
      return std::any_of(out.begin(), out.end(), [&](std::size_t g) { return read_of(groups_[g], weights_).empty(); });
    });
    if (anew) {
      std::vector<std::pair<double, std::size_t>> promise;
      for (std::size_t i = 0; i < sets.size(); ++i) promise.emplace_back(forecast_(without(sets[i])), i);
      std::sort(promise.begin(), promise.end());
      promise.resize(std::min(promise.size(), most_searches));
      std::vector<std::vector<std::size_t>> best;
      for (const auto& [cost, i] : promise) best.push_back(sets[i]);
      sets = std::move(best);
    }
    return std::all_of(sets.begin(), sets.end(), [&](const auto& out) { return try_without(out, anew); });
  }

  [[nodiscard]] Eigen::VectorXd without(const std::vector<std::size_t>& out) const {
    Eigen::VectorXd weights = weights_;
    for (const std::size_t g : out)
      for (const Index c : groups_[g].columns) weights[c] = 0;
    return weights;
  }

  const std::vector<ReadingGroup>& groups_;
  const Eigen::VectorXd& values_;
  const Eigen::VectorXd weights_;
  const Refit& refit_;
  const Forecast& forecast_;
  std::optional<Fit> found_;
  std::vector<std::size_t> out_;
  Eigen::VectorXd kept_;
};

}  // namespace

double excess(double chi_square, double freedoms) {
  if (!(freedoms > 0)) return 0;
  const double spread = 2 / (9 * freedoms);
  return (std::cbrt(chi_square / freedoms) - (1 - spread)) / std::sqrt(spread);
}

Fit without_outliers(const std::vector<ReadingGroup>& groups, const Eigen::VectorXd& values, Eigen::VectorXd& weights,
                     Fit all, bool tracked, const Refit& refit, const Forecast& forecast,
                     std::vector<std::size_t>& out) {
  if (all.converged && judge(all, groups, values, weights).agrees()) return all;
  Search search(groups, values, weights, refit, forecast);
  bool going = true;
  if (tracked) going = search.try_each(false);
  if (tracked && going && !search.found()) going = search.try_without({}, true);
  if (going && !search.found()) going = search.try_each(true);
  if (going && !search.found()) going = search.try_pairs();
  if (!going) all.interrupted = true;
  return search.found() ? search.take(weights, out) : all;
}

}  // namespace softkin::estimate
