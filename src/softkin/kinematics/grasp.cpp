#include <algorithm>
#include <cmath>
#include <softkin/kinematics/grasp.hpp>

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

/// What presses on a body, the magnitudes of all normal forces [N].
double pressed(const Model& model, const FreeBody& body, const ElementDeformation& shape) {
  double sum = 0;
  if (!shape.contacts) return sum;
  for (const PairForces& pair : shape.contacts->pairs)
    for (const Index part : {pair.a, pair.b})
      if (model.contact.parts[static_cast<std::size_t>(part)].name == body.name) sum += pair.normal_N;
  return sum;
}

}  // namespace

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

Pull largest_pull(const Model& model, const Statics& statics, const State& grasp, Index body, const Vec3& direction,
                  double most_N, const StaticsOptions& options, const ProgressCallback& progress) {
  const FreeBody& held = body_at(model, body);
  if (!(direction.norm() > 0) || !direction.allFinite()) throw InvalidInput("the direction of a pull has no length");
  if (!(most_N > 0)) throw InvalidInput("the largest pull that is tried must be > 0 N");
  most_N = std::min(most_N, most_pull(model, body));
  Pull pull;
  pull.direction = direction.normalized();
  pull.last.state = grasp;
  pull.last.actuation = grasp.actuation;
  const double first = std::max(gravity * held.mass_kg, pressed(model, held, statics.measured(grasp)));
  double force = std::min(most_N, std::max(first, least_share * most_pull(model, body)));
  for (;;) {
    Equilibrium found =
        statics.solve(pulled(model, grasp.actuation, body, pull.direction, force), pull.last.state, options, progress);
    pull.status = found.report.status;
    const double before = pull.force_N;
    if (pull.status == Status::converged)
      pull.force_N = force;
    else
      pull.force_N = before + std::clamp(found.report.reached, 0.0, 1.0) * (force - before);
    if (found.state.knows(grasp.actuation.size())) pull.last = std::move(found);
    if (pull.status != Status::converged || force >= most_N) break;
    force = std::min(most_N, growth * force);
  }
  pull.moved_mm = (held.center.at(pull.last.state.positions) - held.center.at(grasp.positions)).norm();
  return pull;
}

}  // namespace softkin
