#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/inverse_robot.hpp>
#include <softkin/kinematics/inverse_search.hpp>
#include <utility>

namespace softkin {

namespace {

/// A direction in which whole ranges change the terms by less than this fraction of the tolerance has no effect.
constexpr double resolution_of_tolerance = 0.1;
/// The error of another minimum, relative to the first, below which a jump to it is worthwhile.
constexpr double worthwhile = 0.99;

void check_size(const Model& model, const Sensitivity& given) {
  const std::size_t m = model.actuators.size();
  const auto fits = [&](const Points& p) { return p.rows() == model.rest.rows() && p.allFinite(); };
  if (given.positions.size() != m || given.multipliers.rows() != static_cast<Index>(m) ||
      given.multipliers.cols() != static_cast<Index>(m) ||
      !std::all_of(given.positions.begin(), given.positions.end(), fits))
    throw InvalidInput("the sensitivity at the start is of another robot, or not finite");
}

void check_options(const Model& model, const State& start, const InverseOptions& options) {
  const Index m = model.actuators.size();
  if (m == 0) throw InvalidInput("inverse kinematics needs a robot with an actuator");
  if (!(options.tolerance_mm > 0) || !std::isfinite(options.tolerance_mm) || !(options.preferred_tolerance > 0) ||
      options.max_equilibria < 1 || options.max_iterations < 1 || options.other_starts < 0)
    throw InvalidInput(
        "options of inverse kinematics out of range: tolerances > 0, equilibria and iterations >= 1, other starts >= "
        "0");
  if (!options.free.empty() && std::ssize(options.free) != m)
    throw InvalidInput("the list of free actuators has " + std::to_string(options.free.size()) +
                       " entries, the robot " + std::to_string(m) + " actuators");
  if (options.preferred.size() > 0) check_actuation(model, options.preferred);
  if (start.actuation.size() > 0) check_actuation(model, start.actuation);
  if (options.start_sensitivity != nullptr) check_size(model, *options.start_sensitivity);
}

std::vector<Index> free_actuators(const Model& model, const InverseOptions& options) {
  std::vector<Index> free;
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if ((options.free.empty() || options.free[a]) && varies(model.actuators[a])) free.push_back(a);
  return free;
}

/// Place i of a sequence that fills the unit cube evenly (Halton 1960).
Eigen::VectorXd evenly(int place, Index size) {
  Eigen::VectorXd point(size);
  int base = 1;
  for (Index i = 0; i < size; ++i) {
    const auto divides = [&](int d) { return base % d == 0; };
    for (bool prime = false; !prime;) {
      ++base;
      prime = true;
      for (int d = 2; d * d <= base; ++d) prime = prime && !divides(d);
    }
    double value = 0, digit = 1;
    for (int n = place; n > 0; n /= base) value += n % base * (digit /= base);
    point[i] = value;
  }
  return point;
}

class Inverse {
 public:
  Inverse(const Statics& statics, const std::vector<Goal>& goals, const InverseOptions& options,
          const ProgressCallback& progress)
      : model_(statics.model()),
        statics_(statics),
        goals_(goals),
        options_(options),
        response_(statics, goals, options, free_actuators(model_, options), progress) {}

  /// known: may the start's report stand for it?
  InverseResult solve(const Equilibrium& start, bool known) {
    Equilibrium first = start;
    if (!known) first.report = {};
    if (correct(start.state, first)) {
      if (options_.method == InverseMethod::newton) {
        search(std::move(first));
      } else {
        descend_from(std::move(first));
      }
    }
    result_.equilibria = static_cast<int>(response_.history().size());
    result_.history = response_.history();
    return std::move(result_);
  }

