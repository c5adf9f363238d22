#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/kinematics/inverse_response.hpp>
#include <softkin/kinematics/inverse_robot.hpp>
#include <softkin/statics/deformation.hpp>
#include <utility>

namespace softkin::inverse {

namespace {

constexpr double none = std::numeric_limits<double>::infinity();
/// Smallest completed fraction of a path at which the last equilibrium is used.
constexpr double min_path = 0.02;
/// Relative accuracy of slopes, sufficient for the steps and the termination of a search.
constexpr double slope_accuracy = 1e-6;

}  // namespace

RobotResponse::RobotResponse(const Statics& statics, const std::vector<Goal>& goals, const InverseOptions& options,
                             std::vector<Index> free, const ProgressCallback& progress)
    : model_(statics.model()),
      statics_(statics),
      goals_(goals),
      options_(options),
      free_(std::move(free)),
      progress_(progress),
      any_force_(any_force(goals)),
      min_error_(none),
      max_(options.max_equilibria) {
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (pulls(free_[i])) cables_.push_back(i);
}

bool RobotResponse::pulls(Index actuator) const {
  const Actuator& a = model_.actuators[actuator];
  return model_.formulation == Formulation::physical && a.is<CableDrive>() && a.control == Control::ratio;
}

double RobotResponse::width(Index actuator) const {
  const Actuator& a = model_.actuators[actuator];
  return a.high - a.low;
}

Eigen::VectorXd RobotResponse::fractions_of(const Actuation& actuation) const {
  Eigen::VectorXd fractions(free_.size());
  for (Index i = 0; i < fractions.size(); ++i) {
    const Index a = free_[i];
    fractions[i] = (actuation[a] - model_.actuators[a].low) / width(a);
  }
  return fractions.cwiseMax(0).cwiseMin(1);
}

Actuation RobotResponse::actuation_of(const Eigen::VectorXd& fractions, const Actuation& others) const {
  Actuation actuation = others;
  for (Index i = 0; i < fractions.size(); ++i) {
    const Index a = free_[i];
    const Actuator& actuator = model_.actuators[a];
    const double value = fractions[i] < 1 ? actuator.low + fractions[i] * width(a) : actuator.high;
    actuation[a] = std::clamp(value, actuator.low, actuator.high);
  }
  return actuation;
}

const std::vector<Exertion>& RobotResponse::exertions_at(const State& state) const {
  if (any_force_ && (last_.positions.rows() == 0 || last_.positions != state.positions))
    last_ = {state.positions, exertions_of(statics_, goals_, state)};
  return last_.exertions;
}

Eigen::VectorXd RobotResponse::errors_at(const State& state) const {
  return errors_of(model_, goals_, state.positions, exertions_at(state));
}

Pose RobotResponse::pose_of(Equilibrium equilibrium, bool taut) const {
  Pose pose;
  const Points& positions = equilibrium.state.positions;
  pose.exertions = exertions_at(equilibrium.state);
  pose.terms = goal_terms(model_, goals_, positions, pose.exertions);
  pose.miss = errors_of(model_, goals_, positions, pose.exertions).maxCoeff() / options_.tolerance_mm;
  pose.equilibrium = std::move(equilibrium);
  pose.idle.setZero(free_.size());
  pose.tensions.setZero(cables_.size());
  if (taut) tauten(pose);
  pose.fractions = fractions_of(pose.equilibrium.state.actuation);
  return pose;
}

/// Statics::sensitivity counts a cable as taut that is as long as its path. One whose path is shorter than its range
/// allows stays slack.
void RobotResponse::tauten(Pose& pose) const {
  State& state = pose.equilibrium.state;
  for (std::size_t i = 0; i < cables_.size(); ++i) {
    const Index a = free_[cables_[i]];
    const Actuator& cable = model_.actuators[a];
    pose.tensions[i] = std::max(0.0, state.multipliers[a]);
    if (state.multipliers[a] > 0) continue;
    const double path = achieved_ratio(model_, cable, state.positions);
    if (path < cable.low) continue;
    state.actuation[a] = std::min(state.actuation[a], path);
    pose.idle[cables_[i]] = 1;
  }
}

bool RobotResponse::solve(const Actuation& actuation, const State& from, Equilibrium& found) {
  const auto go_on = [this](const Progress&) {
    const bool on = !progress_ || progress_({static_cast<int>(history_.size()), min_error_, options_.tolerance_mm, -1});
    interrupted_ = interrupted_ || !on;
    return on;
  };
  found = statics_.solve(actuation, from, options_.statics, go_on);
  const bool converged = found.report.status == Status::converged;
  const double error = converged ? errors_at(found.state).maxCoeff() : none;
  interrupted_ = interrupted_ || found.report.stopped;
  history_.push_back({actuation, found.report.status, error, found.report.iterations});
  min_error_ = std::min(min_error_, error);
  return converged;
}

bool RobotResponse::release(Pose& pose, const Slopes& slopes, const Eigen::VectorXd& preferred, double resolution_mm) {
  const State& state = pose.equilibrium.state;
  const Actuation longer = actuation_of(preferred, state.actuation);
  Actuation released = state.actuation;
  for (std::size_t k = 0; k < cables_.size(); ++k) {
    const Index i = cables_[k], a = free_[i];
    const double tension = pose.tensions[k];
    const double rate = std::abs(slopes.tensions(k, i));
    if (!(tension > 0) || !(longer[a] > state.actuation[a])) continue;
    if (tension * slopes.terms.col(i).norm() < resolution_mm * rate) released[a] = longer[a];
  }
  Equilibrium found;
  if (released == state.actuation || !any_left() || !solve(released, origin_ ? *origin_ : state, found)) return false;
  Pose slack = pose_of(std::move(found), taut_);
  if (slack.miss > 1) return false;
  pose = std::move(slack);
  return true;
}

Response::Outcome RobotResponse::go(const Eigen::VectorXd& fractions, const Pose& from, Pose& to) {
  const State& state = from.equilibrium.state;
  Equilibrium found;
  const bool converged = solve(actuation_of(fractions, state.actuation), origin_ ? *origin_ : state, found);
  if (interrupted_) return Outcome::interrupted;
  const bool halfway =
      found.report.status == Status::limit && found.report.reached > min_path && found.state.load_factor == 1;
  if (!converged && !halfway) return Outcome::failed;
  found.report.status = Status::converged;  // at the actuation of its state
  found.report.remark.clear();
  to = pose_of(std::move(found), taut_);
  return converged ? Outcome::arrived : Outcome::halfway;
}

bool RobotResponse::extrapolate(const Eigen::VectorXd& fractions, const Pose& from, Eigen::VectorXd& terms) {
  const State& state = from.equilibrium.state;
  Points positions;
  if (any_force_) return false;  // the extrapolation gives a shape without forces
  if (!statics_.extrapolate(actuation_of(fractions, state.actuation), state, options_.statics, positions)) return false;
  terms = goal_terms(model_, goals_, positions);
  return terms.allFinite();
}

bool RobotResponse::slopes(const Pose& at, Slopes& slopes) {
  const State& state = at.equilibrium.state;
  const bool given = options_.start_sensitivity != nullptr && history_.empty() && at.idle.isZero(0);
  if (given)
    slopes.sensitivity = *options_.start_sensitivity;
  else if (!any_on_support(goals_))  // else it is computed with the reactions
    slopes.sensitivity = statics_.sensitivity(state, options_.statics, slope_accuracy);
  const std::vector<ExertionSlopes> exertions =
      exertion_slopes(statics_, goals_, at, options_.statics, slope_accuracy, slopes.sensitivity);
  if (!slopes.sensitivity.regular) return false;
  const Eigen::MatrixXd all = goal_slopes(model_, goals_, state.positions, slopes.sensitivity, at.exertions, exertions);
  const Index free = free_.size();
  slopes.terms.resize(all.rows(), free);
  slopes.tensions.resize(cables_.size(), free);
  for (Index i = 0; i < free; ++i) {
    const Index a = free_[i];
    slopes.terms.col(i) = width(a) * all.col(a);
    for (std::size_t k = 0; k < cables_.size(); ++k)
      slopes.tensions(k, i) = width(a) * slopes.sensitivity.multipliers(free_[cables_[k]], a);
  }
  return slopes.terms.allFinite() && slopes.tensions.allFinite();
}

}  // namespace softkin::inverse
