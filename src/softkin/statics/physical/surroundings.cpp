#include <cmath>
#include <softkin/statics/physical/surroundings.hpp>

namespace softkin::physical {

namespace {

/// Stiffness of a held body, over the approximate stiffness of the robot: modulus times diagonal.
constexpr double stiffness_scale = 1e4;
/// Fraction of that stiffness at which a body is nearly released.
constexpr double loosest = 1e-8;

/// Fraction of the stiffness at a command from 0 to 1, and its derivative.
double firm_fraction(double command) {
  return (std::pow(loosest, 1 - command) - loosest) / (1 - loosest);
}

double firm_slope(double command) {
  return -std::log(loosest) * std::pow(loosest, 1 - command) / (1 - loosest);
}

}  // namespace

Surroundings::Surroundings(const Model& model)
    : model_(model), stiffest_(stiffness_scale * model.contact.modulus_MPa * model.diagonal_mm) {
  for (Index a = 0; a < std::ssize(model.actuators); ++a) any_ = any_ || loads(a);
}

bool Surroundings::loads(Index command) const {
  const Actuator& actuator = model_.actuators[command];
  return actuator.is<ForceCommand>() || actuator.is<HoldCommand>();
}

/// Adds the forces of a body's springs.
void Surroundings::add_spring(const FreeBody& body, double stiffness, const Points& positions, Points& gradient) const {
  const double each = stiffness / static_cast<double>(body.vertices.size());
  for (const Index v : body.vertices) gradient.row(v) += each * (positions.row(v) - model_.rest.row(v));
}

void Surroundings::add_force(const ForceCommand& force, double newtons, Points& gradient) const {
  const EmbeddedPoint& place = place_of(force);
  for (std::size_t i = 0; i < place.vertices.size(); ++i)
    gradient(place.vertices[i], force.axis) -= newtons * place.weights[i];
}

void Surroundings::evaluate(const Iterate& at, const LoadState& load_state, Scratch& /*scratch*/, Sum& sum,
                            Team& /*team*/) const {
  if (!any_) return;
  const Points& positions = at.positions;
  double energy = 0;
  for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
    const double command = load_state.actuation[a];
    if (const auto* hold = model_.actuators[a].as<HoldCommand>()) {
      const FreeBody& body = model_.bodies[hold->body];
      const double stiffness = stiffest_ * firm_fraction(command);
      add_spring(body, stiffness, positions, sum.gradient);
      for (const Index v : body.vertices)
        energy += 0.5 * stiffness / static_cast<double>(body.vertices.size()) *
                  (positions.row(v) - model_.rest.row(v)).squaredNorm();
    } else if (const auto* force = model_.actuators[a].as<ForceCommand>(); force && command != 0) {
      add_force(*force, command, sum.gradient);
      const EmbeddedPoint& place = place_of(*force);
      for (std::size_t i = 0; i < place.vertices.size(); ++i) {
        const Index v = place.vertices[i];
        energy -= command * place.weights[i] * (positions(v, force->axis) - model_.rest(v, force->axis));
      }
    }
  }
  sum.energy += energy;
}

void Surroundings::add_cliques(linear::Cliques& cliques) {
  first_slot_ = cliques.slots.back();
  for (const FreeBody& body : model_.bodies)
    for (const Index v : body.vertices) cliques.add(std::array<Index, 1>{v});
}

void Surroundings::stiffness(const Iterate& /*at*/, const LoadState& load_state, bool /*projected*/,
                             Scratch& /*scratch*/, LargeVector<double>& slots, Team& /*team*/) const {
  if (!any_body()) return;
  std::vector<double> of_body(model_.bodies.size());
  for (std::size_t a = 0; a < model_.actuators.size(); ++a)
    if (const auto* hold = model_.actuators[a].as<HoldCommand>())
      of_body[hold->body] = stiffest_ * firm_fraction(load_state.actuation[a]);
  double* slot = slots.data() + 9 * first_slot_;
  for (std::size_t b = 0; b < of_body.size(); ++b) {
    const std::size_t count = model_.bodies[b].vertices.size();
    for (std::size_t i = 0; i < count; ++i, slot += 9)
      for (int k = 0; k < 9; ++k) slot[k] = k % 4 == 0 ? of_body[b] / static_cast<double>(count) : 0;
  }
}

void Surroundings::add_change(const LoadState& from, const LoadState& to, const Points& positions, Scratch& scratch,
                              Points& force, Team& team) const {
  Points slope;
  for (Index a = 0; a < std::ssize(model_.actuators); ++a) {
    const double change = to.actuation[a] - from.actuation[a];
    if (change == 0 || !loads(a)) continue;
    if (const auto* command = model_.actuators[a].as<ForceCommand>()) {
      add_force(*command, change, force);
      continue;
    }
    slope.setZero(positions.rows(), 3);
    add_derivative(a, from, positions, scratch, slope, team);
    force += change * slope;
  }
}

void Surroundings::add_derivative(Index command, const LoadState& load_state, const Points& positions,
                                  Scratch& /*scratch*/, Points& force, Team& /*team*/) const {
  const Actuator& actuator = model_.actuators[command];
  if (const auto* hold = actuator.as<HoldCommand>())
    add_spring(model_.bodies[hold->body], stiffest_ * firm_slope(load_state.actuation[command]), positions, force);
  if (const auto* newtons = actuator.as<ForceCommand>()) add_force(*newtons, 1, force);
}

}  // namespace softkin::physical
