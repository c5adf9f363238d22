#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/fit.hpp>

namespace softkin::estimate {

namespace {

constexpr double first_damping = 1e-3, most_damping = 1e9;
/// Slopes of another shape are used while each step by them is so much shorter than the one before.
constexpr double contraction = 0.15;
/// Iterations by which places that rank well are followed, before the best of them is chosen.
constexpr int followed = 6;
/// Longest step of a place, over the deviation of one that may be anywhere on its patch.
constexpr double longest_slide = 1;
/// Bounds of the share of its way that a place goes as its force changes.
constexpr double least_slide = 0.25;
/// Shares of the force that a linear fit wants: the first that has an equilibrium is where a search begins.
constexpr double begun_shares[] = {1, 0.5, 0.25, 0.1};

/// What a force does far from it is nearly linear in the force and in its moment: a place goes such a share of its way
/// that the moment changes as the step wants.
double slide_share(const FreeForce& force, const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  double product = 0, square = 0;
  for (const Index variable : force.variables) {
    if (variable < 0) continue;
    product += before[variable] * after[variable];
    square += after[variable] * after[variable];
  }
  return square > 0 ? std::clamp(product / square, least_slide, 1 / least_slide) : 1;
}

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
    const Variable& v = variables.all()[static_cast<std::size_t>(i)];
    const bool held = (at.values[i] <= v.low && right[i] < 0) || (at.values[i] >= v.high && right[i] > 0);
    if (!held) continue;
    matrix.row(i).setZero();
    matrix.col(i).setZero();
    matrix(i, i) = 1;
    right[i] = 0;
  }
  Eigen::VectorXd step = solve_symmetric(matrix, right);
  for (std::size_t f = 0; f < variables.forces().size(); ++f) {
    auto slide = step.segment<2>(variables.numbers() + 2 * static_cast<Index>(f));
    slide *=
        slide_share(variables.forces()[f], at.values, variables.clamped(at.values + step.head(variables.numbers())));
    const double most = longest_slide * std::sqrt(variables.forces()[f].patch->covariance().trace());
    if (slide.norm() > most) slide *= most / slide.norm();
  }
  return step;
}

Fit Fitter::refine(Guess from, const Readings& readings, const Slopes* known, const Actuation* before) const {
  return refine_by(std::move(from), readings, known, before, options_.max_iterations);
}

Fit Fitter::refine_by(Guess from, const Readings& readings, const Slopes* known, const Actuation* before,
                      int most_iterations) const {
  Fit fit{std::move(from)};
  bool fresh = known == nullptr, foretold = before != nullptr;
  fit.slopes = fresh ? problem_.slopes(fit.at) : *known;
  if (foretold) fit.at.computed += fit.slopes.by_commands * (readings.commands - *before);
  double damping = 0, last = std::numeric_limits<double>::infinity();
  const auto renew = [&] {
    if (foretold) fit.at = problem_.solve(readings.commands, fit.at.values, fit.at.places, &fit.at, progress_);
    foretold = false;
    if (fit.at.solved()) fit.slopes = problem_.slopes(fit.at);
    fresh = true;
    last = std::numeric_limits<double>::infinity();
    return fit.at.solved();
  };
  while (fit.iterations < most_iterations) {
    fit.normal = problem_.normal(fit.at, fit.slopes.of_readings, readings);
    const Eigen::VectorXd step = step_of(fit.at, fit.normal, damping);
    const double length = length_of(step, fit.normal);
    if (!std::isfinite(length)) break;
    fit.converged = length <= options_.accuracy && !foretold;
    if (fit.converged) break;
    if (!fresh && !foretold && length > contraction * last) {
      if (!renew()) break;
      continue;
    }
    ++fit.iterations;
    Eigen::VectorXd values;
    std::vector<Place> places;
    problem_.move(fit.at, step, values, places);
    Guess next = problem_.solve(readings.commands, values, places, &fit.at, progress_);
    if (next.equilibrium.report.stopped) {
      fit.interrupted = true;
      return fit;
    }
    const bool small = foretold && length <= options_.accuracy;  // the step is no more than what was foretold is off
    if (next.solved() && (small || problem_.cost(next, readings) < fit.normal.cost)) {
      fit.at = std::move(next);
      last = fresh && damping > 0 ? std::numeric_limits<double>::infinity() : std::max(length, options_.accuracy);
      damping = damping > first_damping ? damping / 16 : 0;
      fresh = foretold = false;
      continue;
    }
    if (!fresh && !renew()) break;
    damping = damping == 0 ? first_damping : 8 * damping;
    if (damping > most_damping) break;
  }
  return fit;
}

