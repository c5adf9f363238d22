#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/model/layer.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/records.hpp>
#include <softkin/runs/turns.hpp>
#include <utility>

namespace softkin::runs {

namespace {

/// A cable under length control that carries nothing because its path is shorter than the cable.
bool is_slack(const Actuator& actuator, double achieved, double length, double tension) {
  constexpr double rounding = 1e-9;
  return actuator.kind == ActuatorKind::cable && actuator.control == Control::ratio && tension == 0 &&
         achieved < length * (1 - rounding);
}

ActuatorRecord actuator_record(const Model& model, const Equilibrium& found, std::size_t a) {
  const Actuator& actuator = model.actuators[a];
  const auto i = static_cast<Index>(a);
  ActuatorRecord record{found.actuation[i], 0};
  if (has_measure(actuator))
    record.achieved = achieved_ratio(model, actuator, found.state.positions);
  else
    record.achieved =
        found.state.actuation.size() > 0 ? found.state.actuation[i] : std::numeric_limits<double>::quiet_NaN();
  for (const double mm3 : connected_volumes(actuator, found.state.positions)) record.volumes_mL.push_back(mm3 / 1000);
  if (actuator.curve) record.by_curve = input_by_curve(actuator, found.actuation[i], actuator.branch);
  if (model.formulation != Formulation::physical || multiplier_key(actuator).empty()) return record;
  if (found.state.multipliers.size() == 0) return record;  // not known
  record.multiplier = found.state.multipliers[i];
  if (under_voltage(actuator)) record.layer = electric_layer(model, i, found.state.positions, record.multiplier);
  // what holds it holds it exactly, while a map's shape is a little off
  if (found.report.answered() && actuator.control == Control::ratio &&
      (actuator.kind != ActuatorKind::cable || record.multiplier > 0))
    record.achieved = found.actuation[i];
  if (actuator.kind == ActuatorKind::cable)
    record.slack = is_slack(actuator, record.achieved, found.state.actuation[i], record.multiplier);
  return record;
}

/// Share of the way from the step before to what was asked for.
std::optional<double> reached_share(const Model& model, const SolveReport& report) {
  if (report.status == Status::converged) return 1;
  if (model.formulation != Formulation::physical || !std::isfinite(report.reached)) return std::nullopt;
  return report.reached;
}

}  // namespace

std::vector<ActuatorRecord> actuator_records(const Model& model, const Equilibrium& found) {
  std::vector<ActuatorRecord> records;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) records.push_back(actuator_record(model, found, a));
  return records;
}

StepRecord step_record(const Model& model, const Equilibrium& found, const ElementDeformation& deformation) {
  StepRecord record;
  static_cast<SolveReport&>(record) = found.report;
  record.actuation = found.actuation;
  record.reached_share = reached_share(model, found.report);
  if (found.state.knows(found.actuation.size())) {
    record.shape_actuation = found.state.actuation;
    record.shape_load_share = found.state.share;
  }
  record.anchors = found.state.anchors;
  record.eyelets = found.state.eyelets;
  record.inverted_elements = static_cast<std::size_t>(
      std::count_if(deformation.volume_ratio.begin(), deformation.volume_ratio.end(), [](double j) { return j <= 0; }));
  record.largest_displacement_mm = largest_move(model.rest, found.state.positions);
  for (const Marker& marker : model.markers) record.markers.push_back(marker.at(found.state.positions));
  record.marker_turns = marker_turns(model, found.state.positions);
  record.actuators = actuator_records(model, found);
  for (std::size_t a = 0; a < deformation.tendons.size(); ++a) record.actuators[a].tendon = deformation.tendons[a];
  record.strain = strain_histogram(model, deformation);
  if (model.formulation == Formulation::physical && record.status == Status::limit && !record.answered())
    record.worst = worst_place(model, found.state.positions, deformation);
  record.stress = stress_extremes(model, found.state.positions, deformation);
  record.reactions = reactions(model, found.state.positions, deformation);
  if (deformation.contacts) record.contacts = deformation.contacts->pairs;
  record.magnetic = deformation.magnetic;
  record.fibres = deformation.fibres;
  record.layers = deformation.layers;
  return record;
}

