#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/estimate/variables.hpp>
#include <softkin/model/families.hpp>
#include <softkin/model/names.hpp>

namespace softkin::estimate {

namespace {

[[noreturn]] void refuse_unknown(const EstimatedUnknown& unknown, const std::string& why) {
  throw InvalidInput((unknown.option.empty() ? "unknown '" : unknown.option + " '") + unknown.name + "': " + why);
}

/// The commands of a force, or of its moment, that the scene gives a range: NAME_fx and so on.
template <class Kind>
std::vector<Index> commands_of(const Model& model, const std::string& name) {
  std::vector<Index> commands;
  for (const char* axis : axis_names)
    if (const auto a = find_actuator(model, name + (std::is_same_v<Kind, MomentCommand> ? "_m" : "_f") + axis))
      if (model.actuators[*a].template is<Kind>()) commands.push_back(*a);
  return commands;
}

}  // namespace

Variables::Variables(const Model& model, const std::vector<EstimatedUnknown>& unknowns)
    : model_(std::make_unique<Model>(model)), own_actuators_(model.actuators.size()) {
  if (model.formulation != Formulation::physical)
    throw InvalidInput({.file = model.name},
                       "forces are estimated in the physical formulation; this scene is of target shapes");
  if (has_friction(model))
    throw InvalidInput({.file = model.name},
                       "with friction shapes depend on the path: forces cannot be estimated from them");
  if (unknowns.empty()) throw InvalidInput("there is no unknown to estimate");
  for (const EstimatedUnknown& unknown : unknowns) add(unknown);
}

namespace {

/// NAME of "materials.NAME.stiffness".
std::optional<std::string> stiffened_region(const std::string& unknown) {
  constexpr std::string_view begin = "materials.", end = ".stiffness";
  if (!unknown.starts_with(begin) || !unknown.ends_with(end) || unknown.size() <= begin.size() + end.size())
    return std::nullopt;
  return unknown.substr(begin.size(), unknown.size() - begin.size() - end.size());
}

void stiffen(Material& material, double factor) {
  ElasticLaw& law = material.elastic;
  for (double* modulus : {&law.mu, &law.lambda, &law.c10, &law.c01, &law.c20, &law.c30, &law.bulk}) *modulus *= factor;
  for (OgdenTerm& term : law.ogden) term.mu *= factor;
  for (ViscousBranch& branch : material.viscosity) branch.modulus_MPa *= factor;
  if (!material.families) return;
  Families families = *material.families;
  for (Families::Family& family : families.families) family.k1_MPa *= factor;
  material.families = std::make_shared<const Families>(std::move(families));
}

}  // namespace

void Variables::add(const EstimatedUnknown& unknown) {
  if (const auto region = stiffened_region(unknown.name)) return add_stiffness(unknown, *region);
  const std::optional<Index> command = find_actuator(*model_, unknown.name);
  const std::vector<Index> force = commands_of<ForceCommand>(*model_, unknown.name);
  const std::vector<Index> moment = commands_of<MomentCommand>(*model_, unknown.name);
  if (command && !(force.empty() && moment.empty()))
    refuse_unknown(unknown, "both a command and a force have that name");
  if (!command && force.empty() && moment.empty()) {
    std::vector<std::string> names;
    for (Index a = 0; a < own_actuators_; ++a) names.push_back(model_->actuators[a].name);
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    refuse_unknown(unknown, "the scene has no command of that name, and no force with a 'range'; commands: " + list +
                                ". The stiffness of a material is materials.REGION.stiffness");
  }
  if (unknown.somewhere && command) refuse_unknown(unknown, "a command has no place: name a force");
  if (unknown.deviation && !(*unknown.deviation > 0 && std::isfinite(*unknown.deviation)))
    refuse_unknown(unknown, "the deviation must be above 0");
  if (unknown.somewhere && !moment.empty())
    refuse_unknown(unknown, "it has a moment, which acts on its region as a whole: its place cannot be estimated");
  if (unknown.somewhere) return add_patch(unknown, force);
  if (command) return add_variable(unknown, *command, -1);
  for (const Index a : force) add_variable(unknown, a, -1);
  for (const Index a : moment) add_variable(unknown, a, -1);
}

void Variables::add_variable(const EstimatedUnknown& unknown, Index actuator, Index force) {
  const Actuator& of = model_->actuators[actuator];
  if (std::any_of(variables_.begin(), variables_.end(), [&](const Variable& v) { return v.actuator == actuator; }))
    refuse_unknown(unknown, "command '" + of.name + "' is to be estimated twice");
  if (!(of.low < of.high))
    refuse_unknown(unknown, "command '" + of.name + "' has one value, so there is nothing to estimate");
  if (of.is<HoldCommand>() || of.is<MotionCommand>())
    refuse_unknown(unknown, "a command of kind '" + std::string(kind_name(of)) + "' cannot be estimated");
  Variable variable{.actuator = actuator,
                    .force = force,
                    .mean = unknown.mean.value_or(of.rest),
                    .deviation = unknown.deviation.value_or((of.high - of.low) / 2),
                    .low = of.low,
                    .high = of.high};
  if (!(variable.mean >= of.low && variable.mean <= of.high))
    refuse_unknown(unknown, "its mean, " + command_text(of, variable.mean) + ", is outside " + range_text(of));
  variables_.push_back(variable);
}

void Variables::add_stiffness(const EstimatedUnknown& unknown, const std::string& region) {
  constexpr double most = 10;  // times the mean, or as small a part of it
  const auto refuse = [&](const std::string& why) { refuse_unknown(unknown, why); };
  const auto material = std::find_if(model_->elements.materials.begin(), model_->elements.materials.end(),
                                     [&](const Material& m) { return m.region == region; });
  if (material == model_->elements.materials.end()) {
    std::vector<std::string> names;
    for (const Material& m : model_->elements.materials) names.push_back(m.region);
    refuse("there is no material of region '" + region + "'" + suggest_name(region, names));
  }
  const Index index = material - model_->elements.materials.begin();
  if (std::any_of(variables_.begin(), variables_.end(), [&](const Variable& v) { return v.material == index; }))
    refuse("it is to be estimated twice");
  if (unknown.somewhere) refuse("a stiffness has no place: name a force");
  if (!unknown.deviation)
    refuse("say what is known of it before, over that of the scene, such as " + unknown.name + "=1+-0.2");
  if (!(*unknown.deviation > 0 && std::isfinite(*unknown.deviation))) refuse("the deviation must be above 0");
  const double mean = unknown.mean.value_or(1);
  if (!(mean > 0 && std::isfinite(mean))) refuse("its mean must be above 0");
  variables_.push_back(
      {.material = index, .mean = mean, .deviation = *unknown.deviation, .low = mean / most, .high = mean * most});
}

std::string name_of(const Model& model, const Variable& variable) {
  if (variable.actuator >= 0) return model.actuators[variable.actuator].name;
  return "materials." + model.elements.materials[variable.material].region + ".stiffness";
}

EstimatedNumber reported_number(const Model& model, const Variable& variable, double value, double deviation) {
  EstimatedNumber estimated;
  estimated.name = name_of(model, variable);
  if (variable.actuator >= 0) estimated.unit = command_unit(model.actuators[variable.actuator]);
  estimated.value = value;
  estimated.deviation = deviation;
  estimated.known_mean = variable.mean;
  estimated.known_deviation = variable.deviation;
  estimated.at_bound = value <= variable.low ? -1 : value >= variable.high ? 1 : 0;
  estimated.actuator = variable.actuator;
  return estimated;
}

std::vector<Index> Variables::reported_actuators() const {
  std::vector<Index> estimated;
  for (const Variable& variable : variables_)
    if (variable.actuator >= 0) estimated.push_back(variable.actuator);
  return estimated;
}

bool Variables::stiffens() const {
  return std::any_of(variables_.begin(), variables_.end(), [](const Variable& v) { return v.material >= 0; });
}

Model Variables::stiffened(const Eigen::VectorXd& values) const {
  Model robot = *model_;
  for (Index i = 0; i < numbers(); ++i)
    if (const Index m = variables_[i].material; m >= 0) stiffen(robot.elements.materials[m], values[i]);
  return robot;
}

void Variables::add_patch(const EstimatedUnknown& unknown, const std::vector<Index>& commands) {
  const Index number = forces_.size();
  FreeForce force;
  force.name = unknown.name;
  for (const Index a : commands) {
    const auto& of = std::get<ForceCommand>(model_->actuators[a].drive);
    if (of.faces.empty())
      refuse_unknown(unknown,
                     "its place can be estimated on a region of faces of the body's surface; it is at a point, or at a "
                     "region without such");
    if (!force.patch) force.patch = std::make_unique<Patch>(*model_, of.faces);
    force.variables[of.axis] = numbers();
    add_variable(unknown, a, number);
  }
  add_node_commands(force);
  forces_.push_back(std::move(force));
}

void Variables::add_node_commands(FreeForce& force) {
  force.first_command = model_->actuators.size();
  for (const Index node : force.patch->nodes())
    for (int axis = 0; axis < 3; ++axis) {
      Actuator command;
      command.name = force.name + ":" + std::to_string(node) + axis_names[axis];
      command.drive = ForceCommand{.axis = axis, .place = EmbeddedPoint{{node}, {1.0}}};
      command.control = Control::load;
      command.rest = 0;
      command.high = std::numeric_limits<double>::max();
      command.low = -command.high;
      model_->actuators.push_back(std::move(command));
    }
}

Actuation Variables::actuation(const Actuation& commands, const Eigen::VectorXd& values,
                               const std::vector<Place>& places) const {
  Actuation all = Actuation::Zero(model_->actuators.size());
  all.head(own_actuators_) = commands;
  for (Index i = 0; i < numbers(); ++i) {
    const Variable& variable = variables_[i];
    if (variable.actuator >= 0) all[variable.actuator] = variable.force < 0 ? values[i] : 0;
  }
  for (std::size_t f = 0; f < forces_.size(); ++f) {
    const std::vector<Actuation> along = changes_at(f, places[f]);
    std::size_t next = 0;
    for (const Index variable : forces_[f].variables)
      if (variable >= 0) all += values[variable] * along[next++];
  }
  return all;
}

std::vector<Actuation> Variables::changes_at(std::size_t number, const Place& place) const {
  const FreeForce& force = forces_[number];
  const Patch::Fractions at = force.patch->fractions(place);
  std::vector<Actuation> changes;
  for (Index axis = 0; axis < 3; ++axis) {
    if (force.variables[axis] < 0) continue;
    Actuation& change = changes.emplace_back(Actuation::Zero(model_->actuators.size()));
    for (std::size_t i = 0; i < at.nodes.size(); ++i)
      change[force.first_command + 3 * at.nodes[i] + axis] = at.fractions[i];
  }
  return changes;
}

Eigen::VectorXd Variables::parts(const Eigen::VectorXd& values, const std::vector<Place>& places,
                                 const std::vector<Place>& base) const {
  std::vector<double> parts(values.data(), values.data() + values.size());
  for (std::size_t f = 0; f < forces_.size(); ++f) {
    const Patch& patch = *forces_[f].patch;
    const Eigen::Vector2d path =
        patch.tangents(base[f]).transpose() * (patch.at(places[f], model_->rest) - patch.at(base[f], model_->rest));
    for (const Index variable : forces_[f].variables)
      for (Index t = 0; variable >= 0 && t < 2; ++t) parts.push_back(values[variable] * path[t]);
  }
  return Eigen::Map<const Eigen::VectorXd>(parts.data(), parts.size());
}

Eigen::MatrixXd Variables::part_slopes(const Eigen::VectorXd& values, const std::vector<Place>& places,
                                       const std::vector<Place>& base) const {
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(parts(values, places, base).size(), columns());
  slopes.topLeftCorner(numbers(), numbers()).setIdentity();
  Index part = numbers();
  for (std::size_t f = 0; f < forces_.size(); ++f) {
    const Patch& patch = *forces_[f].patch;
    const Eigen::Matrix<double, 2, 3> along = patch.tangents(base[f]).transpose();
    const Eigen::Vector2d path = along * (patch.at(places[f], model_->rest) - patch.at(base[f], model_->rest));
    const Eigen::Matrix2d turned = along * patch.tangents(places[f]);
    for (const Index variable : forces_[f].variables)
      for (Index t = 0; variable >= 0 && t < 2; ++t, ++part) {
        slopes(part, variable) = path[t];
        slopes.block<1, 2>(part, numbers() + 2 * f) = values[variable] * turned.row(t);
      }
  }
  return slopes;
}

std::vector<Actuation> Variables::part_changes(const std::vector<Place>& base) const {
  const Actuation none = Actuation::Zero(model_->actuators.size());
  std::vector<Actuation> changes(numbers(), none);
  for (Index i = 0; i < numbers(); ++i)
    if (const Variable& variable = variables_[i]; variable.force < 0 && variable.actuator >= 0)
      changes[i][variable.actuator] = 1;
  for (std::size_t f = 0; f < forces_.size(); ++f) {
    const FreeForce& force = forces_[f];
    const Patch::Fractions at = force.patch->fractions(base[f]);
    std::vector<Actuation> along = changes_at(f, base[f]);
    std::size_t next = 0;
    for (Index axis = 0; axis < 3; ++axis) {
      const Index variable = force.variables[axis];
      if (variable < 0) continue;
      changes[variable] = std::move(along[next++]);
      for (Index t = 0; t < 2; ++t) {
        Actuation& change = changes.emplace_back(none);
        for (std::size_t i = 0; i < at.nodes.size(); ++i)
          change[force.first_command + 3 * at.nodes[i] + axis] = at.slopes(i, t);
      }
    }
  }
  return changes;
}

std::vector<Index> Variables::measured() const {
  std::vector<Index> measured;
  for (Index a = 0; a < own_actuators_; ++a) {
    const Actuator& actuator = model_->actuators[a];
    const bool estimated =
        std::any_of(variables_.begin(), variables_.end(), [&](const Variable& v) { return v.actuator == a; });
    if (!estimated && actuator.low < actuator.high && drives(actuator)) measured.push_back(a);
  }
  return measured;
}

Eigen::VectorXd Variables::means() const {
  Eigen::VectorXd means(numbers());
  for (Index i = 0; i < numbers(); ++i) means[i] = variables_[i].mean;
  return means;
}

Eigen::VectorXd Variables::clamped(Eigen::VectorXd values) const {
  for (Index i = 0; i < numbers(); ++i) values[i] = std::clamp(values[i], variables_[i].low, variables_[i].high);
  return values;
}

}  // namespace softkin::estimate
