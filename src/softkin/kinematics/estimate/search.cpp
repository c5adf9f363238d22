#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/search.hpp>

namespace softkin::estimate {

namespace {

/// Number of iterations with which places that rank well are refined, before the best of them is chosen.
constexpr int followed = 6;
/// Minimum distance of the places that are refined, relative to the standard deviation of a place that may be anywhere
/// on its patch.
constexpr double apart = 0.35;
/// Largest displacement of a vertex, relative to the diagonal, after which a survey is still used to rank places.
constexpr double nearby_shape = 0.02;
/// Number of places of a survey whose cost does not depend on that number.
constexpr std::size_t many = 300;
/// How often a fit is started again at another place, and by how much its predicted cost must be lower.
constexpr int max_relocations = 3;
constexpr double worthwhile = 2;
/// Minimum effective number of places of a survey, by their weights, from which a covariance is estimated.
constexpr double min_places = 5;
/// Largest predicted displacement of a marker by the force with which a search begins, relative to the diagonal.
constexpr double longest_begin = 0.1;
/// Fractions of that force: a search begins at the first that has an equilibrium.
constexpr double begun_fractions[] = {1, 0.5, 0.1};

/// Returns the logarithm of the determinant of a positive definite matrix.
double log_determinant(const Eigen::MatrixXd& matrix) {
  double sum = 0;
  for (const double value : symmetric_eigen(matrix).values) sum += std::log(std::max(value, 1e-300));
  return sum;
}

}  // namespace

Survey Searcher::survey(std::size_t force, const Guess& at, std::shared_ptr<const Nearby> own) const {
  const Variables& variables = problem_.variables();
  const Patch& patch = *variables.forces()[force].patch;
  const Eigen::MatrixXd by_nodes = problem_.by_node_forces(at, force);
  Survey survey{{}, at, std::move(own), {}, {}, by_nodes.cols() > 0};
  survey.places = patch.spread(survey.whole ? many : options_.candidates);
  if (!survey.whole) {
    std::vector<Actuation> changes;
    for (const Place& place : survey.places)
      for (Actuation& change : variables.changes_at(force, place)) changes.push_back(std::move(change));
    survey.theirs = problem_.slopes(at, changes).of_readings;
    return survey;
  }
  std::vector<Index> axes;
  for (Index axis = 0; axis < 3; ++axis)
    if (variables.forces()[force].variables[axis] >= 0) axes.push_back(axis);
  const Index count = axes.size();
  survey.theirs.setZero(by_nodes.rows(), count * std::ssize(survey.places));
  for (std::size_t p = 0; p < survey.places.size(); ++p) {
    const Patch::Fractions fractions = patch.fractions(survey.places[p]);
    for (std::size_t i = 0; i < fractions.nodes.size(); ++i)
      for (Index k = 0; k < count; ++k)
        survey.theirs.col(p * count + k) += fractions.fractions[i] * by_nodes.col(3 * fractions.nodes[i] + axes[k]);
  }
  return survey;
}

/// Returns for each candidate place the minimum cost by the slopes at one shape, with the force at that place as an
/// unknown. The force that acts at the current place is removed.
std::vector<Searcher::Ranked> Searcher::rank(std::size_t force, const Survey& survey, const Readings& readings) const {
  const Variables& variables = problem_.variables();
  const std::array<Index, 3>& components = variables.forces()[force].variables;
  const Index axes = survey.theirs.cols() / std::ssize(survey.places);
  const Eigen::MatrixXd own = problem_.slopes(*survey.own, survey.at);
  Eigen::VectorXd without = survey.at.computed;
  for (const Index variable : components)
    if (variable >= 0) without -= survey.at.values[variable] * own.col(variable);
  std::vector<Ranked> ranked;
  for (std::size_t p = 0; p < survey.places.size(); ++p) {
    Guess there{survey.at.values, survey.at.places, {}, without};
    there.places[force] = survey.places[p];
    Eigen::MatrixXd slopes = own;
    Eigen::VectorXd reach = Eigen::VectorXd::Zero(own.rows());
    Index next = p * axes;
    for (const Index variable : components) {
      if (variable < 0) continue;
      slopes.col(variable) = survey.theirs.col(next++);
      there.computed += there.values[variable] * slopes.col(variable);
    }
    slopes.middleCols(variables.numbers() + 2 * force, 2).setZero();
    const Normal normal = problem_.normal(there, slopes, readings);
    const Index count = variables.numbers();
    Ranked each{0, {}, survey.places[p], 0, normal.matrix.topLeftCorner(count, count)};
    const Eigen::VectorXd step = -solve_symmetric(each.matrix, normal.gradient.head(count));
    each.cost = normal.cost + normal.gradient.head(count).dot(step);
    each.values = variables.clamped(survey.at.values + step);
    for (const Index variable : components)
      if (variable >= 0) reach += each.values[variable] * slopes.col(variable);
    for (std::size_t r = 0; r < problem_.columns().size(); ++r)
      if (problem_.columns()[r].marker >= 0) each.reach = std::max(each.reach, std::abs(reach[r]));
    ranked.push_back(std::move(each));
  }
  return ranked;
}

Guess Searcher::begun(const Guess& at, const Ranked& ranked, std::size_t force, const Readings& readings) const {
  std::vector<Place> places = at.places;
  places[force] = ranked.place;
  const double most = longest_begin * problem_.variables().model().diagonal_mm;
  const double near = ranked.reach > most ? most / ranked.reach : 1;
  for (const double fraction : begun_fractions) {
    const Eigen::VectorXd values = at.values + near * fraction * (ranked.values - at.values);
    Guess guess = problem_.solve(readings.commands, values, places, &at, progress_);
    if (guess.solved() || guess.equilibrium.report.stopped) return guess;
  }
  return {};
}

/// Returns the best-ranked places that are not close to one of better rank: refinement would lead to the same result.
std::vector<Searcher::Ranked> Searcher::best_apart(std::size_t force, std::vector<Ranked> ranked) const {
  const Patch& patch = *problem_.variables().forces()[force].patch;
  const Points& rest = problem_.variables().model().rest;
  std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) { return a.cost < b.cost; });
  const double far = apart * std::sqrt(patch.covariance().trace());
  std::vector<Ranked> best;
  for (Ranked& each : ranked) {
    if (best.size() == static_cast<std::size_t>(options_.starts)) break;
    const bool beside = std::any_of(best.begin(), best.end(), [&](const Ranked& better) {
      return (patch.at(better.place, rest) - patch.at(each.place, rest)).norm() < far;
    });
    if (!beside) best.push_back(std::move(each));
  }
  return best;
}