WaypointRecord waypoint_record(const Model& model, const Waypoint& asked, const InverseResult& found,
                               const ElementDeformation& deformation) {
  WaypointRecord record;
  static_cast<StepRecord&>(record) = step_record(model, found.equilibrium, deformation);
  record.seconds = found.seconds;
  record.time_s = asked.time;
  record.asked = asked;
  record.end = found.status;
  record.error_mm = found.errors_mm.maxCoeff();
  record.equilibria = found.equilibria;
  record.search_remark = found.remark;
  return record;
}

void note_jump(const Model& model, const MarkerPath& path, const WaypointRecord& before, WaypointRecord& record) {
  record.command_change = record.step_mm = 0;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const double change = std::abs(record.actuation[static_cast<Index>(a)] - before.actuation[static_cast<Index>(a)]);
    if (varies(actuator))
      record.command_change = std::max(record.command_change, change / (actuator.high - actuator.low));
  }
  for (const Index marker : path.markers) {
    const auto m = static_cast<std::size_t>(marker);
    record.step_mm = std::max(record.step_mm, (record.markers[m] - before.markers[m]).norm());
  }
}

WalkRecord walk_record(const Model& model, std::size_t cycle, const WalkStep& found,
                       const ElementDeformation& deformation) {
  WalkRecord record;
  static_cast<StepRecord&>(record) = step_record(model, found.equilibrium, deformation);
  record.cycle = cycle;
  record.walk = found;
  record.walk.equilibrium = {};
  return record;
}

double normal_force_on(const Model& model, const std::string& part, const std::vector<PairForces>& pairs) {
  double sum = 0;
  for (const PairForces& pair : pairs)
    for (const Index side : {pair.a, pair.b})
      if (model.contact.parts[static_cast<std::size_t>(side)].name == part) sum += pair.normal_N;
  return sum;
}

State state_of(const Model& model, const StepRecord& record, Points positions) {
  State state{std::move(positions), record.shape_actuation.value_or(Actuation()),
              Eigen::VectorXd::Zero(static_cast<Index>(model.actuators.size()))};
  if (model.formulation != Formulation::physical) return state;
  state.share = record.shape_actuation ? record.shape_load_share : -1;
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    state.multipliers[static_cast<Index>(a)] = record.actuators[a].multiplier;
  state.anchors = record.anchors;
  state.eyelets = record.eyelets;
  return state;
}

namespace {

// What is found implausible of a shape. None of them is wrong for certain: they are warnings.
constexpr double unmoved = 1e-6;    // of the diagonal: 0.1 um of a finger, below what any sensor of a robot tells
constexpr double far_strained = 5;  // [-]: most silicones break below it, and few robots come near
constexpr double far_moved = 3;     // of the diagonal: what is held somewhere swings by twice its size at most

/// Does the record ask for anything but the rest shape?
bool asks_for_motion(const Model& model, const StepRecord& record) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const double from_rest = record.actuation[static_cast<Index>(a)] - actuator.rest;
    const bool may_hang = actuator.kind == ActuatorKind::cable && actuator.control == Control::ratio && from_rest > 0;
    if (from_rest != 0 && !may_hang) return true;
  }
  const auto turns = [](const SupportTurn& turn) { return turn.degrees != 0; };
  return model.loaded() || model.held != model.rest || std::any_of(model.turns.begin(), model.turns.end(), turns);
}

void add_implausible(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  if (const SelfOverlap& o = record.self_overlap; o.points > 0)
    found.push_back({Finding::Kind::self_overlap,
                     "",
                     {static_cast<double>(o.points), o.deepest_mm, o.where.x(), o.where.y(), o.where.z()}});
  const double moved = record.largest_displacement_mm;
  if (record.status == Status::converged && moved < unmoved * model.diagonal_mm && asks_for_motion(model, record))
    found.push_back({Finding::Kind::motionless, "", {moved}});
  if (!record.strain.shares.empty() && record.strain.greatest > far_strained)
    found.push_back({Finding::Kind::far_strained, "", {record.strain.greatest}});
  if (moved > far_moved * model.diagonal_mm)
    found.push_back({Finding::Kind::far_moved, "", {moved, model.diagonal_mm}});
}

