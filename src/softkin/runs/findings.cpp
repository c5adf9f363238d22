#include <algorithm>
#include <cmath>
#include <softkin/model/layer.hpp>
#include <softkin/runs/findings.hpp>

namespace softkin::runs {

namespace {

// What is found implausible of a shape. None of them is wrong for certain: they are warnings.
constexpr double unmoved = 1e-6;    // of the diagonal: 0.1 um of a finger, below the resolution of a robot's sensors
constexpr double far_strained = 5;  // [-]: most silicones break below it, and few robots come near
constexpr double far_moved = 3;     // of the diagonal: a body that is held swings by twice its size at most

/// Does the record ask for anything but the rest shape?
bool asks_for_motion(const Model& model, const StepRecord& record) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const double from_rest = record.actuation[a] - actuator.rest;
    const bool may_hang = actuator.is<CableDrive>() && actuator.control == Control::ratio && from_rest > 0;
    if (from_rest != 0 && !may_hang) return true;
  }
  const auto turns = [](const SupportTurn& turn) { return turn.degrees != 0; };
  return model.loads.any() || model.held.at != model.rest ||
         std::any_of(model.held.turns.begin(), model.held.turns.end(), turns);
}

void add_implausible(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  if (record.self_overlap.points > 0) found.emplace_back(record.self_overlap);
  const double moved = record.largest_displacement_mm;
  if (record.status == Status::converged && moved < unmoved * model.diagonal_mm && asks_for_motion(model, record))
    found.emplace_back(finding::Motionless{moved});
  if (!record.strain.fractions.empty() && record.strain.greatest > far_strained)
    found.emplace_back(finding::FarStrained{record.strain.greatest});
  if (moved > far_moved * model.diagonal_mm) found.emplace_back(finding::FarMoved{moved, model.diagonal_mm});
}

/// Of a force, its moment and their centre without what is but rounding.
template <class Forces>
Forces without_rounding(Forces forces, const Model& model, const StepRecord& record) {
  const double rounding = 1e-9 * record.physical.pull_N;
  if (!(forces.force.norm() > rounding)) forces.force.setZero();
  if (!(forces.moment.norm() > rounding * model.diagonal_mm)) forces.moment.setZero();
  if (!(forces.center.norm() > 0)) forces.center.setZero();
  return forces;
}

void add_contacts(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  if (!record.forces.contacts) return;
  bool any = false;
  for (const PairForces& pair : *record.forces.contacts) {
    if (!(pair.normal_N > 1e-9 * record.physical.pull_N)) continue;
    any = true;
    found.emplace_back(finding::Contact{model.contact.label(pair.b),
                                        pair.a == pair.b ? std::string() : model.contact.label(pair.a),
                                        without_rounding(pair, model, record)});
  }
  if (!any) found.emplace_back(finding::Untouched{});
}

/// A choice of the points, evenly by their places.
void add_branch(const StepRecord& record, std::vector<Finding>& found) {
  constexpr std::size_t most = 12;
  const auto& points = record.physical.branch.points;
  if (points.size() < 2) return;
  LoadBranch chosen{record.physical.branch.actuator};
  const auto top = std::max_element(points.begin(), points.end(),
                                    [](const auto& a, const auto& b) { return std::abs(a.load) < std::abs(b.load); });
  const std::size_t stride = 1 + (points.size() - 1) / most, last = points.size() - 1;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (i % stride == 0 || i == last || points.begin() + static_cast<std::ptrdiff_t>(i) == top)
      chosen.points.push_back(points[i]);
  found.emplace_back(std::move(chosen));
}

/// Without what is but rounding, of the forces of chambers, too.
Reaction rounded(Reaction reaction, const Model& model, const StepRecord& record) {
  const double rounding = 1e-9 * record.physical.pull_N;
  for (ChamberForce& chamber : reaction.chambers)
    for (double& component : chamber.force)
      if (!(std::abs(component) > rounding)) component = 0;
  return without_rounding(std::move(reaction), model, record);
}

void add_forces(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  if (record.forces.stress) found.emplace_back(*record.forces.stress);
  for (std::size_t s = 0; s < record.forces.reactions.size(); ++s)
    found.emplace_back(
        finding::Support{model.held.supports[s].name, rounded(record.forces.reactions[s], model, record)});
  if (record.forces.magnetic) found.emplace_back(without_rounding(*record.forces.magnetic, model, record));
  add_contacts(model, record, found);
  if (record.physical.buckled > 0)
    found.emplace_back(finding::Buckled{record.physical.buckled, record.physical.buckled_mm});
  if (record.physical.snapped_mm > 0)
    found.emplace_back(finding::Snapped{record.physical.snapped_mm, record.physical.snapped_from});
  if (record.physical.unstable_modes > 0)
    found.emplace_back(finding::Unstable{record.physical.unstable_modes});
  else if (record.physical.unstable_from > 0)
    found.emplace_back(finding::UnstablePath{record.physical.unstable_from});
  add_branch(record, found);
}

/// How far the body is strained.
void add_strain(const StepRecord& record, std::vector<Finding>& found) {
  const StrainHistogram& strain = record.strain;
  if (!strain.fractions.empty())
    found.emplace_back(finding::Strain{strain.least, strain.greatest, strain.percentile_95});
  constexpr double min_shown = 0.0005;  // values that would be shown as 0.0 % are left out
  for (const auto& beyond : strain.beyond)
    if (beyond.fraction >= min_shown) found.emplace_back(beyond);
}

void add_actuators(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const ActuatorRecord& actuator = record.actuators[a]; actuator.slack)
      found.emplace_back(finding::Slack{model.actuators[a].name, actuator.achieved, actuator.requested});
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const auto& layer = record.actuators[a].layer; layer && layer->charge_nC > 0)
      found.emplace_back(finding::Charged{model.actuators[a].name, *layer});
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const ActuatorRecord& actuator = record.actuators[a]; actuator.tendon && actuator.multiplier != 0)
      found.emplace_back(finding::CableFriction{model.actuators[a].name, actuator.multiplier, *actuator.tendon});
}

void add_reinforcements(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  for (std::size_t f = 0; f < record.forces.fibres.size(); ++f)
    found.emplace_back(finding::Fibre{model.reinforcement.fibres[f].name, record.forces.fibres[f]});
  for (std::size_t l = 0; l < record.forces.layers.size(); ++l)
    found.emplace_back(finding::Layer{model.reinforcement.layers[l]->name, record.forces.layers[l]});
}

/// How near the iteration came to the equilibrium.
void add_accuracy(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  const bool physical = model.formulation == Formulation::physical;
  if (physical && record.status != Status::converged) return;  // the iteration was of another shape
  if (record.answered()) return;
  if (std::isfinite(record.step_mm) && std::isfinite(record.estimated_error_mm))
    found.emplace_back(finding::Accuracy{record.step_mm, record.estimated_error_mm, physical,
                                         record.physical.residual_N, record.physical.pull_N});
  else
    found.emplace_back(finding::Diverged{});
}

}  // namespace

std::vector<Finding> findings(const Model& model, const StepRecord& record) {
  std::vector<Finding> found;
  add_strain(record, found);
  if (record.inverted_elements > 0) found.emplace_back(finding::Inverted{record.inverted_elements});
  add_actuators(model, record, found);
  add_reinforcements(model, record, found);
  add_forces(model, record, found);
  add_implausible(model, record, found);
  add_accuracy(model, record, found);
  return found;
}

}  // namespace softkin::runs
