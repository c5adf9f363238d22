#include <algorithm>
#include <cmath>
#include <limits>
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
  return actuator.is<CableDrive>() && actuator.control == Control::ratio && tension == 0 &&
         achieved < length * (1 - rounding);
}

ActuatorRecord actuator_record(const Model& model, const Equilibrium& found, std::size_t a) {
  const Actuator& actuator = model.actuators[a];
  const Index i = a;
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
  // a constraint is satisfied exactly, while the shape of a map is slightly off
  if (found.report.answered() && actuator.control == Control::ratio &&
      (!actuator.is<CableDrive>() || record.multiplier > 0))
    record.achieved = found.actuation[i];
  if (actuator.is<CableDrive>())
    record.slack = is_slack(actuator, record.achieved, found.state.actuation[i], record.multiplier);
  return record;
}

/// Returns the fraction of the path from the step before to the request that was completed.
std::optional<double> reached_fraction(const Model& model, const SolveReport& report) {
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
  record.reached_fraction = reached_fraction(model, found.report);
  if (found.state.knows(found.actuation.size())) {
    record.shape_actuation = found.state.actuation;
    record.shape_load_fraction = found.state.load_factor;
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
  record.forces.stress = stress_extremes(model, found.state.positions, deformation);
  record.forces.reactions = reactions(model, found.state.positions, deformation);
  if (deformation.contacts) record.forces.contacts = deformation.contacts->pairs;
  record.forces.magnetic = deformation.magnetic;
  record.forces.fibres = deformation.fibres;
  record.forces.layers = deformation.layers;
  return record;
}

WaypointRecord waypoint_record(const Model& model, const Waypoint& requested, const InverseResult& found,
                               const ElementDeformation& deformation) {
  WaypointRecord record;
  static_cast<StepRecord&>(record) = step_record(model, found.equilibrium, deformation);
  record.seconds = found.seconds;
  record.time_s = requested.time;
  record.requested = requested;
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
    const double change = std::abs(record.actuation[a] - before.actuation[a]);
    if (varies(actuator))
      record.command_change = std::max(record.command_change, change / (actuator.high - actuator.low));
  }
  for (const Index marker : path.markers) {
    const std::size_t m = marker;
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
      if (model.contact.parts[side].name == part) sum += pair.normal_N;
  return sum;
}

State state_of(const Model& model, const StepRecord& record, Points positions) {
  State state{std::move(positions), record.shape_actuation.value_or(Actuation()),
              Eigen::VectorXd::Zero(model.actuators.size())};
  if (model.formulation != Formulation::physical) return state;
  state.load_factor = record.shape_actuation ? record.shape_load_fraction : -1;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) state.multipliers[a] = record.actuators[a].multiplier;
  state.anchors = record.anchors;
  state.eyelets = record.eyelets;
  return state;
}

std::vector<Shortfall> shortfalls(const Model& model, const StepRecord& record) {
  std::vector<Shortfall> short_of;
  if (!record.shape_actuation) return short_of;
  for (Index a = 0; a < std::ssize(model.actuators); ++a) {
    const double reported = record.actuation[a], acts = (*record.shape_actuation)[a];
    if (!(acts >= reported && acts <= reported + model.actuators[a].backlash)) short_of.push_back({a, acts, reported});
  }
  return short_of;
}

}  // namespace softkin::runs
