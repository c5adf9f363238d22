#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/walk.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr double stands = 4;       // feet stick where their distance changes by at most this, in solver tolerances
constexpr double straight = 1e-6;  // feet may leave their line by so much of their distance
constexpr int max_trials = 60;     // for the friction of feet that stand

struct FootForces {
  double shortening = 0, lengthening = 0;  // friction at which a foot slides as the body does [N]
  Sliding when_shortening = Sliding::both, when_lengthening = Sliding::both;
};

Sliding weaker(double rear, double front) {
  if (rear == front) return Sliding::both;
  return rear < front ? Sliding::rear : Sliding::front;
}

/// A body that shortens pulls the rear foot forward and the front one backward.
FootForces forces_of(const Foot& rear, const Foot& front) {
  return {std::min(rear.forward, front.backward), std::min(rear.backward, front.forward),
          weaker(rear.forward, front.backward), weaker(rear.backward, front.forward)};
}

const EmbeddedPoint& point_of(const Model& model, const Foot& foot) {
  return model.markers[foot.marker].point;
}

Vec3 direction_of(const Model& model) {
  if (model.feet.size() != 2)
    throw InvalidInput({.file = model.name}, "the robot has no feet to walk on: the scene needs key 'feet'");
  const Vec3 apart = point_of(model, model.feet[1]).at(model.rest) - point_of(model, model.feet[0]).at(model.rest);
  if (!(apart.norm() > 1e-9 * model.diagonal_mm))
    throw InvalidInput({.file = model.name}, "the feet stand at one place");
  return apart.normalized();
}

std::string axes_along(const Vec3& direction) {
  std::string axes;
  for (Index axis = 0; axis < 3; ++axis)
    if (std::abs(direction[axis]) > straight) axes += "xyz"[axis];
  return axes;
}

/// Is the robot free to go where it walks to?
void check_holds(const Model& model, const Vec3& direction) {
  const double rear = direction.dot(point_of(model, model.feet[0]).at(model.rest));
  const double front = direction.dot(point_of(model, model.feet[1]).at(model.rest));
  bool at_rear = false, at_front = false;
  for (std::size_t v = 0; v < model.held.fixed.size(); ++v) {
    if (!model.elements.used[v]) continue;
    bool held = false;
    for (Index axis = 0; axis < 3; ++axis)
      held = held || (model.held.fixed[v][axis] && std::abs(direction[axis]) > straight);
    if (!held) continue;
    const bool near_front = direction.dot(model.rest.row(v)) > (rear + front) / 2;
    (near_front ? at_front : at_rear) = true;
  }
  if (at_rear && at_front)
    throw InvalidInput({.file = model.name},
                       "the feet cannot slide: the robot is held along " + axes_along(direction) +
                           " on both sides; hold it so at one foot alone, and the other one along the other axes");
}

/// Refuses fields that are not uniform: a uniform field exerts moments on a robot, but no resultant force.
void check_fields(const Model& model) {
  if (!model.magnetism) return;
  for (const FieldSource& source : model.magnetism->sources)
    if (!std::holds_alternative<UniformField>(source.field))
      throw InvalidInput({.file = model.name}, "the magnetic field '" + source.name +
                                                   "' pulls along the direction of travel: a walk is in fields that "
                                                   "are the same everywhere");
}

void check_loads(const Model& model, const Vec3& direction) {
  if (model.loads.any_by_shape())
    throw InvalidInput({.file = model.name},
                       "a pressure, traction or moment may push along the direction "
                       "of travel as the robot bends: a walk has none");
  if (model.loads.dead.size() == 0) return;
  const double along = (model.loads.dead * direction).sum();
  if (std::abs(along) > 1e-9 * model.loads.dead.rowwise().norm().sum())
    throw InvalidInput({.file = model.name}, "weight and forces act along the direction of travel with " +
                                                 std::to_string(along) + " N: a walk is on a level floor");
}

void check_surroundings(const Model& model) {
  for (const ContactPart& part : model.contact.parts)
    if (part.rank != ContactRank::robot)
      throw InvalidInput(part.origin, "'" + part.name + "' stands where it is while the robot walks away from it: " +
                                          "a walk knows no floor but that of the feet; leave it out");
}

