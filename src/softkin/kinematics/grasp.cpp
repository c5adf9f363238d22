#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/grasp.hpp>
#include <softkin/model/names.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr double begin_fraction = 0.1;  // of the normal contact force on the body: the first force
constexpr double min_fraction = 1e-6;   // the same, of the largest that may be commanded
constexpr double gravity = 9.81;        // m/s^2
constexpr double accuracy = 1e-3;       // of the largest pull
constexpr double nearly = 0.9;          // of the friction that there can be: where so much is used, the body slips

const FreeBody& body_at(const Model& model, Index body) {
  if (body < 0 || body >= std::ssize(model.bodies))
    throw InvalidInput("the robot has no body " + std::to_string(body) + " (from 0)");
  return model.bodies[body];
}

ProgressCallback reported(const GraspProgress& progress, const std::string& doing) {
  if (!progress) return {};
  return [&progress, doing](const Progress& p) { return progress(doing, p); };
}

/// How far a body's centre moved [mm].
double moved(const FreeBody& body, const Points& from, const Points& to) {
  return (body.center.at(to) - body.center.at(from)).norm();
}

/// The longest edge of the box around a body [mm].
double size_mm(const Model& model, const FreeBody& body) {
  const Points surface = model.rest(body.vertices, Eigen::all);
  return (surface.colwise().maxCoeff() - surface.colwise().minCoeff()).maxCoeff();
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
    last = statics_.solve(actuation, last.state, options_, reported(progress_, doing));
    if (last.report.status == Status::converged) return true;
    const bool unknown = last.report.status == Status::not_converged;
    grasp_.remark = last.report.status == Status::interrupted
                        ? "interrupted while " + doing
                        : (unknown ? "not converged while " + doing : failure) + ": " + last.report.remark;
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
  const auto is_body = [&](Index part) { return model.contact.parts[part].name == name; };
  double slipping = 0;
  bool has_friction = false;
  for (const PairForces& pair : shape.contacts->pairs) {
    if (!is_body(pair.a) && !is_body(pair.b)) continue;
    sum.normal_N += pair.normal_N;
    has_friction = has_friction || pair.slipping;
    slipping += pair.slipping.value_or(0) * pair.normal_N;
  }
  if (has_friction && sum.normal_N > 0) sum.slipping = slipping / sum.normal_N;
  return sum;
}

Grasp close_around(const Statics& statics, const std::vector<Actuation>& closing, Index body,
                   const StaticsOptions& options, const GraspProgress& progress, const GraspStage& stage) {
  const Model& model = statics.model();
  const FreeBody& held = body_at(model, body);
  const std::string name = "'" + held.name + "'";
  if (closing.empty()) throw InvalidInput("a grasp needs an actuation that the gripper closes with");
  Grasp grasp;
  Closing gripper(statics, options, progress, grasp);
  for (std::size_t i = 0; i < closing.size(); ++i) {
    const std::string doing = closing.size() > 1 ? "closing, step " + std::to_string(i) : "closing";
    if (!gripper.go(closing[i], doing, doing)) return grasp;
    if (stage) stage(doing, grasp.last);
  }
  const Actuation released = pulled(model, closing.back(), body, Vec3::UnitX(), 0);
  const std::string not_held = name + " is not held when it is released";
  const Points closed = grasp.last.state.positions;
  grasp.held = gripper.go(released, "releasing " + name, not_held);
  const double moved_mm = moved(held, closed, grasp.last.state.positions);
  if (grasp.held && moved_mm > size_mm(model, held)) {
    grasp.held = false;
    grasp.remark = not_held + ": it comes to rest " + number(moved_mm, 4) + " mm away";
  }
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
  return pull.slips ? "slips" : "gives way";
}

Actuation pulled(const Model& model, Actuation actuation, Index body, const Vec3& direction, double force_N) {
  (void)body_at(model, body);
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& command = model.actuators[a];
    if (const auto* hold = command.as<HoldCommand>(); hold && hold->body == body) actuation[a] = 0;
    if (const auto* force = command.as<ForceCommand>(); force && force->body == body)
      actuation[a] = force_N * direction[force->axis];
  }
  return actuation;
}

double max_pull(const Model& model, Index body) {
  (void)body_at(model, body);
  for (const Actuator& command : model.actuators)
    if (const auto* force = command.as<ForceCommand>(); force && force->body == body) return command.high;
  return 0;
}

namespace {

/// From equilibrium to equilibrium below the largest pull.
class Pulling {
 public:
  Pulling(const Statics& statics, const State& grasp, Index body, const StaticsOptions& options,
          const GraspProgress& progress, Pull& pull)
      : model_(statics.model()),
        statics_(statics),
        grasp_(grasp),
        body_(body),
        options_(options),
        progress_(progress),
        pull_(pull) {}

