#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/estimate/fit.hpp>
#include <softkin/kinematics/estimate/outliers.hpp>
#include <softkin/kinematics/estimate/search.hpp>
#include <softkin/kinematics/estimator.hpp>
#include <softkin/model/names.hpp>
#include <softkin/model/sensor.hpp>

namespace softkin {

using namespace estimate;

double Estimate::misfit() const {
  return estimate::excess(chi_square, freedoms);
}

Vec3 Estimate::vertex_deviation(Index vertex) const {
  Eigen::MatrixXd by(3, moves.size());
  for (std::size_t c = 0; c < moves.size(); ++c) by.col(c) = vertex_at(moves[c], vertex);
  return (by * near_covariance * by.transpose()).diagonal().cwiseMax(0).cwiseSqrt();
}

namespace {

/// Accuracy of shapes, relative to the smallest standard deviation of the markers.
constexpr double exact = 1e-1;

StaticsOptions exact_enough(StaticsOptions options, const std::vector<PoseColumn>& columns,
                            const Eigen::VectorXd& deviations) {
  if (options.step_tolerance_mm > 0) return options;
  bool markers_alone = true;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < columns.size(); ++r) {
    markers_alone = markers_alone && columns[r].kind == Reading::coordinate;
    least = std::min(least, deviations[r]);
  }
  if (markers_alone) options.step_tolerance_mm = exact * least;
  return options;
}

}  // namespace

struct Estimator::Parts {
  const Model& model;
  EstimatorOptions options;
  Eigen::VectorXd deviations;
  Problem problem;
  std::vector<ReadingGroup> groups;
  std::optional<Fit> last{};
  std::optional<Survey> survey{};  // of searches
  Memory memory;                   // used where estimates fade
  Actuation last_commands{};
  Estimate estimate{};

  Parts(const Model& robot, const std::vector<EstimatedUnknown>& unknowns, const std::vector<PoseColumn>& columns,
        Eigen::VectorXd given, EstimatorOptions requested)
      : model(robot),
        options(std::move(requested)),
        deviations(std::move(given)),
        problem(robot, unknowns, columns, exact_enough(options.statics, columns, deviations)),
        groups(reading_groups(robot, problem.columns())),
        memory(problem.variables()) {}

  void check(const Actuation& commands, const Eigen::VectorXd& values, double elapsed_s) const;
  [[nodiscard]] Knowledge known(double elapsed_s);
  [[nodiscard]] Fit fit(const Actuation& commands, const Eigen::VectorXd& values, const Knowledge& known,
                        Eigen::VectorXd& weights, const ProgressCallback& progress);
  void describe(const Fit& found, const Readings& read, const Actuation& commands);
  void report_numbers(const Fit& found);
  void report_places(const Fit& found);
};

void Estimator::Parts::check(const Actuation& commands, const Eigen::VectorXd& values, double elapsed_s) const {
  if (values.size() != deviations.size())
    throw InvalidInput("there are " + std::to_string(values.size()) + " readings, expected " +
                       std::to_string(deviations.size()));
  if (values.array().isInf().any()) throw InvalidInput("a reading is infinite");
  if (!(elapsed_s >= 0)) throw InvalidInput("the time since the last readings must be 0 s or more");
  if (commands.size() != std::ssize(model.actuators))
    throw InvalidInput("there are " + std::to_string(commands.size()) + " commands, the robot has " +
                       std::to_string(model.actuators.size()));
}

/// Returns the prior: that before any reading and the information of earlier readings, which fades with time.
Knowledge Estimator::Parts::known(double elapsed_s) {
  Knowledge known(problem.variables());
  if (!(options.fade_s > 0)) return known;
  memory.fade(std::exp(-elapsed_s / options.fade_s));
  known.memory = &memory;
  return known;
}