/// Returns the robot with a cable between its feet that carries the force through the floor: a tension of either sign.
Model linked(const Model& model, const FootForces& limits) {
  Model robot = model;
  Actuator link;
  link.name = "friction";
  link.control = Control::load;
  link.low = -limits.shortening;
  link.high = limits.lengthening;
  link.rest = 0;
  CableDrive cable;
  for (const Foot& foot : model.feet) cable.points.push_back(point_of(model, foot));
  link.rest_measure = (cable.points[1].at(model.rest) - cable.points[0].at(model.rest)).norm();
  link.drive = std::move(cable);
  robot.actuators.push_back(std::move(link));
  return robot;
}

}  // namespace

struct Walker::Parts {
  Parts(const Model& robot, const StaticsOptions& solver)
      : direction(direction_of(robot)),
        forces(forces_of(robot.feet[0], robot.feet[1])),
        physical(robot.formulation == Formulation::physical),
        model(physical ? linked(robot, forces) : robot),
        statics((check_holds(robot, direction), check_loads(robot, direction), check_fields(robot),
                 check_surroundings(robot), model)),
        options(solver),
        actuators(robot.actuators.size()),
        state(statics.rest()) {
    origin = direction.dot(point_of(robot, robot.feet[0]).at(robot.rest));
  }

  /// A shape under a friction; distance between the feet in it.
  struct Trial {
    Equilibrium found;
    double friction = 0, distance = 0;
  };

  [[nodiscard]] double place(std::size_t foot, const Points& positions) const {
    return direction.dot(point_of(model, model.feet[foot]).at(positions)) - origin;
  }

  [[nodiscard]] Trial trial(const Actuation& actuation, double force, const State& start,
                            const ProgressCallback& progress, int& count) const {
    Actuation all = actuation;
    if (physical) {
      all.conservativeResize(actuators + 1);
      all[actuators] = -force;
    }
    ++count;
    Trial result{statics.solve(all, start, options, progress), force, 0};
    const Points& positions = result.found.state.positions;
    const Vec3 apart = point_of(model, model.feet[1]).at(positions) - point_of(model, model.feet[0]).at(positions);
    result.distance = apart.dot(direction);
    const double aside = (apart - result.distance * direction).norm();
    if (good(result) && aside > straight * apart.norm())
      throw InvalidInput({.file = model.name}, "the feet leave the line between them by " + std::to_string(aside) +
                                                   " mm: hold both feet across the direction of travel");
    return result;
  }

  /// Change of the feet's distance up to which they stand [mm].
  [[nodiscard]] static double tolerance_mm(const Trial& trial) { return stands * trial.found.report.tolerance_mm; }

  [[nodiscard]] static bool good(const Trial& trial) { return trial.found.report.status == Status::converged; }

  /// Returns the shape at the distance at which the feet stood, or the one in which a foot slides.
  [[nodiscard]] Trial balanced(const Actuation& actuation, const ProgressCallback& progress, int& count) const {
    Trial first = trial(actuation, friction, state, progress, count);
    if (!placed || !good(first)) return first;
    const double miss = first.distance - distance;
    if (std::abs(miss) <= tolerance_mm(first)) return first;
    const double limit = !physical ? 0 : miss > 0 ? -forces.lengthening : forces.shortening;
    if (first.friction == limit) return first;
    Trial last = trial(actuation, limit, first.found.state, progress, count);
    const bool slides =
        miss > 0 ? last.distance > distance - tolerance_mm(last) : last.distance < distance + tolerance_mm(last);
    if (!good(last) || slides) return last;
    return standing(actuation, std::move(first), std::move(last), progress, count);
  }

  /// Solves for the friction between two values, of which one leaves the feet too near and the other too far: by false
  /// position, in the Illinois variant.
  [[nodiscard]] Trial standing(const Actuation& actuation, Trial a, Trial b, const ProgressCallback& progress,
                               int& count) const {
    double miss_a = a.distance - distance, miss_b = b.distance - distance;
    for (int i = 0; i < max_trials; ++i) {
      const double next = b.friction - miss_b * (b.friction - a.friction) / (miss_b - miss_a);
      Trial c = trial(actuation, next, b.found.state, progress, count);
      const double miss = c.distance - distance;
      if (!good(c) || std::abs(miss) <= tolerance_mm(c)) return c;
      if ((miss > 0) != (miss_b > 0)) {
        a = std::move(b);
        miss_a = miss_b;
      } else {
        miss_a /= 2;
      }
      b = std::move(c);
      miss_b = miss;
    }
    b.found.report.status = Status::not_converged;
    b.found.report.remark = "no friction was found that keeps the feet where they stand";
    return b;
  }