  void to_limit(double first, double most) {
    double step = first;
    bool missed = false;
    for (;;) {
      const double force = std::min(most, pull_.force_N + step);
      const Outcome outcome = go(force);
      if (outcome == Outcome::stopped) return;
      if (outcome == Outcome::met && force >= most) return end(Status::converged);
      if (outcome == Outcome::met) {
        if (!missed) step *= growth;
        continue;
      }
      missed = true;
      if (step <= std::max(accuracy * pull_.force_N, least * first)) return end(Status::limit);
      step *= shrinking;
    }
  }

 private:
  enum class Outcome { met, missed, stopped };

  static constexpr double growth = 2, shrinking = 0.4, least = 1e-3;  // of steps
  static constexpr int patience = 25;                                 // iterations that lead no farther
  static constexpr double far = 0.01;                                 // of the diagonal, in one of them
  static constexpr int min_iterations = 5;                            // iterations before which far moves are right

  /// Solves for the equilibrium at that force. Where there is none the body flies off: such solves are ended early.
  Outcome go(double force) {
    bool astray = false;
    int since = 0;
    double fraction = -1;
    const std::string doing = "pulling along " + pull_.direction.name + ", " + number(pull_.force_N, 3) + " N held";
    const ProgressCallback describe = [&](const Progress& p) {
      if (p.fraction > fraction) {
        fraction = p.fraction;
        since = p.iteration;
      }
      const int idle = p.iteration - since;
      astray = idle > patience || (idle > min_iterations && p.step_mm > far * model_.diagonal_mm);
      return !astray && (!progress_ || progress_(doing, p));
    };
    Equilibrium found = statics_.solve(pulled(model_, grasp_.actuation, body_, pull_.direction.along, force),
                                       pull_.last.state, options_, describe);
    const SolveReport report = found.report;
    const double before = pull_.force_N, reached = std::clamp(report.reached, 0.0, 1.0);
    const bool met = report.status == Status::converged;
    if (found.state.knows(grasp_.actuation.size()) && reached > 0) {
      pull_.force_N = met ? force : before + reached * (force - before);
      pull_.last = std::move(found);
    }
    if (met) return Outcome::met;
    lost_ = !astray && report.status == Status::not_converged ? report.remark : "";
    if (astray || !report.stopped) return Outcome::missed;
    pull_.status = report.status;
    pull_.last.report = report;
    return Outcome::stopped;
  }

  /// Returns the tangential contact forces on the body over the maximum that friction can carry [-]; 0 without
  /// friction.
  [[nodiscard]] double friction_used() const {
    const ElementDeformation shape = statics_.measured(pull_.last.state);
    const std::string& name = model_.bodies[body_].name;
    double used = 0, most = 0;
    if (!shape.contacts) return 0;
    for (const PairForces& pair : shape.contacts->pairs) {
      const auto is_body = [&](Index part) { return model_.contact.parts[part].name == name; };
      if (!is_body(pair.a) && !is_body(pair.b)) continue;
      used += std::sqrt(std::max(0.0, pair.force.squaredNorm() - pair.normal_N * pair.normal_N));
      most += model_.contact.pair(pair.a, pair.b).friction * pair.normal_N;
    }
    return most > 0 ? used / most : 0;
  }

  void end(Status status) {
    pull_.status = status;
    SolveReport& report = pull_.last.report;
    report.status = status;
    report.stopped = false;
    if (status == Status::converged) return;
    report.remark = lost_.empty() ? "no equilibrium was found under a larger pull" : lost_;
    pull_.slips = lost_.empty() && friction_used() >= nearly;
    if (pull_.slips) report.remark += ", where it slips";
    if (!lost_.empty()) pull_.status = report.status = Status::not_converged;
  }

  const Model& model_;
  const Statics& statics_;
  const State& grasp_;
  Index body_;
  const StaticsOptions& options_;
  const GraspProgress& progress_;
  Pull& pull_;
  std::string lost_;  // why the last step that was missed did not converge; empty: it has no equilibrium
};

}  // namespace

Pull largest_pull(const Statics& statics, const State& grasp, const PullTask& task, const StaticsOptions& options,
                  const GraspProgress& progress) {
  const Model& model = statics.model();
  const auto& [body, direction, max_N] = task;
  const FreeBody& held = body_at(model, body);
  if (!(direction.along.norm() > 0) || !direction.along.allFinite())
    throw InvalidInput("the direction of a pull has no length");
  if (max_N && !(*max_N > 0)) throw InvalidInput("the largest pull that is tried must be > 0 N");
  const double most = std::min(max_N.value_or(HUGE_VAL), max_pull(model, body));
  Pull pull;
  pull.direction = {direction.name, direction.along.normalized()};
  pull.last.state = grasp;
  pull.last.actuation = grasp.actuation;
  const double presses = std::max(gravity * held.mass_kg, pressed(model, body, statics.measured(grasp)).normal_N);
  const double first = presses > 0 ? begin_fraction * presses : min_fraction * max_pull(model, body);
  Pulling(statics, grasp, body, options, progress, pull).to_limit(first, most);
  pull.moved_mm = moved(held, grasp.positions, pull.last.state.positions);
  pull.pressed = pressed(model, body, statics.measured(pull.last.state));
  return pull;
}

}  // namespace softkin