 private:
  /// Makes the start an equilibrium. A start with everything that solve() returns is accepted as one; where a stable
  /// equilibrium is requested, only if its report states that it is stable.
  bool correct(const State& start, Equilibrium& first) {
    const Index m = model_.actuators.size();
    const StaticsOptions& statics = options_.statics;
    const bool same_time =
        !statics_.viscous() || (start.history == statics.history && start.elapsed_s == statics.elapsed_s);
    const bool known = start.knows(m) && start.multipliers.size() == m && start.load_factor == 1 && same_time &&
                       (!options_.statics.stable || (is_reported(first) && first.report.physical.unstable_modes == 0));
    first.actuation = start.actuation.size() > 0 ? start.actuation : model_.rest_actuation();
    first.report.status = Status::converged;
    if (known || response_.solve(first.actuation, start, first)) return true;
    result_.equilibrium = first;
    if (!any_force(goals_)) result_.errors_mm = goal_errors(model_, goals_, first.state.positions);
    result_.active.assign(model_.actuators.size(), 0);
    result_.status = response_.interrupted() ? InverseStatus::interrupted : InverseStatus::not_converged;
    result_.remark = response_.interrupted() ? "interrupted" : "the start has no equilibrium: " + first.report.remark;
    return false;
  }

  [[nodiscard]] double accuracy_mm() const {
    return options_.statics.step_tolerance_mm > 0 ? options_.statics.step_tolerance_mm : 8e-8 * model_.diagonal_mm;
  }

  void descend_from(Equilibrium first) {
    response_.keep_slack();
    inverse::Pose pose = response_.pose_of(std::move(first), false);
    const bool reached = inverse::descend(response_, model_.diagonal_mm, accuracy_mm(), options_.max_iterations, pose,
                                          result_.iterations, result_.remark);
    result_.status = reached ? InverseStatus::reached : InverseStatus::not_converged;
    if (response_.interrupted()) result_.status = InverseStatus::interrupted;
    if (reached) result_.remark.clear();
    finish(std::move(pose));
    result_.active.assign(model_.actuators.size(), 0);
  }

  void search(Equilibrium first) {
    const Actuation preferred = options_.preferred.size() > 0 ? options_.preferred : first.actuation;
    inverse::SearchSettings settings;
    settings.preferred = response_.fractions_of(preferred);
    settings.resolution_mm = resolution_of_tolerance * options_.tolerance_mm;
    settings.accuracy_mm = accuracy_mm();
    settings.preferred_tolerance = options_.preferred_tolerance;
    first.state.actuation = first.actuation;
    if (response_.free().empty()) return stay(std::move(first));
    const inverse::Pose start = response_.pose_of(std::move(first), true);
    if (std::any_of(model_.actuators.begin(), model_.actuators.end(),
                    [](const Actuator& a) { return has_friction(a); }))
      response_.come_from(start.equilibrium.state);
    inverse::SearchResult found = inverse::search_inverse(response_, start, settings);
    result_.iterations = found.iterations;
    for (int i = 1; i <= options_.other_starts && unreached(found); ++i) try_from(i, start, settings, found);
    conclude(std::move(found), settings);
  }

  /// No actuator may change.
  void stay(Equilibrium first) {
    inverse::Pose pose = response_.pose_of(std::move(first), false);
    result_.status = pose.miss <= 1 ? InverseStatus::reached : InverseStatus::unreachable;
    if (pose.miss > 1) result_.remark = "no actuator may change";
    result_.active.assign(model_.actuators.size(), 0);
    result_.sensitivity = statics_.sensitivity(pose.equilibrium.state, options_.statics);
    finish(std::move(pose));
  }

  [[nodiscard]] bool unreached(const inverse::SearchResult& found) const {
    return (found.end == inverse::SearchEnd::stationary || found.end == inverse::SearchEnd::stuck) &&
           response_.any_left();
  }

  void try_from(int place, const inverse::Pose& start, const inverse::SearchSettings& settings,
                inverse::SearchResult& best) {
    inverse::Pose there;
    if (response_.go(evenly(place, start.fractions.size()), start, there) == inverse::Response::Outcome::failed) return;
    if (response_.interrupted()) {
      best.end = inverse::SearchEnd::interrupted;
      return;
    }
    inverse::SearchResult found = inverse::search_inverse(response_, there, settings);
    result_.iterations += found.iterations;
    const bool good = found.end == inverse::SearchEnd::reached || found.end == inverse::SearchEnd::stationary;
    if (found.end == inverse::SearchEnd::interrupted) {
      best.end = inverse::SearchEnd::interrupted;
    } else if ((good && best.end == inverse::SearchEnd::stuck && found.pose.terms.norm() <= best.pose.terms.norm()) ||
               found.pose.terms.norm() < worthwhile * best.pose.terms.norm()) {
      best = std::move(found);
    }
  }

