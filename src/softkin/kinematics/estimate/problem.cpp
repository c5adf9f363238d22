#include <algorithm>
#include <softkin/kinematics/estimate/problem.hpp>
#include <softkin/kinematics/estimate/readings.hpp>

namespace softkin::estimate {

namespace {

StaticsOptions quiet(StaticsOptions options) {
  options.keep_history = false;
  options.trace = false;
  return options;
}

/// What was computed less the readings, where these were read.
Eigen::VectorXd missed(const Guess& at, const Readings& read) {
  Eigen::VectorXd missed = Eigen::VectorXd::Zero(read.values.size());
  for (Index r = 0; r < static_cast<Index>(read.values.size()); ++r)
    if (read.weights[r] > 0) missed[r] = at.computed[r] - read.values[r];
  return missed;
}

}  // namespace

Problem::Problem(const Model& model, const std::vector<EstimatedUnknown>& unknowns, std::vector<PoseColumn> columns,
                 const StaticsOptions& options, double slope_accuracy)
    : variables_(model, unknowns),
      columns_(std::move(columns)),
      options_(quiet(options)),
      slope_accuracy_(slope_accuracy),
      statics_(variables_.model()) {}

bool Problem::reads_supports() const {
  return std::any_of(columns_.begin(), columns_.end(), [](const PoseColumn& column) { return column.support >= 0; });
}

Guess Problem::solve(const Actuation& commands, const Eigen::VectorXd& values, const std::vector<Place>& places,
                     const Guess* near, const ProgressCallback& progress) const {
  Guess guess{values, places, {}, {}};
  const State start = near && near->solved() ? near->equilibrium.state : statics_.rest();
  guess.equilibrium = statics_.solve(variables_.actuation(commands, values, places), start, options_, progress);
  ++solves_;
  if (guess.equilibrium.report.status != Status::converged) return guess;
  const State& state = guess.equilibrium.state;
  Points reactions;
  if (reads_supports()) reactions = statics_.measured(state).reactions;
  guess.computed.resize(static_cast<Index>(columns_.size()));
  for (Index r = 0; r < static_cast<Index>(columns_.size()); ++r)
    guess.computed[r] = reading_at(variables_.model(), columns_[static_cast<std::size_t>(r)], state, reactions);
  if (!guess.computed.allFinite()) guess.computed.resize(0);
  return guess;
}

Slopes Problem::slopes(const Guess& at) const {
  std::vector<Actuation> changes = variables_.changes(at.values, at.places);
  const std::vector<Index> measured = variables_.measured();
  for (const Index a : measured)
    changes.emplace_back(Actuation::Unit(static_cast<Index>(variables_.model().actuators.size()), a));
  Slopes all = slopes(at, changes);
  all.by_commands.setZero(all.of_readings.rows(), variables_.own_actuators());
  for (std::size_t i = 0; i < measured.size(); ++i)
    all.by_commands.col(measured[i]) = all.of_readings.col(variables_.columns() + static_cast<Index>(i));
  all.of_readings.conservativeResize(Eigen::NoChange, variables_.columns());
  all.moves.resize(static_cast<std::size_t>(variables_.columns()));
  return all;
}

Slopes Problem::slopes(const Guess& at, const std::vector<Actuation>& changes) const {
  const State& state = at.equilibrium.state;
  ParameterSensitivity found = statics_.sensitivity_along(state, changes, options_, slope_accuracy_, reads_supports());
  Slopes slopes;
  slopes.of_readings.setZero(static_cast<Index>(columns_.size()), static_cast<Index>(changes.size()));
  const Points none;
  for (std::size_t c = 0; c < changes.size(); ++c) {
    const Eigen::VectorXd multipliers = found.multipliers.col(static_cast<Index>(c));
    const ShapeChange change{found.positions[c], multipliers, found.reactions.empty() ? none : found.reactions[c]};
    for (std::size_t r = 0; r < columns_.size() && found.regular; ++r)
      slopes.of_readings(static_cast<Index>(r), static_cast<Index>(c)) =
          reading_change(variables_.model(), columns_[r], state, change);
  }
  slopes.moves = std::move(found.positions);
  return slopes;
}

Normal Problem::normal(const Guess& at, const Eigen::MatrixXd& slopes, const Readings& read) const {
  const Eigen::MatrixXd directions = directions_at(variables_, at.places);
  const Eigen::VectorXd off = coordinates_of(variables_, at.values, at.places) - read.known.mean;
  return {slopes.transpose() * read.weights.asDiagonal() * slopes +
              directions.transpose() * read.known.information * directions,
          slopes.transpose() * read.weights.cwiseProduct(missed(at, read)) +
              directions.transpose() * (read.known.information * off),
          cost(at, read)};
}

double Problem::cost(const Guess& at, const Readings& read) const {
  const Eigen::VectorXd off = coordinates_of(variables_, at.values, at.places) - read.known.mean;
  return read.weights.dot(missed(at, read).cwiseAbs2()) + off.dot(read.known.information * off);
}

void Problem::move(const Guess& from, const Eigen::VectorXd& step, Eigen::VectorXd& values,
                   std::vector<Place>& places) const {
  values = variables_.clamped(from.values + step.head(variables_.numbers()));
  places = from.places;
  for (std::size_t f = 0; f < places.size(); ++f) {
    const Patch& patch = *variables_.forces()[f].patch;
    const Vec3 to = patch.at(places[f], variables_.model().rest) +
                    patch.tangents(places[f]) * step.segment<2>(variables_.numbers() + 2 * static_cast<Index>(f));
    places[f] = patch.nearest(to);
  }
}

}  // namespace softkin::estimate