using Kind = Finding::Kind;

/// least: of what is more than rounding
void add_vector(const Vec3& vector, double least, Finding& finding) {
  for (const double value : vector) finding.values.push_back(vector.norm() > least ? value : 0);
}

void add_contacts(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  if (!record.contacts) return;
  bool any = false;
  for (const PairForces& pair : *record.contacts) {
    const double rounding = 1e-9 * record.pull_N;
    if (!(pair.normal_N > rounding)) continue;
    any = true;
    Finding& contact = found.emplace_back(Finding{Kind::contact, model.contact.label(pair.b)});
    if (pair.a != pair.b) contact.other = model.contact.label(pair.a);
    add_vector(pair.force, rounding, contact);
    add_vector(pair.moment, rounding * model.diagonal_mm, contact);
    add_vector(pair.center, 0, contact);
    for (const double value : {pair.normal_N, pair.pressure_kPa, pair.area_mm2, pair.gap_mm})
      contact.values.push_back(value);
    if (pair.slipping) contact.values.push_back(*pair.slipping);
  }
  if (!any) found.push_back({Kind::untouched});
}

void add_magnetic(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  if (!record.magnetic) return;
  const double rounding = 1e-9 * record.pull_N;
  Finding& magnetic = found.emplace_back(Finding{Kind::magnetic});
  add_vector(record.magnetic->force, rounding, magnetic);
  add_vector(record.magnetic->moment, rounding * model.diagonal_mm, magnetic);
  add_vector(record.magnetic->center, 0, magnetic);
}

/// A choice of them, evenly by their places, with the largest load.
void add_branch(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  constexpr std::size_t most = 12;
  const auto& points = record.branch.points;
  if (points.size() < 2) return;
  Finding& branch =
      found.emplace_back(Finding{Kind::branch, model.actuators[static_cast<std::size_t>(record.branch.actuator)].name});
  const auto top = std::max_element(points.begin(), points.end(),
                                    [](const auto& a, const auto& b) { return std::abs(a.load) < std::abs(b.load); });
  const std::size_t stride = 1 + (points.size() - 1) / most, last = points.size() - 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % stride != 0 && i != last && points.begin() + static_cast<std::ptrdiff_t>(i) != top) continue;
    branch.values.push_back(points[i].measure);
    branch.values.push_back(points[i].load);
  }
}

void add_forces(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  if (record.stress) {
    const auto& [most, greatest, least] = *record.stress;
    found.push_back(
        {Kind::stress, most.region, {most.value, most.at.x(), most.at.y(), most.at.z(), greatest.value, least.value}});
  }
  for (std::size_t s = 0; s < record.reactions.size(); ++s) {
    Finding& reaction = found.emplace_back(Finding{Kind::reaction, model.supports[s].name});
    const auto& [force, moment, center] = record.reactions[s];
    const double rounding = 1e-9 * record.pull_N;
    add_vector(force, rounding, reaction);
    add_vector(moment, rounding * model.diagonal_mm, reaction);
    add_vector(center, 0, reaction);
  }
  add_magnetic(model, record, found);
  add_contacts(model, record, found);
  if (record.buckled > 0)
    found.push_back({Kind::buckled, "", {static_cast<double>(record.buckled), record.buckled_mm}});
  if (record.snapped_mm > 0) found.push_back({Kind::snapped, "", {record.snapped_mm, record.snapped_from}});
  if (record.unstable_modes > 0)
    found.push_back({Kind::unstable, "", {static_cast<double>(record.unstable_modes)}});
  else if (record.unstable_from > 0)
    found.push_back({Kind::unstable_way, "", {record.unstable_from}});
  add_branch(model, record, found);
}

