#include <algorithm>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/map_robot.hpp>
#include <softkin/kinematics/maps/output_correction.hpp>
#include <softkin/model/names.hpp>
#include <utility>

namespace softkin {

namespace {

/// The load of each actuator among a map's outputs, or -1.
std::vector<Index> loads_of(const Model& model, const MapData& data) {
  std::vector<Index> loads;
  for (const Actuator& actuator : model.actuators) {
    loads.push_back(-1);
    for (const char* load : {"_pressure", "_tension"})
      for (std::size_t q = 0; q < data.outputs.size(); ++q)
        if (data.outputs[q].name == actuator.name + load) loads.back() = q;
  }
  return loads;
}

/// Is the commanded quantity a tension or a pressure?
bool is_load(const Actuator& actuator) {
  return actuator.control == Control::load && !multiplier_key(actuator).empty();
}

/// Equilibria by a map; derived classes define their positions.
class OfMap : public GivenEquilibria {
 public:
  OfMap(const Model& model, const KinematicMap& map) : model_(model), map_(map), loads_(loads_of(model, map.data())) {}

  [[nodiscard]] Equilibrium at(const Actuation& actuation, const State& start) const override {
    Equilibrium found;
    found.actuation = actuation;
    found.report.solver = "map";
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    SolveReport& report = found.report;
    for (double* of_iteration :
         {&report.tolerance_mm, &report.step_mm, &report.estimated_error_mm, &report.gradient_norm, &report.energy,
          &report.physical.residual_N, &report.physical.pull_N})
      *of_iteration = unknown;
    Eigen::VectorXd values(map_.outputs());
    const Eigen::VectorXd commands = map_.commands(actuation);
    const auto place = map_.evaluate(commands.data(), values.data());
    if (!place) {
      found.report.status = Status::limit;
      found.report.reached = unknown;
      found.report.remark = "the actuation is outside the map";
      found.state = start;
      return found;
    }
    found.report.status = Status::converged;
    found.state.actuation = actuation;
    found.state.positions = positions(values, commands, *place);
    found.state.multipliers = loads(actuation, values);
    return found;
  }

  [[nodiscard]] Sensitivity sensitivity(const State& at) const override {
    const MapData& data = map_.data();
    std::vector<bool> taut(data.cables.size());
    for (std::size_t c = 0; c < taut.size(); ++c) taut[c] = is_taut(data.cables[c], at);
    Eigen::VectorXd values(map_.outputs());
    maps::RowMatrix slopes(map_.inputs(), map_.outputs());
    const Eigen::VectorXd commands = map_.commands(at.actuation);
    Sensitivity found = no_sensitivity(model_.rest.rows(), at.actuation.size());
    auto place = map_.evaluate_taut(taut, commands.data(), values.data(), slopes.data());
    if (!place) place = map_.evaluate(commands.data(), values.data(), slopes.data());
    if (!place) return found;
    found.regular = true;
    add_moves(slopes, commands, *place, found);
    for (Index i = 0; i < map_.inputs(); ++i) {
      const Index a = data.inputs[i].actuator;
      for (std::size_t k = 0; k < loads_.size(); ++k)
        if (loads_[k] >= 0) found.multipliers(k, a) = slopes(i, loads_[k]);
      if (is_load(model_.actuators[a])) found.multipliers(a, a) = 1;
    }
    return found;
  }

 protected:
  [[nodiscard]] virtual Points positions(const Eigen::VectorXd& values, const Eigen::VectorXd& commands,
                                         const KinematicMap::Place& place) const = 0;
  /// By every input, into found.positions.
  virtual void add_moves(const maps::RowMatrix& slopes, const Eigen::VectorXd& commands,
                         const KinematicMap::Place& place, Sensitivity& found) const = 0;

  const Model& model_;
  const KinematicMap& map_;

 private:
  /// As Statics has it: one that pulls, or is as long as it may be.
  [[nodiscard]] bool is_taut(const MapCable& cable, const State& at) const {
    constexpr double verge = 1e-9;
    if (at.multipliers[cable.actuator] > 0) return true;
    const Actuator& actuator = model_.actuators[cable.actuator];
    return achieved_ratio(model_, actuator, at.positions) >= (1 - verge) * at.actuation[cable.actuator];
  }

  [[nodiscard]] Eigen::VectorXd loads(const Actuation& actuation, const Eigen::VectorXd& values) const {
    Eigen::VectorXd loads = Eigen::VectorXd::Zero(actuation.size());
    for (std::size_t a = 0; a < loads_.size(); ++a) {
      const Index at = a;
      if (loads_[a] >= 0)
        loads[at] = values[loads_[a]];
      else if (is_load(model_.actuators[a]))
        loads[at] = actuation[at];
    }
    // a slack cable's polynomials are 0 up to rounding
    for (const MapCable& cable : map_.data().cables) loads[cable.actuator] = std::max(0.0, loads[cable.actuator]);
    return loads;
  }