/// Refines the best-ranked places with a few iterations, and the best of them until it converges.
std::optional<Fit> Searcher::best_of(std::size_t force, const Survey& survey, const Readings& readings) const {
  std::optional<Fit> found;
  for (const Ranked& each : best_apart(force, rank(force, survey, readings))) {
    Guess guess = begun(survey.at, each, force, readings);
    if (!guess.solved()) continue;
    Fit fit = fitter_.refine_by(std::move(guess), readings, {.max_iterations = followed});
    if (fit.interrupted) return fit;
    if (!found || fit.normal.cost < found->normal.cost) found = std::move(fit);
  }
  if (!found || found->converged) return found;
  Fit fit = fitter_.refine(std::move(found->at), readings, found->nearby);
  fit.iterations += found->iterations;
  return fit;
}

/// Returns the stored survey where its shape is near enough, else a new one.
const Survey& Searcher::first(const Readings& readings) const {
  if (kept_ && kept_->at.solved() && kept_->commands == readings.commands) return *kept_;
  const Variables& variables = problem_.variables();
  std::vector<Place> places;
  for (const FreeForce& force : variables.forces()) places.push_back(force.patch->nearest(force.patch->middle()));
  Guess at = problem_.solve(readings.commands, variables.means(), places, nullptr, progress_);
  if (kept_ && kept_->at.solved() && at.solved() &&
      (at.equilibrium.state.positions - kept_->at.equilibrium.state.positions).rowwise().norm().maxCoeff() <
          nearby_shape * variables.model().diagonal_mm)
    kept_->at = std::move(at);
  else if (!at.solved())
    kept_ = Survey{{}, std::move(at), {}, {}, {}};
  else if (variables.forces().empty())
    kept_ = Survey{{}, at, std::make_shared<const Nearby>(problem_.nearby(at)), {}, {}};
  else
    kept_ = survey(0, at, std::make_shared<const Nearby>(problem_.nearby(at)));
  kept_->commands = readings.commands;
  return *kept_;
}