/// How far the body is strained.
void add_strain(const StepRecord& record, std::vector<Finding>& found) {
  const StrainHistogram& strain = record.strain;
  if (!strain.shares.empty())
    found.push_back({Kind::strain, "", {strain.least, strain.greatest, strain.percentile_95}});
  constexpr double least_shown = 0.0005;  // what is shown as 0.0 % is nothing to tell
  for (const auto& beyond : strain.beyond)
    if (beyond.share >= least_shown)
      found.push_back({Kind::beyond_linear_range, beyond.region, {beyond.share, beyond.linear_range}});
}

void add_actuators(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const ActuatorRecord& actuator = record.actuators[a]; actuator.slack)
      found.push_back({Kind::slack, model.actuators[a].name, {actuator.achieved, actuator.requested}});
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const auto& layer = record.actuators[a].layer; layer && layer->charge_nC > 0)
      found.push_back({Kind::charged,
                       model.actuators[a].name,
                       {layer->charge_nC, layer->capacitance_pF, layer->field_kV_mm, layer->thickness_mm, layer->at.x(),
                        layer->at.y(), layer->at.z()}});
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const ActuatorRecord& actuator = record.actuators[a]; actuator.tendon && actuator.multiplier != 0)
      found.push_back({Kind::rubbing,
                       model.actuators[a].name,
                       {actuator.multiplier, actuator.tendon->end_N, actuator.tendon->sticks}});
}

void add_reinforcements(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  for (std::size_t f = 0; f < record.fibres.size(); ++f) {
    const FibreForces& fibre = record.fibres[f];
    found.push_back({Kind::fibre,
                     model.fibres[f].name,
                     {fibre.mean_N, fibre.largest_N, fibre.least_N, fibre.where.x(), fibre.where.y(), fibre.where.z(),
                      fibre.stretch, fibre.slack}});
  }
  for (std::size_t l = 0; l < record.layers.size(); ++l) {
    const LayerForces& layer = record.layers[l];
    found.push_back({Kind::layer,
                     model.layers[l]->name,
                     {layer.largest_N_mm, layer.least_N_mm, layer.where.x(), layer.where.y(), layer.where.z(),
                      layer.strain, layer.wrinkled, layer.slack}});
  }
}

/// How near the iteration came to the equilibrium.
void add_accuracy(const Model& model, const StepRecord& record, std::vector<Finding>& found) {
  if (model.formulation == Formulation::physical && record.status != Status::converged)
    return;  // the iteration was of another shape
  if (record.answered()) return;
  if (!std::isfinite(record.step_mm) || !std::isfinite(record.estimated_error_mm))
    found.push_back({Kind::diverged});
  else
    found.push_back({Kind::accuracy, "", {record.step_mm, record.estimated_error_mm}});
  if (model.formulation == Formulation::physical)
    for (const double force : {record.residual_N, record.pull_N}) found.back().values.push_back(force);
}

}  // namespace

std::vector<Finding> findings(const Model& model, const StepRecord& record) {
  std::vector<Finding> found;
  add_strain(record, found);
  if (record.inverted_elements > 0)
    found.push_back({Kind::inverted, "", {static_cast<double>(record.inverted_elements)}});
  add_actuators(model, record, found);
  add_reinforcements(model, record, found);
  add_forces(model, record, found);
  add_implausible(model, record, found);
  add_accuracy(model, record, found);
  return found;
}

std::vector<Shortfall> shortfalls(const Model& model, const StepRecord& record) {
  std::vector<Shortfall> short_of;
  if (!record.shape_actuation) return short_of;
  for (Index a = 0; a < static_cast<Index>(model.actuators.size()); ++a) {
    const double told = record.actuation[a], acts = (*record.shape_actuation)[a];
    if (!(acts >= told && acts <= told + model.actuators[static_cast<std::size_t>(a)].backlash))
      short_of.push_back({a, acts, told});
  }
  return short_of;
}

}  // namespace softkin::runs
