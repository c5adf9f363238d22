#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/fit.hpp>

namespace softkin::estimate {

namespace {

constexpr double first_damping = 1e-3;
/// Slopes of another shape are used while each step by them is so much shorter than the one before.
constexpr double contraction = 0.15;
/// Longest move of a vertex that a step foretells, over the diagonal: equilibria farther away take long to find, and
/// slopes do not tell of them.
constexpr double longest_move = 0.08, least_reach = 1e-3;
/// Steps to where no equilibrium is found, as where readings contradict each other: each takes as long as many others.
constexpr int most_failures = 3;
/// After so many of all fits of an update the first ends one.
constexpr int many_failures = 12;
/// Longest step of a place, over the deviation of one that may be anywhere on its patch.
constexpr double longest_slide = 1;
/// Steps to the least cost as it is foretold, and the length at which they end.
constexpr int most_inner = 30;
constexpr double inner_length = 0.01;

/// Steps so far, and what one more would leave.
struct Pace {
  Damping hold{1};                                        // of steps to other shapes, over what is known before
  double last = std::numeric_limits<double>::infinity();  // length of the last step by these slopes
  double rate = 1, of_length = 1;  // lengths of two steps, the next over the last, as last seen; that of the last
  double reach = 1;                // of longest_move: less where no equilibrium was found that far away
  int failures = 0;
  bool fresh = false;  // are slopes of this guess?