  /// Accepts a shape: the feet move to their places in it.
  [[nodiscard]] Sliding take(const Trial& found) {
    const double change = found.distance - distance;
    friction = found.friction;
    state = found.found.state;
    if (!placed) {
      placed = true;
      distance = found.distance;
      middle = distance / 2;
      return Sliding::none;
    }
    if (std::abs(change) <= tolerance_mm(found)) return Sliding::none;
    const Sliding sliding = change < 0 ? forces.when_shortening : forces.when_lengthening;
    const double fraction = sliding == Sliding::rear ? 1 : sliding == Sliding::front ? 0 : 0.5;
    rear -= fraction * change;
    distance = found.distance;
    return sliding;
  }

  [[nodiscard]] WalkStep reported(Trial found, Sliding sliding, int count) const {
    WalkStep step;
    step.sliding = sliding;
    step.friction_N = found.friction == 0 ? 0 : found.friction;
    step.rear_mm = rear;
    step.front_mm = rear + distance;
    step.travel_mm = rear + distance / 2 - middle;
    step.equilibria = count;
    step.equilibrium = std::move(found.found);
    State& shape = step.equilibrium.state;
    step.shift_mm = rear - place(0, shape.positions);
    shape.positions.rowwise() += step.shift_mm * direction.transpose();
    for (Eigen::VectorXd* values : {&shape.actuation, &shape.multipliers, &step.equilibrium.actuation})
      if (values->size() > actuators) values->conservativeResize(actuators);
    return step;
  }

  void go_on_from(const WalkStep& step) {
    statics.forget();
    placed = true;
    friction = step.friction_N;
    distance = step.front_mm - step.rear_mm;
    rear = step.rear_mm;
    middle = rear + distance / 2 - step.travel_mm;
    state = step.equilibrium.state;
    state.positions.rowwise() -= step.shift_mm * direction.transpose();
    for (Eigen::VectorXd* values : {&state.actuation, &state.multipliers}) {
      if (!physical || values->size() != actuators) continue;
      values->conservativeResize(actuators + 1);
      (*values)[actuators] = -friction;
    }
  }

  Vec3 direction;
  FootForces forces;
  bool physical;
  Model model;
  Statics statics;
  StaticsOptions options;
  Index actuators;
  double origin = 0;    // where the rear foot stands at rest, along the direction of travel [mm]
  State state;          // of the body where the scene holds it
  bool placed = false;  // does it stand on the floor
  double friction = 0;  // that stretches it [N]
  double distance = 0;  // of the feet, where they stand [mm]
  double rear = 0;      // where the rear one stands [mm]
  double middle = 0;    // between the feet, where the robot was put down [mm]
};

Walker::Walker(const Model& model, const StaticsOptions& options) : parts_(std::make_unique<Parts>(model, options)) {}
Walker::~Walker() = default;
Walker::Walker(Walker&&) noexcept = default;
Walker& Walker::operator=(Walker&&) noexcept = default;

const Vec3& Walker::direction() const {
  return parts_->direction;
}

void Walker::resume(const WalkStep& step) {
  parts_->go_on_from(step);
}

WalkStep Walker::advance(const Actuation& actuation, const ProgressCallback& progress) {
  if (actuation.size() != parts_->actuators)
    throw InvalidInput("the actuation has " + std::to_string(actuation.size()) + " values, the robot " +
                       std::to_string(parts_->actuators) + " actuators");
  int count = 0;
  Parts::Trial found = parts_->balanced(actuation, progress, count);
  const Sliding sliding = Parts::good(found) ? parts_->take(found) : Sliding::none;
  return parts_->reported(std::move(found), sliding, count);
}

}  // namespace softkin
