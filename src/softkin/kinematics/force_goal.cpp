#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/inverse_response.hpp>

namespace softkin {

namespace {

using inverse::Exertion;
using inverse::ExertionSlopes;

const ForceGoal* force_of(const Goal& goal) {
  return std::get_if<ForceGoal>(&goal.what);
}

bool is_part(const ForceGoal& goal) {
  return goal.on == ForceGoal::On::part;
}

bool touches(Index part, const std::vector<PairForces>& pairs) {
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const PairForces& pair) { return pair.a != pair.b && (pair.a == part || pair.b == part); });
}

/// Of every command, a unit of it.
std::vector<Actuation> unit_changes(const Model& model) {
  const Index m = model.actuators.size();
  std::vector<Actuation> changes;
  for (Index a = 0; a < m; ++a) changes.emplace_back(Actuation::Unit(m, a));
  return changes;
}

/// Returns the sum over one support of the reactions at the vertices, [N] or per unit of a parameter.
Vec3 on_support(const Model& model, Index support, const Points& reactions) {
  Vec3 sum = Vec3::Zero();
  for (Index v = 0; v < reactions.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (model.held.support_of[v][axis] == support) sum[axis] -= reactions(v, axis);
  return sum;
}

}  // namespace

bool any_force(const std::vector<Goal>& goals) {
  return std::any_of(goals.begin(), goals.end(), [](const Goal& goal) { return force_of(goal) != nullptr; });
}

std::vector<std::string> names_of_pressed(const Model& model) {
  std::vector<std::string> names;
  for (const Support& support : model.held.supports) names.push_back(support.name);
  for (const ContactPart& part : model.contact.parts)
    if (part.rank != ContactRank::robot) names.push_back(part.name);
  return names;
}

ForceGoal force_on(const Model& model, const std::string& name) {
  std::vector<ForceGoal> found;
  for (std::size_t s = 0; s < model.held.supports.size(); ++s)
    if (model.held.supports[s].name == name) found.push_back({ForceGoal::On::support, static_cast<Index>(s)});
  for (std::size_t p = 0; p < model.contact.parts.size(); ++p)
    if (model.contact.parts[p].rank != ContactRank::robot && model.contact.parts[p].name == name)
      found.push_back({ForceGoal::On::part, static_cast<Index>(p)});
  if (found.size() == 1) return found[0];
  if (found.size() > 1)
    throw InvalidInput("'" + name + "' is the name of several among the supports, obstacles and bodies");
  const std::vector<std::string> names = names_of_pressed(model);
  throw InvalidInput("no support, obstacle or body '" + name + "'" +
                     (names.empty() ? "; the scene has none" : suggest_name(name, names)));
}

double usual_mm_per_N(const ForceGoal& goal, double tolerance_mm, std::optional<double> tolerance_N) {
  constexpr double fraction = 1e-3, min_N = 1e-3;
  Vec3 requested = goal.force;
  for (int axis = 0; axis < 3; ++axis)
    if (!goal.axes[axis]) requested[axis] = 0;
  const double size = requested.stableNorm();
  const double tolerance = tolerance_N.value_or(size > 0 ? fraction * size : min_N);
  const double lever = tolerance_mm / tolerance;
  if (!(tolerance > 0) || !(lever > 0) || !std::isfinite(tolerance) || !std::isfinite(lever))
    throw InvalidInput("tolerances of places and forces must be finite and > 0");
  return lever;
}

Vec3 exerted_force(const ForceGoal& goal, const std::vector<Reaction>& reactions,
                   const std::optional<std::vector<PairForces>>& contacts) {
  if (!is_part(goal)) return -reactions.at(goal.index).force;
  Vec3 force = Vec3::Zero();
  if (!contacts) return force;
  for (const PairForces& pair : *contacts) {
    if (pair.a == pair.b) continue;
    if (pair.a == goal.index) force += pair.force;
    if (pair.b == goal.index) force -= pair.force;
  }
  return force;
}

bool inverse::any_on_support(const std::vector<Goal>& goals) {
  return std::any_of(goals.begin(), goals.end(), [](const Goal& goal) {
    const ForceGoal* force = force_of(goal);
    return force != nullptr && !is_part(*force);
  });
}

std::vector<Exertion> inverse::exertions_of(const Statics& statics, const std::vector<Goal>& goals, const State& at) {
  const Model& model = statics.model();
  std::vector<Exertion> found;
  if (!any_force(goals)) return found;
  const ElementDeformation deformation = statics.measured(at);
  if (deformation.reactions.rows() == 0) throw InvalidInput("forces are solved for: a map does not have them");
  const std::vector<Reaction> held = reactions(model, at.positions, deformation);
  std::optional<std::vector<PairForces>> pairs;
  if (deformation.contacts) pairs = deformation.contacts->pairs;
  for (const Goal& goal : goals) {
    Exertion& exertion = found.emplace_back();
    const ForceGoal* force = force_of(goal);
    if (force == nullptr) continue;
    exertion.force = exerted_force(*force, held, pairs);
    if (is_part(*force) && !(pairs && touches(force->index, *pairs)))
      exertion.gap = gap_before(model, force->index, at.positions);
  }
  return found;
}

std::vector<ExertionSlopes> inverse::exertion_slopes(const Statics& statics, const std::vector<Goal>& goals,
                                                     const Pose& at, const StaticsOptions& options, double accuracy,
                                                     Sensitivity& sensitivity) {
  const Model& model = statics.model();
  std::vector<ExertionSlopes> slopes;
  if (at.exertions.empty()) return slopes;
  const State& state = at.equilibrium.state;
  std::vector<Points> held;
  if (any_on_support(goals)) {
    ParameterSensitivity all = statics.sensitivity_along(state, unit_changes(model), options, accuracy, true);
    held = std::move(all.reactions);
    sensitivity = {std::move(all.positions), std::move(all.multipliers), all.regular};
  }
  if (!sensitivity.regular) return slopes;
  const Index m = sensitivity.positions.size();
  std::vector<std::vector<Vec3>> pressed;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    ExertionSlopes& slope = slopes.emplace_back();
    const ForceGoal* force = force_of(goals[i]);
    if (force == nullptr) continue;
    slope.force.setZero(3, m);
    slope.gap.setZero(m);
    if (is_part(*force) && pressed.empty()) pressed = statics.pressing_changes(state, sensitivity.positions);
    for (Index a = 0; a < m; ++a) {
      const std::size_t by = a;
      slope.force.col(a) = is_part(*force) ? pressed[by][force->index] : on_support(model, force->index, held[by]);
      if (at.exertions[i].gap) slope.gap[a] = change_of(*at.exertions[i].gap, model, sensitivity.positions[by]);
    }
  }
  return slopes;
}

}  // namespace softkin