Fitter::Survey Fitter::survey(std::size_t force, const Guess& at) const {
  const Variables& variables = problem_.variables();
  Survey survey{at, problem_.slopes(at), {}, variables.forces()[force].patch->spread(options_.candidates)};
  std::vector<Actuation> changes;
  for (const Place& place : survey.places)
    for (Actuation& change : variables.changes_at(force, place)) changes.push_back(std::move(change));
  survey.theirs = problem_.slopes(at, changes);
  survey.theirs.moves.clear();
  return survey;
}

/// For each candidate the least cost by slopes at one shape, with the force where it is as an unknown.
std::vector<Fitter::Ranked> Fitter::rank(std::size_t force, const Survey& survey, const Readings& readings) const {
  const Variables& variables = problem_.variables();
  const auto axes = static_cast<Index>(survey.theirs.of_readings.cols()) / static_cast<Index>(survey.places.size());
  std::vector<Ranked> ranked;
  for (std::size_t p = 0; p < survey.places.size(); ++p) {
    Guess there = survey.at;
    there.places[force] = survey.places[p];
    Eigen::MatrixXd slopes = survey.own.of_readings;
    Index next = static_cast<Index>(p) * axes;
    for (const Index variable : variables.forces()[force].variables)
      if (variable >= 0) slopes.col(variable) = survey.theirs.of_readings.col(next++);
    slopes.rightCols(variables.columns() - variables.numbers()).setZero();
    const Normal normal = problem_.normal(there, slopes, readings);
    const Index count = variables.numbers();
    const Eigen::VectorXd step =
        -solve_symmetric(normal.matrix.topLeftCorner(count, count), normal.gradient.head(count));
    const double cost = normal.cost + normal.gradient.head(count).dot(step);
    ranked.push_back({cost, variables.clamped(survey.at.values + step), survey.places[p]});
  }
  std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) { return a.cost < b.cost; });
  return ranked;
}

Guess Fitter::begun(const Guess& at, const Ranked& ranked, std::size_t force, const Readings& readings) const {
  std::vector<Place> places = at.places;
  places[force] = ranked.place;
  for (const double share : begun_shares) {
    const Eigen::VectorXd values = at.values + share * (ranked.values - at.values);
    Guess guess = problem_.solve(readings.commands, values, places, &at, progress_);
    if (guess.solved() || guess.equilibrium.report.stopped) return guess;
  }
  return {};
}

/// The places that rank best are followed a little, the best of them to the end.
std::optional<Fit> Fitter::best_of(std::size_t force, const Survey& survey, const Readings& readings) const {
  const std::vector<Ranked> ranked = rank(force, survey, readings);
  std::optional<Fit> found;
  for (std::size_t i = 0; i < std::min(ranked.size(), static_cast<std::size_t>(options_.starts)); ++i) {
    Guess guess = begun(survey.at, ranked[i], force, readings);
    if (!guess.solved()) continue;
    Fit fit = refine_by(std::move(guess), readings, nullptr, nullptr, followed);
    if (fit.interrupted) return fit;
    if (!found || fit.normal.cost < found->normal.cost) found = std::move(fit);
  }
  if (!found || found->converged) return found;
  Fit fit = refine(std::move(found->at), readings, &found->slopes);
  fit.iterations += found->iterations;
  return fit;
}

const Fitter::Survey& Fitter::first(const Readings& readings) const {
  if (first_) return *first_;
  const Variables& variables = problem_.variables();
  std::vector<Place> places;
  for (const FreeForce& force : variables.forces()) places.push_back(force.patch->nearest(force.patch->middle()));
  const Guess at = problem_.solve(readings.commands, variables.means(), places, nullptr, progress_);
  if (!at.solved())
    first_ = Survey{at, {}, {}, {}};
  else if (variables.forces().empty())
    first_ = Survey{at, problem_.slopes(at), {}, {}};
  else
    first_ = survey(0, at);
  return *first_;
}

double Fitter::forecast(const Readings& readings) const {
  const Survey& from = first(readings);
  if (!from.at.solved()) return std::numeric_limits<double>::infinity();
  if (!from.places.empty()) return rank(0, from, readings).front().cost;
  const Normal normal = problem_.normal(from.at, from.own.of_readings, readings);
  return normal.cost - normal.gradient.dot(solve_symmetric(normal.matrix, normal.gradient));
}

Fit Fitter::search(const Readings& readings) const {
  const Variables& variables = problem_.variables();
  (void)first(readings);
  Fit best{first_->at};
  best.interrupted = best.at.equilibrium.report.stopped;
  if (!best.at.solved()) return best;
  if (variables.forces().empty()) return refine(best.at, readings, &first_->own);
  for (std::size_t f = 0; f < variables.forces().size(); ++f) {
    std::optional<Fit> found = best_of(f, f == 0 ? *first_ : survey(f, best.at), readings);
    if (!found) return best;
    best = std::move(*found);
    if (best.interrupted) return best;
  }
  return best;
}

}  // namespace softkin::estimate
