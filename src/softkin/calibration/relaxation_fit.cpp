#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <softkin/calibration/nonnegative.hpp>
#include <softkin/calibration/relaxation_fit.hpp>
#include <softkin/calibration/relaxation_problem.hpp>
#include <softkin/calibration/relaxation_repeats.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>

namespace softkin::calibration {

namespace {

using Eigen::VectorXd;

constexpr double grid_per_decade = 4;
constexpr double finest_fraction = 1e-4;      // of the answers' rms: nothing finer is measured
constexpr double strong_difference = 6;       // between values of the criterion
constexpr Eigen::Index rows_per_unknown = 3;  // with fewer rows a criterion means little
constexpr double min_fraction = 1e-3;         // of a branch that a fit begins with, of all

/// Relaxation times that the rows resolve: the shortest interval, except for a few possible outliers, and the longest
/// run.
std::array<double, 2> resolved_times(const std::vector<RelaxationRun>& runs) {
  std::vector<double> intervals;
  double longest = 0;
  for (const RelaxationRun& run : runs) {
    for (std::size_t i = 1; i < run.time_s.size(); ++i) intervals.push_back(run.time_s[i] - run.time_s[i - 1]);
    longest = std::max(longest, run.time_s.back() - run.time_s.front());
  }
  constexpr std::size_t fraction = 50;
  const auto at = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / fraction);
  std::nth_element(intervals.begin(), at, intervals.end());
  return {*at, longest};
}

std::vector<double> grid_between(const std::array<double, 2>& times) {
  const double decades = std::log10(times[1] / times[0]);
  const int count = std::max(1, static_cast<int>(std::ceil(grid_per_decade * decades)));
  std::vector<double> grid;
  for (int i = 0; i <= count; ++i) grid.push_back(times[0] * std::pow(10, decades * i / count));
  return grid;
}

/// From rest: of stresses [MPa], or of stretches [-].
double rms_of(const std::vector<RelaxationRun>& runs, bool stretches) {
  double squares = 0, rows = 0;
  for (const RelaxationRun& run : runs)
    for (std::size_t i = 0; i < run.time_s.size(); ++i, ++rows)
      squares += stretches ? std::pow(run.stretch[i] - 1, 2) : std::pow(run.stress_MPa[i], 2);
  return std::sqrt(squares / rows);
}

/// Where a fit may begin.
struct Start {
  std::vector<double> constants;
  std::vector<ViscousBranch> branches;
};

/// Starts by linear least squares, the stretches taken as imposed.
class Starts {
 public:
  Starts(const RelaxationProblem& problem, const std::vector<double>& grid) : problem_(problem), grid_(grid) {
    columns_.resize(problem.rows(), grid.size());
    for (std::size_t i = 0; i < grid.size(); ++i) columns_.col(i) = problem.column(grid[i]);
    choose_limit();
  }

  /// The whole grid, neighbours merged until so many are left.
  [[nodiscard]] Start merged(std::size_t branches) const {
    Start start = solve(constants_, grid_, columns_).first;
    std::erase_if(start.branches, [](const ViscousBranch& branch) { return branch.modulus_MPa <= 0; });
    while (start.branches.size() > branches) merge_nearest(start.branches);
    return start;
  }

  /// The times of a fit, and that of the grid that helps most.
  [[nodiscard]] Start with_one_more(const std::vector<double>& constants,
                                    const std::vector<ViscousBranch>& branches) const {
    std::vector<double> times;
    Eigen::MatrixXd columns(columns_.rows(), std::ssize(branches) + 1);
    for (const ViscousBranch& branch : branches) {
      columns.col(times.size()) = problem_.column(branch.time_s);
      times.push_back(branch.time_s);
    }
    times.push_back(0);
    std::pair<Start, double> best{{}, std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      times.back() = grid_[i];
      columns.rightCols(1) = columns_.col(i);
      std::pair<Start, double> tried = solve(constants, times, columns);
      if (tried.second < best.second) best = std::move(tried);
    }
    double whole = 0;
    for (const ViscousBranch& branch : best.first.branches) whole += branch.modulus_MPa;
    for (ViscousBranch& branch : best.first.branches)  // a branch without modulus would not move
      branch.modulus_MPa = std::max(branch.modulus_MPa, min_fraction * whole);
    return best.first;
  }