  void report_status(inverse::SearchEnd end, bool reached) {
    switch (end) {
      case inverse::SearchEnd::reached:
        break;
      case inverse::SearchEnd::stationary:
        result_.status = InverseStatus::unreachable;
        result_.remark = "no change of the actuation inside the ranges brings the goals nearer";
        break;
      case inverse::SearchEnd::none_left:
        result_.remark = "the limit of " + std::to_string(options_.max_equilibria) + " equilibria was reached";
        break;
      case inverse::SearchEnd::stuck:
        result_.remark = "the search came to a limit of the robot's equilibria";
        break;
      case inverse::SearchEnd::interrupted:
        result_.status = InverseStatus::interrupted;
        result_.remark = "interrupted";
        break;
    }
    if (!reached) return;
    result_.status = InverseStatus::reached;
    result_.remark.clear();
  }

  void conclude(inverse::SearchResult found, const inverse::SearchSettings& settings) {
    const bool reached = found.pose.miss <= 1;
    report_status(found.end, reached);
    result_.slope = found.slope;
    report_active(found, settings);
    const bool released = reached && found.slopes.sensitivity.regular &&
                          response_.release(found.pose, found.slopes, settings.preferred, settings.resolution_mm);
    const bool same = found.slopes.sensitivity.regular && !released && !(found.pose.idle.array() > 0).any();
    slacken(found.pose, settings);
    result_.sensitivity = same ? std::move(found.slopes.sensitivity)
                               : statics_.sensitivity(found.pose.equilibrium.state, options_.statics);
    finish(std::move(found.pose));
  }

  /// Reports the commands at an end of their range beyond which the error, or where there is none the distance from the
  /// preferred actuation, would fall further.
  void report_active(const inverse::SearchResult& found, const inverse::SearchSettings& settings) {
    constexpr double at_the_end = 1e-9;
    result_.active.assign(model_.actuators.size(), 0);
    const inverse::Pose& pose = found.pose;
    if (found.slopes.terms.cols() != pose.fractions.size()) return;
    const bool reached = pose.miss <= 1;
    const Eigen::VectorXd slope =
        reached ? Eigen::VectorXd(pose.fractions - settings.preferred)
                : Eigen::VectorXd(found.slopes.terms.transpose() * pose.terms / pose.terms.norm());
    const double least = reached ? options_.preferred_tolerance : 1e-9 * found.slopes.terms.norm();
    for (Index i = 0; i < pose.fractions.size(); ++i) {
      int& active = result_.active[response_.free()[i]];
      if (pose.fractions[i] <= at_the_end && slope[i] > least) active = -1;
      if (pose.fractions[i] >= 1 - at_the_end && slope[i] < -least) active = 1;
    }
  }

  /// Gives slack cables the length that is preferred: their shape is the same.
  void slacken(inverse::Pose& pose, const inverse::SearchSettings& settings) const {
    State& state = pose.equilibrium.state;
    const Actuation preferred = response_.actuation_of(settings.preferred, state.actuation);
    for (Index i = 0; i < pose.idle.size(); ++i) {
      if (!(pose.idle[i] > 0)) continue;
      const Index a = response_.free()[i];
      state.actuation[a] = std::max(state.actuation[a], preferred[a]);
    }
  }

  void finish(inverse::Pose pose) {
    if (!is_reported(pose.equilibrium) && !response_.interrupted()) look_at(pose.equilibrium);
    result_.errors_mm = response_.errors_at(pose.equilibrium.state);
    if (result_.status != InverseStatus::reached) result_.remark += untouched(pose.equilibrium.state);
    result_.equilibrium = std::move(pose.equilibrium);
    result_.equilibrium.actuation = result_.equilibrium.state.actuation;
  }

  /// "; nothing touches 'floor' there" of each that is to be pressed.
  [[nodiscard]] std::string untouched(const State& state) const {
    std::string text;
    const std::vector<inverse::Exertion>& exertions = response_.exertions_at(state);
    for (std::size_t i = 0; i < exertions.size(); ++i)
      if (exertions[i].gap)
        text +=
            "; nothing touches '" + model_.contact.parts[std::get<ForceGoal>(goals_[i].what).index].name + "' there";
    return text;
  }

