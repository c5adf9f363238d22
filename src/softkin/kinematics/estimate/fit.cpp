#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/fit.hpp>

namespace softkin::estimate {

namespace {

constexpr double first_damping = 1e-3;
/// The slopes of another shape are reused while each step with them is shorter than the one before by this factor.
constexpr double contraction = 0.15;
/// Largest displacement of a vertex that a step predicts, relative to the diagonal of the robot: equilibria farther
/// away take long to find, and first-order predictions of them are not valid.
constexpr double longest_move = 0.08, min_reach = 1e-3;
/// Maximum number of steps to guesses without an equilibrium, as where readings contradict each other: each takes as
/// long as many others.
constexpr int max_failures = 3;
/// After this number of failures in all fits of an update, the first failure of a fit ends it.
constexpr int many_failures = 12;
/// Longest step of a place, relative to the standard deviation of a place that may be anywhere on its patch.
constexpr double longest_slide = 1;
/// Maximum number of steps to the minimum of the predicted cost, and the step length at which they end.
constexpr int max_inner = 30;
constexpr double inner_length = 0.01;

/// Step-size control: the steps done, and an estimate of the error that one more step leaves.
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
  /// The error after a step is proportional to its length with old slopes, and to its square with fresh ones.
  [[nodiscard]] double left_of(double length) const {
    return rate * length * (fresh ? std::min(1.0, length / of_length) : 1);
  }
  void advanced(double length) {
    last = fresh && hold.value() > 0 ? std::numeric_limits<double>::infinity() : length;
    hold.relax();
    reach = std::min(1.0, 2 * reach);
    fresh = false;
  }
  /// Returns false where shorter steps are exhausted.
  bool shorten(bool lost, int most) {
    if (lost) return ++failures < most && (reach /= 4) > min_reach;
    return hold.tighten();
  }
};

double length_of(const Eigen::VectorXd& step, const Normal& normal) {
  return std::sqrt(std::max(0.0, step.dot(normal.matrix * step)));
}

}  // namespace

/// Numbers at an end of their range stay there where the step would leave the range.
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
  fit.slopes = problem_.slopes(*fit.nearby, fit.estimated);
  fit.normal = problem_.normal(fit.estimated, fit.slopes, readings);
}

/// Minimises the cost of the readings that fit.nearby predicts from fit.at. `holding` times the prior information
/// penalises the distance from fit.at.
Guess Fitter::least(const Fit& fit, const Readings& readings, double holding) const {
  Guess at{fit.at.values, fit.at.places, {}, fit.at.computed};
  const auto normal_at = [&](const Guess& guess) {
    return problem_.normal(guess, problem_.slopes(*fit.nearby, guess), readings);
  };
  Normal normal = normal_at(at);
  const Eigen::MatrixXd hold = holding * readings.known.cost(problem_.variables(), fit.at.values, fit.at.places).matrix;
  normal.matrix += hold;
  Damping inner(first_damping);
  for (int i = 0; i < max_inner; ++i) {
    const Eigen::VectorXd step = step_of(at, normal, inner.value());
    if (!(length_of(step, normal) > inner_length)) break;
    Guess next{{}, {}, {}, fit.at.computed};
    problem_.move(at, step, next.values, next.places);
    problem_.follow(*fit.nearby, fit.at, next, {}, next.computed, nullptr);
    Normal there = normal_at(next);
    const Eigen::VectorXd path = problem_.path(fit.at, next);
    there.matrix += hold;
    there.gradient += hold * path;
    there.cost += path.dot(hold * path);
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

Fit Fitter::predict(Guess from, const Readings& readings, std::shared_ptr<const Nearby> nearby,
                    const Actuation& before) const {
  Fit fit{std::move(from), std::move(nearby)};
  const Guess same = fit.at;
  problem_.follow(*fit.nearby, same, same, readings.commands - before, fit.at.computed, nullptr);
  fit.estimated = least(fit, readings, 0);
  set_normal(fit, readings);
  fit.converged = true;
  return fit;
}

bool Fitter::exhausted() const {
  return problem_.lost() - lost_before_ > many_failures;
}

/// Computes the slopes at the current guess of the fit.
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

/// The last step is done to first order alone where its error, estimated from how the last steps shrank, is below the
/// accuracy.
Fit Fitter::refine_by(Guess from, const Readings& readings, const Start& start) const {
  Actuation elsewhere;
  Fit fit = begin(std::move(from), readings, start, elsewhere);
  Pace pace;
  pace.fresh = start.nearby == nullptr;
  while (true) {
    fit.estimated = least(fit, readings, pace.hold.value());
    set_normal(fit, readings);
    const double length = length_of(problem_.path(fit.at, fit.estimated), fit.normal);
    if (!std::isfinite(length)) break;
    pace.see(length);
    fit.converged = elsewhere.size() == 0 && pace.hold.value() == 0 && pace.left_of(length) <= options_.accuracy;
    if (fit.converged) return fit;
    if (fit.iterations >= start.max_iterations) break;
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
    // the prediction for other commands may have an error larger than the reduction by a short step
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
    if (!pace.shorten(!next.solved(), exhausted() ? 1 : max_failures)) break;
  }
  fit.estimated = {fit.at.values, fit.at.places, {}, fit.at.computed};
  set_normal(fit, readings);
  return fit;
}

/// Solves for the equilibrium at fit.estimated, or at the farthest guess towards it that may be predicted; the
/// predicted state is the initial guess.
Guess Fitter::stepped(const Fit& fit, const Readings& readings, const Actuation& elsewhere, double reach) const {
  const double most = reach * longest_move * problem_.variables().model().diagonal_mm;
  const double fraction = most / problem_.largest_move(*fit.nearby, fit.at, fit.estimated);
  Guess to = fit.estimated;
  if (fraction < 1) problem_.move(fit.at, fraction * problem_.path(fit.at, fit.estimated), to.values, to.places);
  Eigen::VectorXd computed = fit.at.computed;
  State predicted = fit.at.equilibrium.state;
  problem_.follow(*fit.nearby, fit.at, to, elsewhere, computed, &predicted);
  predicted.actuation = problem_.variables().actuation(readings.commands, to.values, to.places);
  return problem_.solve(readings.commands, to.values, to.places, &fit.at, progress_, &predicted);
}

}  // namespace softkin::estimate
