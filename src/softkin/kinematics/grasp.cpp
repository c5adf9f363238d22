#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/grasp.hpp>
#include <softkin/model/names.hpp>
#include <tuple>
#include <utility>

namespace softkin {

namespace {

constexpr double begin_share = 0.1;   // of what presses on the body, to begin with
constexpr double least_share = 1e-6;  // the same, of the largest that may be commanded
constexpr double gravity = 9.81;      // m/s^2
constexpr double accuracy = 1e-4;     // of the largest pull
constexpr double approach = 0.8;      // of the way to the maximum that is foretold

const FreeBody& body_at(const Model& model, Index body) {
  if (body < 0 || body >= static_cast<Index>(model.bodies.size()))
    throw InvalidInput("the robot has no body " + std::to_string(body) + " (from 0)");
  return model.bodies[static_cast<std::size_t>(body)];
}

ProgressCallback told(const GraspProgress& progress, const std::string& doing) {
  if (!progress) return {};
  return [&progress, doing](const Progress& p) { return progress(doing, p); };
}

/// From equilibrium to equilibrium, as long as there is one.
class Closing {
 public:
  Closing(const Statics& statics, const StaticsOptions& options, const GraspProgress& progress, Grasp& grasp)
      : statics_(statics), options_(options), progress_(progress), grasp_(grasp) {
    grasp_.last.state = statics.rest();
  }

  /// failure: what it means where there is no equilibrium
  bool go(const Actuation& actuation, const std::string& doing, const std::string& failure) {
    Equilibrium& last = grasp_.last;
    last = statics_.solve(actuation, last.state, options_, told(progress_, doing));
    if (last.report.status == Status::converged) return true;
    const bool interrupted = last.report.status == Status::interrupted;
    grasp_.remark = (interrupted ? "interrupted while " + doing : failure + ": " + last.report.remark);
    return false;
  }

 private:
  const Statics& statics_;
  const StaticsOptions& options_;
  const GraspProgress& progress_;
  Grasp& grasp_;
};

}  // namespace

Pressed pressed(const Model& model, Index body, const ElementDeformation& shape) {
  const std::string& name = body_at(model, body).name;
  Pressed sum;
  if (!shape.contacts) return sum;
  const auto is_body = [&](Index part) { return model.contact.parts[static_cast<std::size_t>(part)].name == name; };
  double slipping = 0;
  bool rubs = false;
  for (const PairForces& pair : shape.contacts->pairs) {
    if (!is_body(pair.a) && !is_body(pair.b)) continue;
    sum.normal_N += pair.normal_N;
    rubs = rubs || pair.slipping;
    slipping += pair.slipping.value_or(0) * pair.normal_N;
  }
  if (rubs && sum.normal_N > 0) sum.slipping = slipping / sum.normal_N;
  return sum;
}

Grasp close_around(const Model& model, const Statics& statics, const std::vector<Actuation>& closing, Index body,
                   const StaticsOptions& options, const GraspProgress& progress, const GraspStage& stage) {
  const std::string name = "'" + body_at(model, body).name + "'";
  if (closing.empty()) throw InvalidInput("a grasp needs an actuation that the gripper closes with");
  Grasp grasp;
  Closing gripper(statics, options, progress, grasp);
  for (std::size_t i = 0; i < closing.size(); ++i) {
    const std::string doing = closing.size() > 1 ? "closing, step " + std::to_string(i) : "closing";
    if (!gripper.go(closing[i], doing, doing)) return grasp;
    if (stage) stage(doing, grasp.last);
  }
  const Actuation released = pulled(model, closing.back(), body, Vec3::UnitX(), 0);
  grasp.held = gripper.go(released, "releasing " + name, name + " is not held when it is released");
  if (stage && grasp.held) stage("releasing " + name, grasp.last);
  return grasp;
}

std::vector<PullDirection> axes_to_pull_along() {
  std::vector<PullDirection> directions;
  for (Index axis = 0; axis < 3; ++axis)
    for (const int sign : {1, -1})
      directions.push_back({std::string(sign < 0 ? "-" : "") + "xyz"[axis], sign * Vec3::Unit(axis)});
  return directions;
}

const char* what_then(const Pull& pull) {
  if (pull.status == Status::converged) return "holds more";
  if (pull.status != Status::limit) return name_of(pull.status);
  return pull.pressed.slipping.value_or(0) >= 0.5 ? "slips" : "gives way";
}

Actuation pulled(const Model& model, Actuation actuation, Index body, const Vec3& direction, double force_N) {
  (void)body_at(model, body);
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& command = model.actuators[a];
    if (command.other != body) continue;
    if (command.kind == ActuatorKind::hold) actuation[static_cast<Index>(a)] = 0;
    if (command.kind == ActuatorKind::force) actuation[static_cast<Index>(a)] = force_N * direction[command.axis];
  }
  return actuation;
}

