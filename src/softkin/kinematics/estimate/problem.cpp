#include <algorithm>
#include <softkin/kinematics/estimate/problem.hpp>
#include <softkin/kinematics/estimate/readings.hpp>

namespace softkin::estimate {

namespace {

/// Number of stored robots with different stiffnesses, those of the last fits of an update.
constexpr std::size_t kept_robots = 4;
/// Perturbation of a stiffness, relative to its mean.
constexpr double perturbation = 1e-5;
/// Maximum number of iterations of a solve that begins at a nearby equilibrium: where more are needed, a shorter step
/// is faster.
constexpr int max_iterations = 12;

StaticsOptions quiet(StaticsOptions options) {
  options.keep_history = false;
  options.trace = false;
  return options;
}

/// Returns the computed values less the readings; 0 where the weight is 0.
Eigen::VectorXd missed(const Guess& at, const Readings& read) {
  Eigen::VectorXd missed = Eigen::VectorXd::Zero(read.values.size());
  for (Index r = 0; r < std::ssize(read.values); ++r)
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

const Statics& Problem::statics(const Eigen::VectorXd& values) const {
  if (!variables_.stiffens()) return statics_;
  const auto same = [&](const Stiffened& kept) {
    for (Index i = 0; i < variables_.numbers(); ++i)
      if (variables_.all()[i].material >= 0 && kept.values[i] != values[i]) return false;
    return true;
  };
  const auto found = std::find_if(stiffened_.begin(), stiffened_.end(), same);
  if (found != stiffened_.end()) {
    std::rotate(found, found + 1, stiffened_.end());
    return *stiffened_.back().statics;
  }
  if (stiffened_.size() == kept_robots) stiffened_.erase(stiffened_.begin());
  Stiffened robot{values, std::make_unique<const Model>(variables_.stiffened(values)), nullptr};
  robot.statics = std::make_unique<const Statics>(*robot.model, statics_);
  stiffened_.push_back(std::move(robot));
  return *stiffened_.back().statics;
}

Guess Problem::solve(const Actuation& commands, const Eigen::VectorXd& values, const std::vector<Place>& places,
                     const Guess* near, const ProgressCallback& progress, const State* predicted) const {
  Guess guess{values, places, {}, {}};
  const Statics& statics = this->statics(values);
  const State start = near && near->solved() ? near->equilibrium.state : statics.rest();
  if (near && near->solved() && predicted) (void)statics.set_initial_guess(start, *predicted, options_);
  StaticsOptions options = options_;
  if (near && near->solved()) options.max_iterations = std::min(options.max_iterations, max_iterations);
  guess.equilibrium = statics.solve(variables_.actuation(commands, values, places), start, options, progress);
  ++solves_;
  if (guess.equilibrium.report.status != Status::converged) {
    ++lost_;
    return guess;
  }
  const State& state = guess.equilibrium.state;
  Points reactions;
  if (reads_supports()) reactions = statics.measured(state).reactions;
  guess.computed.resize(columns_.size());
  for (Index r = 0; r < std::ssize(columns_); ++r)
    guess.computed[r] = reading_at(variables_.model(), columns_[r], state, reactions);
  if (!guess.computed.allFinite()) guess.computed.resize(0);
  return guess;
}

Nearby Problem::nearby(const Guess& at) const {
  std::vector<Actuation> changes = variables_.part_changes(at.places);
  const Index own = changes.size();
  for (const Index a : variables_.measured())
    changes.emplace_back(Actuation::Unit(variables_.model().actuators.size(), a));
  Slopes all = slopes(at, changes);
  Nearby near{at.places, {}, {}};
  near.commands.of_readings = all.of_readings.rightCols(all.of_readings.cols() - own);
  near.commands.multipliers = all.multipliers.rightCols(all.multipliers.cols() - own);
  near.commands.moves.assign(std::make_move_iterator(all.moves.begin() + own),
                             std::make_move_iterator(all.moves.end()));
  all.of_readings.conservativeResize(Eigen::NoChange, own);
  all.multipliers.conservativeResize(Eigen::NoChange, own);
  all.moves.resize(own);
  near.parts = std::move(all);
  if (variables_.stiffens()) set_stiffness_slopes(at, near.parts);
  return near;
}

/// Sets the columns of stiffnesses, which are no commands.
void Problem::set_stiffness_slopes(const Guess& at, Slopes& parts) const {
  std::vector<Model> models;
  std::vector<Perturbed> perturbed;
  std::vector<Index> numbers;
  models.reserve(2 * static_cast<std::size_t>(variables_.numbers()));
  for (Index i = 0; i < variables_.numbers(); ++i) {
    const Variable& variable = variables_.all()[i];
    if (variable.material < 0) continue;
    Eigen::VectorXd more = at.values, less = at.values;
    more[i] += perturbation * variable.mean;
    less[i] -= perturbation * variable.mean;
    const Model &stiffer = models.emplace_back(variables_.stiffened(more)),
                &softer = models.emplace_back(variables_.stiffened(less));
    perturbed.push_back({stiffer, softer, more[i] - less[i]});
    numbers.push_back(i);
  }
  const Perturbations perturbations(statics(at.values), perturbed);
  Slopes found = slopes_of(at, perturbations.at(at.equilibrium.state, options_, slope_accuracy_, reads_supports()));
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const Index i = numbers[k], column = k;
    parts.of_readings.col(i) = found.of_readings.col(column);
    parts.multipliers.col(i) = found.multipliers.col(column);
    parts.moves[i] = std::move(found.moves[k]);
  }
}

Slopes Problem::slopes(const Guess& at, const std::vector<Actuation>& changes) const {
  return slopes_of(at, statics(at.values).sensitivity_along(at.equilibrium.state, changes, options_, slope_accuracy_,
                                                            reads_supports()));
}

Slopes Problem::slopes_of(const Guess& at, ParameterSensitivity found) const {
  const State& state = at.equilibrium.state;
  Slopes slopes;
  slopes.of_readings.setZero(columns_.size(), found.positions.size());
  const Points none;
  for (std::size_t c = 0; c < found.positions.size(); ++c) {
    const Eigen::VectorXd multipliers = found.multipliers.col(c);
    const ShapeChange change{found.positions[c], multipliers, found.reactions.empty() ? none : found.reactions[c]};
    for (std::size_t r = 0; r < columns_.size() && found.regular; ++r)
      slopes.of_readings(r, c) = reading_change(variables_.model(), columns_[r], state, change);
  }
  slopes.moves = std::move(found.positions);
  slopes.multipliers = std::move(found.multipliers);
  return slopes;
}

bool Problem::reciprocal() const {
  return std::all_of(columns_.begin(), columns_.end(),
                     [](const PoseColumn& column) { return column.marker >= 0 || column.sensor >= 0; });
}

Eigen::MatrixXd Problem::by_node_forces(const Guess& at, std::size_t force) const {
  const State& state = at.equilibrium.state;
  if (!reciprocal()) return {};
  std::vector<Points> gradients;
  for (const PoseColumn& column : columns_)
    gradients.push_back(reading_gradient(variables_.model(), column, state.positions));
  const std::vector<Points> moves = statics(at.values).reciprocal_moves(state, gradients, options_, slope_accuracy_);
  if (moves.empty()) return {};
  const std::vector<Index>& nodes = variables_.forces()[force].patch->nodes();
  Eigen::MatrixXd by(moves.size(), 3 * std::ssize(nodes));
  for (std::size_t r = 0; r < moves.size(); ++r)
    for (std::size_t i = 0; i < nodes.size(); ++i) by.block<1, 3>(r, 3 * i) = moves[r].row(nodes[i]);
  return by;
}

Normal Problem::normal(const Guess& at, const Eigen::MatrixXd& slopes, const Readings& read) const {
  const Eigen::VectorXd off = missed(at, read);
  Knowledge::Cost known = read.known.cost(variables_, at.values, at.places);
  return {slopes.transpose() * read.weights.asDiagonal() * slopes + known.matrix,
          slopes.transpose() * read.weights.cwiseProduct(off) + known.gradient,
          read.weights.dot(off.cwiseAbs2()) + known.value};
}

double Problem::cost(const Guess& at, const Readings& read) const {
  return read.weights.dot(missed(at, read).cwiseAbs2()) + read.known.value(variables_, at.values, at.places);
}

void Problem::remember(const Nearby& nearby, const Guess& at, const Readings& read, Memory& memory) const {
  memory.add(nearby.parts.of_readings, nearby.base, at.values, at.places, missed(at, read), read.weights);
}

void Problem::move(const Guess& from, const Eigen::VectorXd& step, Eigen::VectorXd& values,
                   std::vector<Place>& places) const {
  values = variables_.clamped(from.values + step.head(variables_.numbers()));
  places = from.places;
  for (std::size_t f = 0; f < places.size(); ++f) {
    const Patch& patch = *variables_.forces()[f].patch;
    const Vec3 to = patch.at(places[f], variables_.model().rest) +
                    patch.tangents(places[f]) * step.segment<2>(variables_.numbers() + 2 * f);
    places[f] = patch.nearest(to);
  }
}

Eigen::VectorXd Problem::path(const Guess& from, const Guess& to) const {
  Eigen::VectorXd path(variables_.columns());
  path.head(variables_.numbers()) = to.values - from.values;
  for (std::size_t f = 0; f < to.places.size(); ++f) {
    const Patch& patch = *variables_.forces()[f].patch;
    const Points& rest = variables_.model().rest;
    path.segment<2>(variables_.numbers() + 2 * f) =
        patch.tangents(from.places[f]).transpose() * (patch.at(to.places[f], rest) - patch.at(from.places[f], rest));
  }
  return path;
}

Eigen::MatrixXd Problem::slopes(const Nearby& nearby, const Guess& at) const {
  return nearby.parts.of_readings * variables_.part_slopes(at.values, at.places, nearby.base);
}

std::vector<Points> Problem::moves(const Nearby& nearby, const Guess& at) const {
  const Eigen::MatrixXd by = variables_.part_slopes(at.values, at.places, nearby.base);
  std::vector<Points> moves;
  for (Index c = 0; c < by.cols(); ++c) {
    Points& of = moves.emplace_back(Points::Zero(variables_.model().rest.rows(), 3));
    for (Index p = 0; p < by.rows(); ++p)
      if (by(p, c) != 0) of += by(p, c) * nearby.parts.moves[p];
  }
  return moves;
}

void Problem::follow(const Nearby& nearby, const Guess& from, const Guess& to, const Actuation& commands,
                     Eigen::VectorXd& computed, State* state) const {
  const auto add = [&](const Slopes& by, const Eigen::VectorXd& path) {
    computed += by.of_readings * path;
    if (state == nullptr) return;
    state->multipliers += by.multipliers * path;
    for (Index c = 0; c < std::ssize(path); ++c)
      if (path[c] != 0) state->positions += path[c] * by.moves[c];
  };
  add(nearby.parts,
      variables_.parts(to.values, to.places, nearby.base) - variables_.parts(from.values, from.places, nearby.base));
  if (commands.size() == 0) return;
  const std::vector<Index> measured = variables_.measured();
  Eigen::VectorXd path(measured.size());
  for (std::size_t i = 0; i < measured.size(); ++i) path[i] = commands[measured[i]];
  add(nearby.commands, path);
}

double Problem::largest_move(const Nearby& nearby, const Guess& from, const Guess& to) const {
  Eigen::VectorXd computed = from.computed;
  State moved;
  moved.positions = Points::Zero(variables_.model().rest.rows(), 3);
  moved.multipliers = Eigen::VectorXd::Zero(nearby.parts.multipliers.rows());
  follow(nearby, from, to, {}, computed, &moved);
  return moved.positions.rowwise().norm().maxCoeff();
}

}  // namespace softkin::estimate