/// weights  those of readings that are left out become 0
Fit Estimator::Parts::fit(const Actuation& commands, const Eigen::VectorXd& values, const Knowledge& known,
                          Eigen::VectorXd& weights, const ProgressCallback& progress) {
  const Knowledge nothing(problem.variables());
  const Fitter fitter(problem, options, progress);
  const Searcher searcher(problem, options, progress, survey);
  const auto read = [&](const Eigen::VectorXd& some, bool anew) {
    return Readings{commands, values, some, anew ? nothing : known};
  };
  Fits fits;
  fits.anew = [&](const Eigen::VectorXd& some) {
    Fit fit = searcher.search(read(some, true));
    fit.anew = true;
    return fit;
  };
  fits.forecast = [&](const Eigen::VectorXd& some) { return searcher.forecast(read(some, true)); };
  fits.exhausted = [&] { return fitter.exhausted(); };
  fits.near = [&](const Eigen::VectorXd& some, const Fit& near, bool anew) {
    Fit fit = fitter.refine(near.at, read(some, anew), near.nearby);
    fit.anew = anew;
    return fit;
  };
  if (last) {
    fits.tracked = [&](const Eigen::VectorXd& some) {
      const Readings now = read(some, false);
      Fit fit = fitter.refine(last->at, now, last->nearby, last_commands == commands ? nullptr : &last_commands);
      return options.fade_s > 0 ? fit : searcher.relocated(std::move(fit), now);
    };
    fits.predicted = [&](const Eigen::VectorXd& some) {
      return fitter.predict(last->at, read(some, false), last->nearby, last_commands);
    };
  }
  if (options.leave_out) return agreeing_fit(groups, values, weights, fits, estimate.left_out);
  return last ? fits.tracked(weights) : fits.anew(weights);
}

void Estimator::Parts::report_numbers(const Fit& found) {
  const std::vector<Variable>& variables = problem.variables().all();
  estimate.numbers.clear();
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const Variable& v = variables[i];
    const Index at = i;
    const double value = found.estimated.values[at];
    estimate.numbers.push_back(
        estimate::reported_number(model, v, value, std::sqrt(std::max(0.0, estimate.covariance(at, at)))));
    if (v.actuator >= 0) estimate.actuation[v.actuator] = value;
  }
}

void Estimator::Parts::report_places(const Fit& found) {
  estimate.places.clear();
  const std::vector<FreeForce>& forces = problem.variables().forces();
  for (std::size_t f = 0; f < forces.size(); ++f) {
    const Patch& patch = *forces[f].patch;
    const Place& place = found.estimated.places[f];
    const auto tangents = patch.tangents(place);
    const Index first = problem.variables().numbers() + 2 * f;
    estimate.places.push_back({forces[f].name, patch.at(place, model.rest), patch.at(place, estimate.state.positions),
                               tangents * estimate.covariance.block(first, first, 2, 2) * tangents.transpose(),
                               patch.covariance()});
  }
}

void Estimator::Parts::describe(const Fit& found, const Readings& read, const Actuation& commands) {
  const Eigen::MatrixXd& slopes = found.slopes;
  const CholeskyFactor factor(found.normal.matrix);
  estimate.near_covariance = factor.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(slopes.cols(), slopes.cols())));
  const ProgressCallback none;
  estimate.covariance = Searcher(problem, options, none, survey).spread(found, read);
  if (estimate.covariance.size() == 0) estimate.covariance = estimate.near_covariance;
  estimate.state = found.at.equilibrium.state;
  estimate.computed = found.at.computed;
  problem.follow(*found.nearby, found.at, found.estimated, {}, estimate.computed, &estimate.state);
  const Eigen::VectorXd leverage = (slopes * estimate.near_covariance).cwiseProduct(slopes).rowwise().sum().cwiseMax(0);
  estimate.deviations = leverage.cwiseSqrt();
  estimate.chi_square = estimate.freedoms = 0;
  for (Index r = 0; r < read.values.size(); ++r) {
    if (read.weights[r] == 0) continue;
    const double off = estimate.computed[r] - read.values[r];
    estimate.chi_square += read.weights[r] * off * off;
    estimate.freedoms += std::max(0.0, 1 - read.weights[r] * leverage[r]);
  }
  estimate.actuation = commands;
  report_numbers(found);
  report_places(found);
  const Index own = model.actuators.size();
  estimate.state.actuation =
      problem.variables().actuation(commands, found.estimated.values, found.estimated.places).head(own);
  estimate.state.multipliers = estimate.state.multipliers.head(own).eval();
  estimate.moves = problem.moves(*found.nearby, found.estimated);
}

