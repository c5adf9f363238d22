#include <algorithm>
#include <cmath>
#include <softkin/kinematics/grasp.hpp>
#include <softkin/model/names.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr double growth = 4;          // of the pull from try to try
constexpr double least_share = 1e-6;  // of the largest that may be commanded, to begin with
constexpr double gravity = 9.81;      // m/s^2

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
                   const StaticsOptions& options, const GraspProgress& progress) {
  const std::string name = "'" + body_at(model, body).name + "'";
  if (closing.empty()) throw InvalidInput("a grasp needs an actuation that the gripper closes with");
  Grasp grasp;
  Closing gripper(statics, options, progress, grasp);
  for (std::size_t i = 0; i < closing.size(); ++i) {
    const std::string doing = closing.size() > 1 ? "closing, step " + std::to_string(i) : "closing";
    if (!gripper.go(closing[i], doing, doing)) return grasp;
  }
  const Actuation released = pulled(model, closing.back(), body, Vec3::UnitX(), 0);
  grasp.held = gripper.go(released, "releasing " + name, name + " is not held when it is released");
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
  return pull.last.report.remark.find("slips") != std::string::npos ? "slips" : "gives way";
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
  const double first = std::max(gravity * held.mass_kg, pressed(model, body, statics.measured(grasp)).normal_N);
  double force = std::min(most, std::max(first, least_share * most_pull(model, body)));
  const ProgressCallback tell = told(progress, "pulling along " + direction.name);
  for (;;) {
    Equilibrium found = statics.solve(pulled(model, grasp.actuation, body, pull.direction.along, force),
                                      pull.last.state, options, tell);
    pull.status = found.report.status;
    const double before = pull.force_N;
    if (pull.status == Status::converged)
      pull.force_N = force;
    else
      pull.force_N = before + std::clamp(found.report.reached, 0.0, 1.0) * (force - before);
    if (found.state.knows(grasp.actuation.size())) pull.last = std::move(found);
    if (pull.status != Status::converged || force >= most) break;
    force = std::min(most, growth * force);
  }
  pull.moved_mm = (held.center.at(pull.last.state.positions) - held.center.at(grasp.positions)).norm();
  pull.pressed = pressed(model, body, statics.measured(pull.last.state));
  return pull;
}

}  // namespace softkin