 private:
  /// Constants and branches, some of modulus 0, and the squares that are left.
  [[nodiscard]] std::pair<Start, double> solve(const std::vector<double>& constants, const std::vector<double>& times,
                                               const Eigen::MatrixXd& columns) const {
    const RelaxationProblem::Linear linear = problem_.linear(constants);
    Eigen::MatrixXd all(columns.rows(), linear.columns.cols() + columns.cols());
    all << linear.columns, columns;
    const VectorXd found = nonnegative_least_squares(all, linear.right, linear.signless);
    Start start{constants, {}};
    for (std::size_t i = 0; i < linear.constants.size(); ++i) start.constants[linear.constants[i]] = found[i];
    for (std::size_t i = 0; i < times.size(); ++i)
      start.branches.push_back({found[linear.columns.cols() + static_cast<Eigen::Index>(i)], times[i]});
    return {start, (all * found - linear.right).squaredNorm()};
  }

  /// jm is not linear: the best of a row of them, over the whole grid of times.
  void choose_limit() {
    constants_.assign(problem_.names().size(), 0);
    for (std::size_t c = 0; c < constants_.size(); ++c) constants_[c] = problem_.held(c).value_or(0);
    if (problem_.names().back() != "jm" || problem_.held(constants_.size() - 1)) return;
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> tried = constants_;
    for (int k = -6; k <= 8; ++k) {
      tried.back() = problem_.max_excess() * (1 + std::pow(10, k / 4.0));
      const double squares = solve(tried, grid_, columns_).second;
      if (squares < least) constants_ = tried, least = squares;
    }
  }

  static void merge_nearest(std::vector<ViscousBranch>& branches) {
    std::size_t nearest = 1;
    const auto gap = [&](std::size_t i) { return std::log(branches[i].time_s / branches[i - 1].time_s); };
    for (std::size_t i = 2; i < branches.size(); ++i)
      if (gap(i) < gap(nearest)) nearest = i;
    if (branches.size() < 2) return branches.clear();
    ViscousBranch &a = branches[nearest - 1], &b = branches[nearest];
    const double sum = a.modulus_MPa + b.modulus_MPa, fraction = b.modulus_MPa / sum;
    a = {sum, a.time_s * std::pow(b.time_s / a.time_s, fraction)};
    branches.erase(branches.begin() + static_cast<std::ptrdiff_t>(nearest));
  }

  const RelaxationProblem& problem_;
  const std::vector<double>& grid_;
  Eigen::MatrixXd columns_;
  std::vector<double> constants_;  // those that are not linear, as the starts have them
};

/// The fits with 0, 1, 2, ... branches, as long as they improve, or up to the requested number.
class Growth {
 public:
  Growth(const RelaxationProblem& problem, const std::vector<double>& grid, std::optional<std::size_t> requested)
      : problem_(problem) {
    for (const RelaxationRun& run : problem.runs())
      floor_ +=
          std::pow(finest_fraction * rms_of(problem.runs(), run.load_imposed) / problem.scale(run.load_imposed), 2) *
          static_cast<double>(run.time_s.size());
    const Starts starts(problem, grid);
    const std::size_t most = requested.value_or(std::max<std::size_t>(2, grid.size() * 3 / 8));
    const Eigen::Index max_unknowns = requested ? problem.rows() - 1 : problem.rows() / rows_per_unknown;
    for (std::size_t n = 0; n <= most && (n == 0 || unknowns_with(n) <= max_unknowns); ++n) {
      if (!add(n, starts) || (!requested && n >= fewest() + 2)) break;
    }
  }

  [[nodiscard]] const std::vector<Minimum>& minima() const { return minima_; }
  [[nodiscard]] double criterion(std::size_t n) const {
    const auto rows = static_cast<double>(problem_.rows());
    return rows * std::log((minima_[n].squares + floor_) / rows) +
           static_cast<double>(unknowns_with(n)) * std::log(rows);
  }
  /// Branches that no larger number is strongly better than.
  [[nodiscard]] std::size_t fewest() const {
    std::size_t best = 0;
    for (std::size_t n = 1; n < minima_.size(); ++n)
      if (criterion(n) < criterion(best) - strong_difference) best = n;
    return best;
  }
  /// To the last digits, which the search for the number of branches has no need of.
  void polish(std::size_t n) {
    constexpr double exact = 1e-14;
    minima_[n] = minimise(problem_, minima_[n].unknowns, exact).value();
  }
  /// Variance of the residuals.
  [[nodiscard]] double variance(std::size_t n) const {
    return minima_[n].squares / static_cast<double>(problem_.rows() - unknowns_with(n));
  }
  [[nodiscard]] Eigen::Index unknowns_with(std::size_t n) const { return problem_.free_constants() + 2 * n; }