Estimator::Estimator(const Model& model, const std::vector<EstimatedUnknown>& unknowns,
                     const std::vector<PoseColumn>& columns, Eigen::VectorXd deviations, EstimatorOptions options) {
  if (columns.empty()) throw InvalidInput("there is no reading");
  if (deviations.size() != std::ssize(columns)) throw InvalidInput("each reading needs a deviation");
  for (std::size_t r = 0; r < columns.size(); ++r)
    if (const double d = deviations[r]; !(d > 0 && std::isfinite(d)))
      throw InvalidInput("reading '" + columns[r].name + "' needs a deviation above 0, not " + number(d));
  parts_ = std::make_unique<Parts>(model, unknowns, columns, std::move(deviations), std::move(options));
}
Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

const Estimate& Estimator::update(const Actuation& commands, const Eigen::VectorXd& values, double elapsed_s,
                                  const ProgressCallback& progress) {
  const auto begin = std::chrono::steady_clock::now();
  Parts& parts = *parts_;
  parts.check(commands, values, elapsed_s);
  Estimate& estimate = parts.estimate;
  const int solves = parts.problem.solves();
  Eigen::VectorXd weights = parts.deviations.cwiseAbs2().cwiseInverse();
  for (Index r = 0; r < values.size(); ++r)
    if (std::isnan(values[r])) weights[r] = 0;
  estimate.left_out.clear();
  const Knowledge known = parts.known(elapsed_s);
  Fit found = parts.fit(commands, values, known, weights, progress);
  estimate.iterations = found.iterations;
  estimate.status = found.interrupted ? Status::interrupted
                    : found.converged ? Status::converged
                                      : Status::not_converged;
  estimate.remark = found.interrupted || found.converged ? ""
                    : found.at.solved()
                        ? "its iterations were not enough"
                        : "the robot has no equilibrium where the search begins: " + found.at.equilibrium.report.remark;
  if (found.at.solved() && found.normal.matrix.size() > 0) {
    const Knowledge nothing(parts.problem.variables());
    const Readings read{commands, values, weights, found.anew ? nothing : known};
    parts.describe(found, read, commands);
    if (found.converged) {
      if (found.anew) parts.memory.forget();
      if (parts.options.fade_s > 0) parts.problem.remember(*found.nearby, found.estimated, read, parts.memory);
      parts.last = std::move(found);
      parts.last_commands = commands;
    }
  }
  estimate.equilibria = parts.problem.solves() - solves;
  estimate.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return estimate;
}

void Estimator::forget() {
  parts_->last.reset();
  parts_->memory.forget();
}

const std::vector<ReadingGroup>& Estimator::groups() const {
  return parts_->groups;
}

std::vector<Index> Estimator::reported_actuators() const {
  return parts_->problem.variables().reported_actuators();
}

std::vector<ReadingGroup> reading_groups(const Model& model, const std::vector<PoseColumn>& columns) {
  std::vector<ReadingGroup> groups;
  for (Index c = 0; c < std::ssize(columns); ++c) {
    const PoseColumn& column = columns[c];
    std::string name = column.marker >= 0                  ? "marker " + model.markers[column.marker].name
                       : column.support >= 0               ? "force of " + model.held.supports[column.support].name
                       : column.kind == Reading::direction ? "direction " + model.sensors[column.sensor]->name
                                                           : column.name;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const ReadingGroup& g) { return g.name == name; });
    if (same == groups.end())
      groups.push_back({std::move(name), {c}});
    else
      same->columns.push_back(c);
  }
  return groups;
}

}  // namespace softkin
