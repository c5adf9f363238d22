#include <algorithm>
#include <softkin/kinematics/map_robot.hpp>
#include <utility>

namespace softkin {

namespace {

MapRobot::Places places_of(const Model& model, const MapData& data) {
  MapRobot::Places places{static_cast<Index>(model.markers.size()), {}};
  for (const Actuator& actuator : model.actuators) {
    places.loads.push_back(-1);
    for (const char* load : {"_pressure", "_tension"})
      for (std::size_t q = 0; q < data.outputs.size(); ++q)
        if (data.outputs[q].name == actuator.name + load) places.loads.back() = static_cast<Index>(q);
  }
  return places;
}

/// No elements, and nothing that is held.
Model seen_by(const Model& model, const MapData& data) {
  Model seen;
  seen.name = model.name;
  seen.formulation = model.formulation;
  seen.actuators = model.actuators;
  seen.markers = model.markers;
  seen.diagonal_mm = model.diagonal_mm;
  const auto markers = static_cast<Index>(model.markers.size()), cables = static_cast<Index>(data.cables.size());
  seen.rest = Points::Zero(markers + 2 * cables, 3);
  for (Index p = 0; p < markers; ++p) {
    EmbeddedPoint& point = seen.markers[static_cast<std::size_t>(p)].point;
    seen.rest.row(p) = point.at(model.rest);
    point = {{p}, {1.0}};
  }
  for (Index c = 0; c < cables; ++c) {
    Actuator& cable = seen.actuators[static_cast<std::size_t>(data.cables[static_cast<std::size_t>(c)].actuator)];
    const Index begin = markers + 2 * c;
    seen.rest(begin + 1, 0) = cable.rest_measure;
    cable.points = {{{begin}, {1.0}}, {{begin + 1}, {1.0}}};
    cable.gaps.clear();
  }
  seen.held = seen.rest;
  seen.dead_load = Points::Zero(seen.rest.rows(), 3);
  seen.fixed.assign(static_cast<std::size_t>(seen.rest.rows()), {false, false, false});
  seen.used.assign(static_cast<std::size_t>(seen.rest.rows()), true);
  seen.support_of.assign(static_cast<std::size_t>(seen.rest.rows()), {-1, -1, -1});
  return seen;
}

class OfMap : public GivenEquilibria {
 public:
  OfMap(const Model& model, const KinematicMap& map, const MapRobot::Places& places)
      : model_(model), map_(map), places_(places) {}

  [[nodiscard]] Equilibrium at(const Actuation& actuation, const State& start) const override {
    Equilibrium found;
    found.actuation = actuation;
    found.report.solver = "map";
    Eigen::VectorXd values(map_.outputs());
    const Eigen::VectorXd commands = map_.commands(actuation);
    if (!map_.evaluate(commands.data(), values.data())) {
      found.report.status = Status::limit;
      found.report.reached = 0;
      found.report.remark = "the actuation is outside the map";
      found.state = start;
      return found;
    }
    found.report.status = Status::converged;
    found.state.actuation = actuation;
    found.state.positions = positions(values);
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
    Sensitivity found = no_sensitivity(static_cast<Index>(model_.rest.rows()), static_cast<Index>(at.actuation.size()));
    if (!map_.evaluate_taut(taut, commands.data(), values.data(), slopes.data()) &&
        !map_.evaluate(commands.data(), values.data(), slopes.data()))
      return found;
    found.regular = true;
    for (Index i = 0; i < map_.inputs(); ++i) {
      const Index a = data.inputs[static_cast<std::size_t>(i)].actuator;
      found.positions[static_cast<std::size_t>(a)] = positions(slopes.row(i));
      for (std::size_t k = 0; k < places_.loads.size(); ++k)
        if (places_.loads[k] >= 0) found.multipliers(static_cast<Index>(k), a) = slopes(i, places_.loads[k]);
      if (model_.actuators[static_cast<std::size_t>(a)].control == Control::load) found.multipliers(a, a) = 1;
    }
    return found;
  }

 private:
  /// As Statics has it: one that pulls, or is as long as it may be.
  [[nodiscard]] bool is_taut(const MapCable& cable, const State& at) const {
    constexpr double verge = 1e-9;
    if (at.multipliers[cable.actuator] > 0) return true;
    const Actuator& actuator = model_.actuators[static_cast<std::size_t>(cable.actuator)];
    return achieved_ratio(model_, actuator, at.positions) >= (1 - verge) * at.actuation[cable.actuator];
  }

  /// Of values, or of their slopes.
  [[nodiscard]] Points positions(const Eigen::VectorXd& values) const {
    Points positions = Points::Zero(model_.rest.rows(), 3);
    for (Index p = 0; p < places_.markers; ++p) positions.row(p) = values.segment<3>(3 * p).transpose();
    Index end = places_.markers + 1;
    for (const MapCable& cable : map_.data().cables) {
      positions(end, 0) = values[cable.ratio] * model_.actuators[static_cast<std::size_t>(cable.actuator)].rest_measure;
      end += 2;
    }
    return positions;
  }

  [[nodiscard]] Eigen::VectorXd loads(const Actuation& actuation, const Eigen::VectorXd& values) const {
    Eigen::VectorXd loads = Eigen::VectorXd::Zero(actuation.size());
    for (std::size_t a = 0; a < places_.loads.size(); ++a) {
      const auto at = static_cast<Index>(a);
      if (places_.loads[a] >= 0)
        loads[at] = values[places_.loads[a]];
      else if (model_.actuators[a].control == Control::load)
        loads[at] = actuation[at];
    }
    // what it is pulled by to the accuracy of the map
    for (const MapCable& cable : map_.data().cables) loads[cable.actuator] = std::max(0.0, loads[cable.actuator]);
    return loads;
  }

  const Model& model_;
  const KinematicMap& map_;
  const MapRobot::Places& places_;
};

}  // namespace

MapRobot::MapRobot(const Model& model, const KinematicMap& map)
    : model_(seen_by(model, map.data())),
      places_(places_of(model, map.data())),
      statics_(model_, std::make_unique<OfMap>(model_, map, places_)) {}

}  // namespace softkin
