#include <algorithm>
#include <filesystem>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/maps/piece_solver.hpp>
#include <softkin/kinematics/sampling.hpp>
#include <softkin/model/names.hpp>
#include <utility>

namespace softkin::maps {

namespace {

/// A robot whose taut cables push, too, and whose other ones are not there.
Model of_piece(const Model& model, const MapData& data, const MapPiece& piece) {
  Model changed = model;
  for (std::size_t c = 0, a = 0; a < changed.actuators.size(); ++a) {
    Actuator& actuator = changed.actuators[a];
    if (c == data.cables.size() || data.cables[c].actuator != static_cast<Index>(a)) continue;
    if (piece.taut[c++]) {
      std::get<CableDrive>(actuator.drive).pushes = true;
    } else {
      actuator.control = Control::load;
      actuator.low = actuator.high = actuator.rest = 0;
    }
  }
  return changed;
}

/// A cable that goes slack where it would push.
bool is_cable(const Model& model, const Actuator& actuator) {
  return model.formulation == Formulation::physical && actuator.is<CableDrive>() && actuator.control == Control::ratio;
}

/// Does a physical robot answer with a load?
bool answers_with_load(const Model& model, const Actuator& actuator) {
  return model.formulation == Formulation::physical && softkin::answers_with_load(actuator);
}

/// Loads on the robot are commands of its maps, too.
bool is_input(const Actuator& actuator) {
  return varies(actuator) || (loads_robot(actuator) && actuator.low < actuator.high);
}

}  // namespace

bool answers_with_ratio(const Model& model, const Actuator& actuator) {
  return has_measure(actuator) &&
         (answers_with_measure(actuator) || !answers_with_load(model, actuator) || is_cable(model, actuator));
}

MapData outline_of(const Model& model) {
  if (model.markers.empty())
    throw InvalidInput("the robot has no marker, so that a map has nothing to give: add one to the scene");
  if (has_friction(model))
    throw InvalidInput("with friction shapes depend on the path: a map is for robots without friction");
  MapData data;
  data.robot = fingerprint_of(model);
  data.name = std::filesystem::path(model.name).stem().string();
  data.actuation = model.rest_actuation();
  for (const Marker& marker : model.markers)
    for (const char* axis : {"_x", "_y", "_z"}) data.outputs.push_back({marker.name + axis, "mm"});
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const Index next = data.outputs.size();
    const Index input = data.inputs.size();
    const Index number = a;
    if (answers_with_load(model, actuator)) {
      const bool cable = actuator.is<CableDrive>();
      data.outputs.push_back({actuator.name + (cable ? "_tension" : "_pressure"), cable ? "N" : "kPa"});
    }
    if (answers_with_ratio(model, actuator)) data.outputs.push_back({actuator.name + "_ratio", ""});
    if (is_cable(model, actuator))
      data.cables.push_back({number, varies(actuator) ? input : -1, data.actuation[number], next, next + 1});
    if (is_input(actuator))
      data.inputs.push_back({actuator.name, command_unit(actuator), number, actuator.low, actuator.high});
  }
  if (data.inputs.empty()) throw InvalidInput("no actuator of the robot has a range, so that there is nothing to map");
  if (data.inputs.size() > max_variables)
    throw InvalidInput("a map takes up to " + std::to_string(max_variables) + " commands, the robot has " +
                       std::to_string(data.inputs.size()));
  return data;
}

Eigen::VectorXd outputs_of(const Model& model, const MapData& data, const State& state) {
  Eigen::VectorXd values(data.outputs.size());
  Index next = 0;
  for (const Marker& marker : model.markers) {
    values.segment<3>(next) = marker.at(state.positions);
    next += 3;
  }
  std::size_t c = 0;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    // a cable of a piece that is slack there answers as the robot's does
    const bool cable = c < data.cables.size() && data.cables[c].actuator == static_cast<Index>(a);
    if (cable) ++c;
    if (cable || answers_with_load(model, actuator)) values[next++] = state.multipliers[a];
    if (cable || answers_with_ratio(model, actuator)) values[next++] = achieved_ratio(model, actuator, state.positions);
  }
  return values;
}

PieceSolver::PieceSolver(const Model& model, const MapData& data, const MapPiece& piece)
    : model_(of_piece(model, data, piece)), data_(data), statics_(model_) {
  for (const Index input : piece.inputs) actuators_.push_back(data.inputs[input].actuator);
}

std::optional<Sample> PieceSolver::solve(const Eigen::VectorXd& commands, const Sample* nearest,
                                         const StaticsOptions& options, const ProgressCallback& progress) const {
  const StaticsOptions own = one_of_many(options);
  Sample sample;
  sample.commands = commands;
  Actuation actuation = model_.rest_actuation();
  for (std::size_t j = 0; j < actuators_.size(); ++j) actuation[actuators_[j]] = commands[j];
  Equilibrium found = statics_.solve(actuation, nearest ? nearest->state : statics_.rest(), own, progress);
  if (found.report.stopped) return std::nullopt;
  // beyond a snap shapes are others than those from where they were reached
  if (found.report.status != Status::converged || found.report.physical.snapped_mm > 0) return sample;
  sample.state = std::move(found.state);
  const Sensitivity sensitivity = statics_.sensitivity(sample.state, own, 1e-7);
  if (!sensitivity.regular) return sample;
  add_values(sample);
  add_slopes(sensitivity, sample);
  return sample;
}

void PieceSolver::add_values(Sample& sample) const {
  sample.values = outputs_of(model_, data_, sample.state);
}

void PieceSolver::add_slopes(const Sensitivity& sensitivity, Sample& sample) const {
  constexpr double fraction = 1e-4;  // of a range: for ratios, which are differentiated by differences
  const Index variables = actuators_.size();
  sample.slopes.resize(variables, sample.values.size());
  sample.moves.resize(3 * model_.rest.rows(), variables);
  for (Index j = 0; j < variables; ++j) {
    const Index a = actuators_[j];
    const Actuator& actuator = model_.actuators[a];
    const Points& moves = sensitivity.positions[a];
    const double step = fraction * (actuator.high - actuator.low);
    State before = sample.state, after = sample.state;
    before.positions -= step * moves;
    after.positions += step * moves;
    before.multipliers -= step * sensitivity.multipliers.col(a);
    after.multipliers += step * sensitivity.multipliers.col(a);
    sample.slopes.row(j) = (outputs_of(model_, data_, after) - outputs_of(model_, data_, before)) / (2 * step);
    for (Index v = 0; v < moves.rows(); ++v)
      for (int k = 0; k < 3; ++k) sample.moves(3 * v + k, j) = static_cast<float>(moves(v, k));
  }
}

}  // namespace softkin::maps