  /// Has it a report, or was it accepted as an equilibrium without a solve?
  static bool is_reported(const Equilibrium& equilibrium) { return !equilibrium.report.solver.empty(); }

  /// Solves for a start that has no report.
  void look_at(Equilibrium& start) {
    Equilibrium found;
    if (response_.solve(start.state.actuation, start.state, found)) {
      start = std::move(found);
      return;
    }
    start.report = found.report;
    result_.status = response_.interrupted() ? InverseStatus::interrupted : InverseStatus::not_converged;
    result_.remark = response_.interrupted() ? "interrupted" : "the start has no equilibrium: " + found.report.remark;
  }

  const Model& model_;
  const Statics& statics_;
  const std::vector<Goal>& goals_;
  const InverseOptions& options_;
  inverse::RobotResponse response_;
  InverseResult result_;
};

/// Records the cause where a search was stopped.
void report_stop(InverseResult& result, const Deadline& deadline) {
  result.stopped = result.stopped || result.status == InverseStatus::interrupted;
  if (!result.stopped || !deadline.passed()) return;
  result.status = InverseStatus::not_converged;
  result.remark = deadline.spent();
}

}  // namespace

const char* name_of(InverseMethod method) {
  return method == InverseMethod::newton ? "newton" : "gradient";
}

InverseOptions usual_options(InverseMethod method) {
  InverseOptions options;
  options.method = method;
  if (method == InverseMethod::gradient) options.tolerance_mm = 0.2;
  return options;
}

const char* name_of(InverseStatus status) {
  switch (status) {
    case InverseStatus::reached:
      return "reached";
    case InverseStatus::unreachable:
      return "not reached";
    case InverseStatus::interrupted:
      return "interrupted";
    case InverseStatus::not_converged:
      break;
  }
  return "not converged";
}

InverseResult solve_inverse(const Statics& statics, const std::vector<Goal>& goals, const State& start,
                            const InverseOptions& options, const ProgressCallback& progress) {
  return solve_inverse(statics, goals, Equilibrium{start, {}, {}}, options, progress);
}

InverseResult solve_inverse(const Statics& statics, const std::vector<Goal>& goals, const Equilibrium& start,
                            const InverseOptions& options, const ProgressCallback& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const Model& model = statics.model();
  check_goals(model, goals);
  check_options(model, start.state, options);
  const bool known = start.report.status == Status::converged;
  InverseResult result = Inverse(statics, goals, options, progress).solve(start, known);
  report_stop(result, options.statics.deadline);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

InverseResult solve_inverse_from(const Statics& statics, const std::vector<Goal>& goals, const Actuation& start,
                                 const InverseOptions& options, const ProgressCallback& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const auto seconds = [begin] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const Model& model = statics.model();
  check_goals(model, goals);
  const Progress nothing_yet{0, std::numeric_limits<double>::infinity(), options.tolerance_mm, -1};
  Equilibrium first = statics.solve(start, statics.rest(), options.statics,
                                    [&](const Progress&) { return !progress || progress(nothing_yet); });
  InverseResult result;
  if (first.report.status != Status::converged) {
    result.stopped = first.report.stopped;
    result.status = result.stopped ? InverseStatus::interrupted : InverseStatus::not_converged;
    result.remark =
        result.stopped ? "interrupted before its start" : "the start has no equilibrium: " + first.report.remark;
    if (result.stopped && !any_force(goals)) result.errors_mm = goal_errors(model, goals, first.state.positions);
    report_stop(result, options.statics.deadline);
    result.active.assign(model.actuators.size(), 0);
    result.equilibria = 1;
    result.equilibrium = std::move(first);
    result.seconds = seconds();
    return result;
  }
  const double error =
      inverse::errors_of(model, goals, first.state.positions, inverse::exertions_of(statics, goals, first.state))
          .maxCoeff();
  InverseOptions begun = options;  // at the start's time
  begun.statics.history = first.state.history;
  result = solve_inverse(statics, goals, first, begun, progress);
  result.history.insert(result.history.begin(), {first.actuation, first.report.status, error, first.report.iterations});
  ++result.equilibria;
  result.seconds = seconds();
  return result;
}

}  // namespace softkin