double Searcher::forecast(const Readings& readings) const {
  const Survey& from = first(readings);
  if (!from.at.solved()) return std::numeric_limits<double>::infinity();
  if (!from.places.empty()) return best_apart(0, rank(0, from, readings)).front().cost;
  const Normal normal = problem_.normal(from.at, problem_.slopes(*from.own, from.at), readings);
  return normal.cost - normal.gradient.dot(solve_symmetric(normal.matrix, normal.gradient));
}

Fit Searcher::search(const Readings& readings) const {
  const Variables& variables = problem_.variables();
  const Survey& from = first(readings);
  Fit best{from.at};
  best.interrupted = best.at.equilibrium.report.stopped;
  if (!best.at.solved()) return best;
  if (variables.forces().empty()) return fitter_.refine(best.at, readings, from.own);
  for (std::size_t f = 0; f < variables.forces().size(); ++f) {
    std::optional<Fit> found = best_of(f, f == 0 ? from : survey(f, best.at, best.nearby), readings);
    if (!found) return best;
    best = std::move(*found);
    if (best.interrupted) return best;
  }
  return relocated(std::move(best), readings);
}

Fit Searcher::relocated(Fit fit, const Readings& readings) const {
  if (problem_.variables().forces().size() != 1 || !problem_.reciprocal()) return fit;
  for (int times = 0; times < max_relocations && fit.converged && !fit.interrupted; ++times) {
    fit.around = std::make_shared<const Survey>(survey(0, fit.at, fit.nearby));
    if (!fit.around->whole) return fit;
    const Ranked best = std::move(best_apart(0, rank(0, *fit.around, readings)).front());
    if (!(best.cost < fit.normal.cost - worthwhile)) return fit;
    Guess guess = begun(fit.at, best, 0, readings);
    if (guess.equilibrium.report.stopped) fit.interrupted = true;
    if (!guess.solved()) return fit;
    Fit there = fitter_.refine(std::move(guess), readings, {});
    fit.interrupted = fit.interrupted || there.interrupted;
    if (there.interrupted || !there.converged || !(there.normal.cost < fit.normal.cost)) return fit;
    fit = std::move(there);
  }
  return fit;
}

Eigen::MatrixXd Searcher::spread(const Fit& fit, const Readings& readings) const {
  const Variables& variables = problem_.variables();
  if (!fit.around || !fit.around->whole || variables.forces().size() != 1) return {};
  const Patch& patch = *variables.forces()[0].patch;
  const Points& rest = variables.model().rest;
  const Index numbers = variables.numbers(), size = variables.columns();
  Knowledge anywhere = readings.known;  // as likely at every place of the patch
  anywhere.information.rightCols(3).setZero();
  anywhere.information.bottomRows(3).setZero();
  const std::vector<Ranked> all =
      rank(0, *fit.around, {readings.commands, readings.values, readings.weights, anywhere});
  std::vector<double> logs;
  for (const Ranked& each : all) logs.push_back(-0.5 * (each.cost + log_determinant(each.matrix)));
  const double most = *std::max_element(logs.begin(), logs.end());
  const auto tangents = patch.tangents(fit.estimated.places[0]);
  const Vec3 estimated = patch.at(fit.estimated.places[0], rest);
  // variance inside the area that is nearer to a place than to the others, taken as a square
  const double within = patch.area() / (12 * static_cast<double>(all.size()));
  Eigen::MatrixXd moments = Eigen::MatrixXd::Zero(size, size);
  double sum = 0, squares = 0;
  for (std::size_t p = 0; p < all.size(); ++p) {
    const double weight = std::exp(logs[p] - most);
    Eigen::VectorXd off(size);
    off << all[p].values - fit.estimated.values, tangents.transpose() * (patch.at(all[p].place, rest) - estimated);
    moments += weight * off * off.transpose();
    moments.topLeftCorner(numbers, numbers) +=
        weight * CholeskyFactor(all[p].matrix).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(numbers, numbers)));
    moments.bottomRightCorner(2, 2) += weight * within * Eigen::Matrix2d::Identity();
    sum += weight;
    squares += weight * weight;
  }
  if (sum * sum / squares < min_places) return {};
  return moments / sum;
}

}  // namespace softkin::estimate