  void renewed() {
    fresh = true;
    last = std::numeric_limits<double>::infinity();
  }
  void see(double length) {
    if (!std::isfinite(last)) return;
    rate = std::min(1.0, length / last);
    of_length = last;
  }
  /// Of old slopes in proportion to the step, of fresh ones to its square.
  [[nodiscard]] double left_of(double length) const {
    return rate * length * (fresh ? std::min(1.0, length / of_length) : 1);
  }
  void advanced(double length) {
    last = fresh && hold.value() > 0 ? std::numeric_limits<double>::infinity() : length;
    hold.relax();
    reach = std::min(1.0, 2 * reach);
    fresh = false;
  }
  /// False where that leads nowhere.
  bool shorten(bool lost, int most) {
    if (lost) return ++failures < most && (reach /= 4) > least_reach;
    return hold.tighten();
  }
};

double length_of(const Eigen::VectorXd& step, const Normal& normal) {
  return std::sqrt(std::max(0.0, step.dot(normal.matrix * step)));
}

}  // namespace

/// Numbers at an end of their range that want to leave it stay.
Eigen::VectorXd Fitter::step_of(const Guess& at, const Normal& normal, double damping) const {
  Eigen::MatrixXd matrix = normal.matrix;
  Eigen::VectorXd right = -normal.gradient;
  matrix.diagonal() *= 1 + damping;
  const Variables& variables = problem_.variables();
  for (Index i = 0; i < variables.numbers(); ++i) {
    const Variable& v = variables.all()[i];
    const bool held = (at.values[i] <= v.low && right[i] < 0) || (at.values[i] >= v.high && right[i] > 0);
    if (!held) continue;
    matrix.row(i).setZero();
    matrix.col(i).setZero();
    matrix(i, i) = 1;
    right[i] = 0;
  }
  Eigen::VectorXd step = solve_symmetric(matrix, right);
  for (std::size_t f = 0; f < variables.forces().size(); ++f) {
    auto slide = step.segment<2>(variables.numbers() + 2 * f);
    const double most = longest_slide * std::sqrt(variables.forces()[f].patch->covariance().trace());
    if (slide.norm() > most) slide *= most / slide.norm();
  }
  return step;
}

Fit Fitter::refine(Guess from, const Readings& readings, std::shared_ptr<const Nearby> known,
                   const Actuation* before) const {
  return refine_by(std::move(from), readings, {std::move(known), before, options_.max_iterations});
}

void Fitter::set_normal(Fit& fit, const Readings& readings) const {
  fit.slopes = problem_.slopes(*fit.nearby, fit.told);
  fit.normal = problem_.normal(fit.told, fit.slopes, readings);
}

/// Of the readings as fit.nearby has them from fit.at on, where it is held by so many times what is known before.
Guess Fitter::least(const Fit& fit, const Readings& readings, double holding) const {
  Guess at{fit.at.values, fit.at.places, {}, fit.at.computed};
  const auto normal_at = [&](const Guess& guess) {
    return problem_.normal(guess, problem_.slopes(*fit.nearby, guess), readings);
  };
  Normal normal = normal_at(at);
  const Eigen::MatrixXd hold = holding * readings.known.cost(problem_.variables(), fit.at.values, fit.at.places).matrix;
  normal.matrix += hold;
  Damping inner(first_damping);
  for (int i = 0; i < most_inner; ++i) {
    const Eigen::VectorXd step = step_of(at, normal, inner.value());
    if (!(length_of(step, normal) > inner_length)) break;
    Guess next{{}, {}, {}, fit.at.computed};
    problem_.move(at, step, next.values, next.places);
    problem_.follow(*fit.nearby, fit.at, next, {}, next.computed, nullptr);
    Normal there = normal_at(next);
    const Eigen::VectorXd way = problem_.way(fit.at, next);
    there.matrix += hold;
    there.gradient += hold * way;
    there.cost += way.dot(hold * way);
    if (there.cost < normal.cost) {
      at = std::move(next);
      normal = std::move(there);
      inner.relax();
    } else if (!inner.tighten()) {
      break;
    }
  }
  return at;
}

Fit Fitter::foretell(Guess from, const Readings& readings, std::shared_ptr<const Nearby> nearby,
                     const Actuation& before) const {
  Fit fit{std::move(from), std::move(nearby)};
  const Guess same = fit.at;
  problem_.follow(*fit.nearby, same, same, readings.commands - before, fit.at.computed, nullptr);
  fit.told = least(fit, readings, 0);
  set_normal(fit, readings);
  fit.converged = true;
  return fit;
}

bool Fitter::exhausted() const {
  return problem_.lost() - lost_before_ > many_failures;
}

/// Slopes of where the fit is.
void Fitter::renew(Fit& fit) const {
  fit.nearby = std::make_shared<const Nearby>(problem_.nearby(fit.at));
}

/// Where a search begins.
///
/// elsewhere  by how much the commands differ from those of the equilibrium; empty: they do not
Fit Fitter::begin(Guess from, const Readings& readings, const Start& start, Actuation& elsewhere) const {
  Fit fit{std::move(from), start.nearby};
  if (fit.nearby == nullptr) renew(fit);
  if (start.before != nullptr) {
    elsewhere = readings.commands - *start.before;
    problem_.follow(*fit.nearby, fit.at, fit.at, elsewhere, fit.at.computed, nullptr);
  }
  return fit;
}

/// A step is gone to first order alone where what that leaves, as the last steps shrank, is below the accuracy.
Fit Fitter::refine_by(Guess from, const Readings& readings, const Start& start) const {
  Actuation elsewhere;
  Fit fit = begin(std::move(from), readings, start, elsewhere);
  Pace pace;
  pace.fresh = start.nearby == nullptr;
  while (true) {
    fit.told = least(fit, readings, pace.hold.value());
    set_normal(fit, readings);
    const double length = length_of(problem_.way(fit.at, fit.told), fit.normal);
    if (!std::isfinite(length)) break;
    pace.see(length);
    fit.converged = elsewhere.size() == 0 && pace.hold.value() == 0 && pace.left_of(length) <= options_.accuracy;
    if (fit.converged) return fit;
    if (fit.iterations >= start.most_iterations) break;
    if (!pace.fresh && elsewhere.size() == 0 && length > contraction * pace.last) {
      renew(fit);
      pace.renewed();
      continue;
    }
    ++fit.iterations;
    Guess next = stepped(fit, readings, elsewhere, pace.reach);
    if (next.equilibrium.report.stopped) {
      fit.interrupted = true;
      return fit;
    }
    // what was foretold of other commands may be off by more than a short step gains
    const bool short_step = elsewhere.size() > 0 && length <= 1;
    if (next.solved() && (short_step || problem_.cost(next, readings) < problem_.cost(fit.at, readings))) {
      fit.at = std::move(next);
      elsewhere.resize(0);
      pace.advanced(length);
      continue;
    }
    if (elsewhere.size() > 0) {  // begin under these commands
      fit.at = problem_.solve(readings.commands, fit.at.values, fit.at.places, &fit.at, progress_);
      elsewhere.resize(0);
      if (!fit.at.solved()) return fit;
      pace.fresh = false;
    }
    if (!pace.fresh) {
      renew(fit);
      pace.renewed();
    }
    if (!pace.shorten(!next.solved(), exhausted() ? 1 : most_failures)) break;
  }
  fit.told = {fit.at.values, fit.at.places, {}, fit.at.computed};
  set_normal(fit, readings);
  return fit;
}

/// The equilibrium at fit.told, or on the way there as far as may be foretold, from where it is foretold.
Guess Fitter::stepped(const Fit& fit, const Readings& readings, const Actuation& elsewhere, double reach) const {
  const double most = reach * longest_move * problem_.variables().model().diagonal_mm;
  const double share = most / problem_.largest_move(*fit.nearby, fit.at, fit.told);
  Guess to = fit.told;
  if (share < 1) problem_.move(fit.at, share * problem_.way(fit.at, fit.told), to.values, to.places);
  Eigen::VectorXd computed = fit.at.computed;
  State foretold = fit.at.equilibrium.state;
  problem_.follow(*fit.nearby, fit.at, to, elsewhere, computed, &foretold);
  foretold.actuation = problem_.variables().actuation(readings.commands, to.values, to.places);
  return problem_.solve(readings.commands, to.values, to.places, &fit.at, progress_, &foretold);
}

}  // namespace softkin::estimate