 private:
  bool add(std::size_t n, const Starts& starts) {
    std::vector<Start> all{starts.merged(n)};
    if (n > 0) {
      const VectorXd& before = minima_.back().unknowns;
      all.push_back(starts.with_one_more(problem_.constants(before), problem_.element(before).branches));
    }
    std::optional<Minimum> best;
    for (const Start& start : all) {
      if (start.branches.size() != n) continue;
      std::optional<Minimum> found = minimise(problem_, problem_.unknowns(start.constants, start.branches));
      if (found && (!best || found->squares < best->squares)) best = std::move(found);
    }
    if (best) minima_.push_back(*best);
    return best.has_value();
  }

  const RelaxationProblem& problem_;
  double floor_ = 0;
  std::vector<Minimum> minima_;
};

/// Of the residuals of stresses, or of stretches, in their unit; none: no run has them.
std::optional<double> rms_left(const RelaxationProblem& problem, const VectorXd& unknowns, bool load_imposed) {
  const VectorXd residuals = problem.residuals(unknowns).value();
  double squares = 0, rows = 0;
  Eigen::Index at = 0;
  for (const RelaxationRun& run : problem.runs()) {
    const Eigen::Index size = run.time_s.size();
    if (run.load_imposed == load_imposed) {
      squares += residuals.segment(at, size).squaredNorm();
      rows += static_cast<double>(size);
    }
    at += size;
  }
  if (rows == 0) return std::nullopt;
  return problem.scale(load_imposed) * std::sqrt(squares / rows);
}

ElementFit fit_of_minimum(const RelaxationProblem& problem, const Growth& growth, std::size_t n) {
  const Minimum& minimum = growth.minima()[n];
  const VectorXd& unknowns = minimum.unknowns;
  const double deviation = std::sqrt(growth.variance(n));
  const auto estimate = [&](double value, Eigen::Index unknown) {
    const double own = deviation * minimum.deviations[unknown] * problem.slope(unknowns, unknown);
    return Estimate{value, std::isfinite(own) ? std::optional(own) : std::nullopt};
  };
  ElementFit fit{problem.element(unknowns), {}, {}, {}, {}, growth.criterion(n)};
  const std::vector<double> constants = problem.constants(unknowns);
  Eigen::Index at = 0;
  for (std::size_t c = 0; c < constants.size(); ++c)
    fit.constants.push_back(problem.held(c) ? Estimate{constants[c], {}} : estimate(constants[c], at++));
  for (const ViscousBranch& branch : fit.element.branches) {
    fit.branches.push_back({estimate(branch.modulus_MPa, at), estimate(branch.time_s, at + 1)});
    at += 2;
  }
  const auto faster = [](const auto& a, const auto& b) { return a.time_s.value < b.time_s.value; };
  std::sort(fit.branches.begin(), fit.branches.end(), faster);
  std::sort(fit.element.branches.begin(), fit.element.branches.end(),
            [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  fit.rms_stress_MPa = rms_left(problem, unknowns, false);
  fit.rms_stretch = rms_left(problem, unknowns, true);
  return fit;
}

/// The fewest branches whose variance is that of repeated runs, within three deviations of it.
std::optional<std::size_t> fewest_by_repeats(const RelaxationProblem& problem, const Growth& growth,
                                             const RelaxationFit& fit) {
  double squares = 0, freedoms = 0;
  for (const bool load_imposed : {false, true}) {
    const std::optional<Repeats> repeats = repeats_of(problem.runs(), load_imposed);
    if (!repeats) continue;
    squares += std::pow(repeats->deviation / problem.scale(load_imposed), 2) * static_cast<double>(repeats->freedoms);
    freedoms += static_cast<double>(repeats->freedoms);
  }
  if (freedoms == 0) return std::nullopt;
  const double most = squares / freedoms * (1 + 3 * std::sqrt(2 / freedoms));
  for (std::size_t n = 0; n < fit.tried.size(); ++n)
    if (growth.variance(n) <= most) return n;
  return std::nullopt;
}

void check_runs(const std::vector<RelaxationRun>& runs) {
  if (runs.empty()) throw InvalidInput("there is no test");
  for (const RelaxationRun& run : runs)
    if (run.time_s.size() < 2 || run.stretch.size() != run.time_s.size() || run.stress_MPa.size() != run.time_s.size())
      throw InvalidInput({run.file}, run.name + ": a test needs two rows or more");
  if (rms_of(runs, true) == 0) throw InvalidInput({runs.front().file}, "no stretch differs from 1: nothing was tested");
  if (rms_of(runs, false) == 0) throw InvalidInput({runs.front().file}, "no stress differs from 0");
}

/// What flows without end has no shape at rest.
void check_modulus(const MaxwellElement& element) {
  constexpr double least = 1e-3;  // of the modulus at once
  const double relaxed = element.law.youngs_modulus() / 3;
  double at_once = relaxed;
  for (const ViscousBranch& branch : element.branches) at_once += branch.modulus_MPa;
  if (relaxed > least * at_once) return;
  throw InvalidInput(
      "the tests show no modulus of the law itself, beside the branches: let them last until nothing relaxes any more, "
      "or give the law's constants");
}

/// A test of one stretch determines one constant of the law.
void check_constants(const RelaxationProblem& problem) {
  std::vector<double> constants;
  std::string fitted;
  for (std::size_t c = 0; c < problem.names().size(); ++c) {
    const double start = problem.names()[c] == "jm" ? 4 * problem.max_excess() : 1;
    constants.push_back(problem.held(c).value_or(start));
    if (!problem.held(c)) fitted += (fitted.empty() ? "" : ", ") + problem.names()[c];
  }
  if (problem.tells_constants(constants)) return;
  throw InvalidInput("the tests do not determine the constants " + fitted +
                     " apart: stretch to several lengths, give constants that are known, or take a law with fewer");
}

/// Weights of stresses relative to stretches, where both are responses: their residuals with as many branches as the
/// data support.
void weigh(RelaxationProblem& problem, const Growth& growth) {
  const VectorXd& unknowns = growth.minima()[growth.fewest()].unknowns;
  const auto left = [&](bool load_imposed) {
    return std::max(rms_left(problem, unknowns, load_imposed).value(),
                    finest_fraction * rms_of(problem.runs(), load_imposed));
  };
  problem.set_scales(left(false), left(true));
}

}  // namespace

RelaxationFit fit_relaxation(const std::vector<RelaxationRun>& runs, const RelaxationOptions& options) {
  check_runs(runs);
  const std::array<double, 2> times = resolved_times(runs);
  const std::vector<double> grid = grid_between(times);
  RelaxationProblem problem(runs, options.law, options.held, times);
  if (problem.rows() <= problem.free_constants())
    throw InvalidInput("the tests have fewer rows than the law has constants");
  problem.set_scales(rms_of(runs, false), rms_of(runs, true));
  check_constants(problem);
  std::optional<Growth> growth(std::in_place, problem, grid, options.branches);
  const auto loaded =
      std::count_if(runs.begin(), runs.end(), [](const RelaxationRun& run) { return run.load_imposed; });
  if (growth->minima().empty()) throw InvalidInput("no constants of the law bear the stresses of the tests");
  if (loaded > 0 && loaded < std::ssize(runs)) {
    weigh(problem, *growth);
    growth.emplace(problem, grid, options.branches);
  }
  RelaxationFit fit;
  fit.shortest_s = times[0];
  fit.longest_s = times[1];
  for (std::size_t n = 0; n < growth->minima().size(); ++n) fit.tried.push_back(fit_of_minimum(problem, *growth, n));
  if (const auto repeats = repeats_of(runs, false)) fit.repeat_MPa = repeats->deviation;
  if (const auto repeats = repeats_of(runs, true)) fit.repeat_stretch = repeats->deviation;
  fit.chosen = growth->fewest();
  if (const auto enough = fewest_by_repeats(problem, *growth, fit); enough && *enough <= fit.chosen) {
    fit.chosen = *enough;
    fit.by = BranchCount::repeats;
  }
  if (options.branches) {
    if (*options.branches >= fit.tried.size())
      throw InvalidInput("the tests carry " + counted(fit.tried.size() - 1, "branch", "branches") + " at most, not " +
                         std::to_string(*options.branches));
    fit.chosen = *options.branches;
    fit.by = BranchCount::requested;
  }
  growth->polish(fit.chosen);
  fit.tried[fit.chosen] = fit_of_minimum(problem, *growth, fit.chosen);
  check_modulus(fit.best().element);
  return fit;
}

}  // namespace softkin::calibration