  std::vector<Index> loads_;
};

/// No elements, and nothing that is held.
Model markers_alone(const Model& model, const MapData& data) {
  Model seen;
  seen.name = model.name;
  seen.formulation = model.formulation;
  seen.actuators = model.actuators;
  seen.markers = model.markers;
  seen.diagonal_mm = model.diagonal_mm;
  const Index markers = model.markers.size(), cables = data.cables.size();
  seen.rest = Points::Zero(markers + 2 * cables, 3);
  for (Index p = 0; p < markers; ++p) {
    Marker& marker = seen.markers[p];
    seen.rest.row(p) = marker.at(model.rest);
    marker = {marker.name, {{p}, {1.0}}};
  }
  for (Index c = 0; c < cables; ++c) {
    Actuator& cable = seen.actuators[data.cables[c].actuator];
    const Index begin = markers + 2 * c;
    seen.rest(begin + 1, 0) = cable.rest_measure;
    auto& path = std::get<CableDrive>(cable.drive);
    path.points = {{{begin}, {1.0}}, {{begin + 1}, {1.0}}};
    path.gaps.clear();
  }
  seen.held.at = seen.rest;
  seen.loads.dead = Points::Zero(seen.rest.rows(), 3);
  seen.held.fixed.assign(seen.rest.rows(), {false, false, false});
  seen.elements.used.assign(seen.rest.rows(), true);
  seen.held.support_of.assign(seen.rest.rows(), {-1, -1, -1});
  return seen;
}

class MarkersOfMap : public OfMap {
 public:
  using OfMap::OfMap;

 private:
  [[nodiscard]] Points positions(const Eigen::VectorXd& values, const Eigen::VectorXd&,
                                 const KinematicMap::Place&) const override {
    Points positions = Points::Zero(model_.rest.rows(), 3);
    const Index markers = model_.markers.size();
    for (Index p = 0; p < markers; ++p) positions.row(p) = values.segment<3>(3 * p).transpose();
    Index end = markers + 1;
    for (const MapCable& cable : map_.data().cables) {
      positions(end, 0) = values[cable.ratio] * model_.actuators[cable.actuator].rest_measure;
      end += 2;
    }
    return positions;
  }

  void add_moves(const maps::RowMatrix& slopes, const Eigen::VectorXd& commands, const KinematicMap::Place& place,
                 Sensitivity& found) const override {
    for (Index i = 0; i < map_.inputs(); ++i)
      found.positions[map_.data().inputs[i].actuator] = positions(slopes.row(i), commands, place);
  }
};

class ShapesOfMap : public OfMap {
 public:
  ShapesOfMap(const Model& model, const KinematicMap& map) : OfMap(model, map), correction_(model, map.data()) {
    if (!map.data().shape) throw InvalidInput("the map was made without the robot's shape, which is requested");
    if (map.data().shape->mean.size() != model.rest.size()) throw InvalidInput("the map is of another mesh");
  }

 private:
  [[nodiscard]] Points positions(const Eigen::VectorXd& values, const Eigen::VectorXd& commands,
                                 const KinematicMap::Place& place) const override {
    Points positions = map_.shape(commands.data(), place);
    correction_.move_to(values, positions);
    return positions;
  }

  void add_moves(const maps::RowMatrix& slopes, const Eigen::VectorXd& commands, const KinematicMap::Place& place,
                 Sensitivity& found) const override {
    std::vector<Points> moves = map_.shape_slopes(commands.data(), place);
    const Points shape = map_.shape(commands.data(), place);
    correction_.move_at(slopes, shape, moves);
    for (Index i = 0; i < map_.inputs(); ++i) found.positions[map_.data().inputs[i].actuator] = std::move(moves[i]);
  }

  maps::OutputCorrection correction_;
};

}  // namespace

MapRobot::MapRobot(const Model& model, const KinematicMap& map)
    : model_(markers_alone(model, map.data())), statics_(model_, std::make_unique<MarkersOfMap>(model_, map)) {}

Statics statics_by(const Model& model, const KinematicMap* map, bool polish) {
  if (!map) return Statics(model);
  return {model, std::make_unique<ShapesOfMap>(model, *map), polish ? Given::starts : Given::answers};
}

InverseResult solve_inverse_by_map(const Model& model, const KinematicMap& map, const Statics& statics,
                                   const std::vector<Goal>& goals, const Actuation& start,
                                   const InverseOptions& options, const ProgressCallback& progress) {
  InverseOptions search = options;
  if (search.preferred.size() == 0) search.preferred = start;
  const MapRobot robot(model, map);
  const InverseResult near = solve_inverse_from(robot.statics(), goals, start, search, progress);
  if (near.errors_mm.size() == 0) return solve_inverse_from(statics, goals, start, search, progress);
  search.other_starts = 0;  // the map has been tried from them
  InverseResult found = solve_inverse_from(statics, goals, near.equilibrium.actuation, search, progress);
  found.seconds += near.seconds;
  return found;
}

}  // namespace softkin