double most_pull(const Model& model, Index body) {
  (void)body_at(model, body);
  for (const Actuator& command : model.actuators)
    if (command.kind == ActuatorKind::force && command.other == body) return command.high;
  return 0;
}

void LoadMaximum::add(double load, double way) {
  points_.push_back({points_.empty() ? way : points_.back().way + way, load});
  if (points_.size() > 3) points_.erase(points_.begin());
}

std::optional<double> LoadMaximum::estimate() const {
  if (points_.size() < 3) return std::nullopt;
  const auto& [a, b, c] = std::tie(points_[0], points_[1], points_[2]);
  const double before = (b.load - a.load) / (b.way - a.way), last = (c.load - b.load) / (c.way - b.way);
  const double bend = (last - before) / (c.way - a.way);
  if (!(bend < 0)) return std::nullopt;
  const double slope = last + bend * (c.way - b.way);  // at the last one
  return slope > 0 ? c.load + slope * slope / (-4 * bend) : c.load;
}

namespace {

/// The root mean square of the moves of a body's vertices [mm].
double way_of(const FreeBody& body, const Points& from, const Points& to) {
  double sum = 0;
  for (const Index v : body.vertices) sum += (to.row(v) - from.row(v)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(body.vertices.size()));
}

/// From equilibrium to equilibrium below the largest pull.
class Pulling {
 public:
  Pulling(const Model& model, const Statics& statics, const State& grasp, Index body, const StaticsOptions& options,
          const GraspProgress& progress, Pull& pull)
      : model_(model),
        statics_(statics),
        grasp_(grasp),
        body_(body),
        options_(options),
        progress_(progress),
        pull_(pull) {
    maximum_.add(0, 0);
  }

  void to_limit(double first, double most) {
    double step = first;
    for (int tries = 0; tries < most_tries; ++tries) {
      const double force = next(step, most);
      const double before = pull_.force_N;
      const Outcome outcome = go(force, usual_iterations);
      if (outcome == Outcome::stopped) return;
      if (outcome == Outcome::missed) unmet_ = force;
      if (pull_.force_N >= most) return end(Status::converged);
      const std::optional<double> largest = foretold();
      if (largest && *largest - pull_.force_N <= accuracy * *largest) return end(Status::limit);
      if (unmet_ - pull_.force_N <= accuracy * unmet_ && !goes_on()) return;
      const double grown = pull_.force_N > before ? pull_.force_N : 0.5 * step;
      step = largest ? approach * (*largest - pull_.force_N) : grown;
    }
    pull_.status = Status::not_converged;
    pull_.last.report.remark = "the largest pull was not found in " + std::to_string(most_tries) + " tries";
  }

 private:
  enum class Outcome { met, missed, stopped };

  static constexpr int most_tries = 60, usual_iterations = 25, patient_iterations = 200;

  /// Below what was not met.
  [[nodiscard]] double next(double step, double most) const {
    const double low = pull_.force_N;
    return std::min({most, low + step, std::isfinite(unmet_) ? 0.5 * (low + unmet_) : most});
  }

  /// The maximum, where it lies below what was not met.
  [[nodiscard]] std::optional<double> foretold() const {
    const std::optional<double> largest = maximum_.estimate();
    return largest && *largest < unmet_ ? largest : std::nullopt;
  }

  /// To an equilibrium at that force, or as near as so many iterations lead.
  Outcome go(double force, int iterations) {
    bool spent = false;
    const std::string doing = "pulling along " + pull_.direction.name + ", " + number(pull_.force_N, 3) + " N held";
    const ProgressCallback tell = [&](const Progress& p) {
      spent = p.iteration > iterations;
      return !spent && (!progress_ || progress_(doing, p));
    };
    Equilibrium found = statics_.solve(pulled(model_, grasp_.actuation, body_, pull_.direction.along, force),
                                       pull_.last.state, options_, tell);
    const SolveReport report = found.report;
    const double before = pull_.force_N, share = std::clamp(report.reached, 0.0, 1.0);
    const bool met = report.status == Status::converged;
    if (found.state.knows(grasp_.actuation.size()) && share > 0)
      take(met ? force : before + share * (force - before), std::move(found));
    if (report.stopped && !spent) {
      pull_.status = report.status;
      pull_.last.report = report;
      return Outcome::stopped;
    }
    return met ? Outcome::met : Outcome::missed;
  }

  void take(double force, Equilibrium&& found) {
    const double way =
        way_of(model_.bodies[static_cast<std::size_t>(body_)], pull_.last.state.positions, found.state.positions);
    if (force > pull_.force_N && way > 0) maximum_.add(force, way);
    pull_.force_N = std::max(force, pull_.force_N);
    pull_.last = std::move(found);
  }

  /// What was not met in few iterations may be met in many.
  bool goes_on() {
    const Outcome outcome = go(unmet_, patient_iterations);
    if (outcome == Outcome::missed) end(Status::limit);
    if (outcome == Outcome::met) unmet_ = std::numeric_limits<double>::infinity();
    return outcome == Outcome::met;
  }

  void end(Status status) {
    pull_.status = status;
    SolveReport& report = pull_.last.report;
    report.status = status;
    report.stopped = false;
    if (status == Status::limit) report.remark = "no larger pull has an equilibrium";
  }

  const Model& model_;
  const Statics& statics_;
  const State& grasp_;
  Index body_;
  const StaticsOptions& options_;
  const GraspProgress& progress_;
  Pull& pull_;
  LoadMaximum maximum_;
  double unmet_ = std::numeric_limits<double>::infinity();  // the least force that was not met [N]
};

}  // namespace

Pull largest_pull(const Model& model, const Statics& statics, const State& grasp, Index body,
                  const PullDirection& direction, std::optional<double> most_N, const StaticsOptions& options,
                  const GraspProgress& progress) {
  const FreeBody& held = body_at(model, body);
  if (!(direction.along.norm() > 0) || !direction.along.allFinite())
    throw InvalidInput("the direction of a pull has no length");
  if (most_N && !(*most_N > 0)) throw InvalidInput("the largest pull that is tried must be > 0 N");
  const double most = std::min(most_N.value_or(HUGE_VAL), most_pull(model, body));
  Pull pull;
  pull.direction = {direction.name, direction.along.normalized()};
  pull.last.state = grasp;
  pull.last.actuation = grasp.actuation;
  const double presses = std::max(gravity * held.mass_kg, pressed(model, body, statics.measured(grasp)).normal_N);
  const double first = std::min(most, std::max(begin_share * presses, least_share * most_pull(model, body)));
  Pulling(model, statics, grasp, body, options, progress, pull).to_limit(first, most);
  pull.moved_mm = (held.center.at(pull.last.state.positions) - held.center.at(grasp.positions)).norm();
  pull.pressed = pressed(model, body, statics.measured(pull.last.state));
  return pull;
}

}  // namespace softkin
