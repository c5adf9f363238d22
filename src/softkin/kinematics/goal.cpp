#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/inverse_response.hpp>
#include <string>

namespace softkin {

using inverse::Exertion;
using inverse::ExertionSlopes;

namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

Vec3 marker_at(const Model& model, Index marker, const Points& positions) {
  return model.markers[marker].at(positions);
}

/// How a marker moves where the vertices do.
Vec3 marker_move(const Model& model, Index marker, const Points& positions, const Points& moves) {
  return model.markers[marker].velocity(positions, moves);
}

/// The coordinates that count.
Eigen::VectorXd counted(const auto& goal, const Vec3& vector) {
  Eigen::VectorXd terms(std::count(goal.axes.begin(), goal.axes.end(), true));
  for (Index axis = 0, row = 0; axis < 3; ++axis)
    if (goal.axes[axis]) terms[row++] = vector[axis];
  return terms;
}

/// The same with zero for those that do not.
Vec3 masked(const ForceGoal& goal, Vec3 vector) {
  for (int axis = 0; axis < 3; ++axis)
    if (!goal.axes[axis]) vector[axis] = 0;
  return vector;
}

/// Returns the unit vector, or zero for a vector that vanishes: two markers may coincide.
Vec3 unit(const Vec3& vector) {
  const double length = vector.stableNorm();
  return length > 0 ? Vec3(vector / length) : Vec3::Zero();
}

/// Returns the direction in which closing the gap leads towards the target force: zero where there is no gap, or where
/// the target force does not push across it.
Vec3 motion_to_contact(const ForceGoal& goal, const Exertion& found) {
  const Vec3 along = unit(masked(goal, goal.force));
  return found.gap && along.dot(found.gap->towards) > 0 ? along : Vec3(Vec3::Zero());
}

/// Returns the remaining distance to where the contact forces between the surfaces begin [mm].
double remaining_path(const Model& model, const Exertion& found) {
  return found.gap ? std::max(0.0, found.gap->width_mm - model.contact.distance_mm) : 0;
}

/// Errors of one goal, unweighted: one value per coordinate that counts [mm]. found: of a force
Eigen::VectorXd terms_of(const Model& model, const Goal& goal, const Points& positions, const Exertion& found) {
  return std::visit(Overloaded{[&](const PositionGoal& g) -> Eigen::VectorXd {
                                 return counted(g, marker_at(model, g.marker, positions) - g.target);
                               },
                               [&](const PlaneGoal& g) -> Eigen::VectorXd {
                                 const Vec3 miss = marker_at(model, g.marker, positions) - g.point;
                                 return Eigen::VectorXd::Constant(1, unit(g.normal).dot(miss));
                               },
                               [&](const DirectionGoal& g) -> Eigen::VectorXd {
                                 const Vec3 line =
                                     marker_at(model, g.to, positions) - marker_at(model, g.from, positions);
                                 return g.lever_mm * (unit(line) - unit(g.direction));
                               },
                               [&](const ForceGoal& g) -> Eigen::VectorXd {
                                 const Vec3 path = remaining_path(model, found) * motion_to_contact(g, found);
                                 return counted(g, g.mm_per_N * (found.force - g.force) - path);
                               }},
                    goal.what);
}

/// Derivative of terms_of along a change of the positions. change: of what is found, by command a
Eigen::VectorXd change_of(const Model& model, const Goal& goal, const Points& positions, const Points& moves,
                          const Exertion& found, const ExertionSlopes& change, Index a) {
  return std::visit(
      Overloaded{[&](const PositionGoal& g) -> Eigen::VectorXd {
                   return counted(g, marker_move(model, g.marker, positions, moves));
                 },
                 [&](const PlaneGoal& g) -> Eigen::VectorXd {
                   const Vec3 move = marker_move(model, g.marker, positions, moves);
                   return Eigen::VectorXd::Constant(1, unit(g.normal).dot(move));
                 },
                 [&](const DirectionGoal& g) -> Eigen::VectorXd {
                   const Vec3 line = marker_at(model, g.to, positions) - marker_at(model, g.from, positions);
                   const Vec3 move =
                       marker_move(model, g.to, positions, moves) - marker_move(model, g.from, positions, moves);
                   const double length = line.stableNorm();
                   if (!(length > 0)) return Vec3::Zero();
                   const Vec3 along = line / length;
                   return g.lever_mm / length * (move - along.dot(move) * along);
                 },
                 [&](const ForceGoal& g) -> Eigen::VectorXd {
                   const Vec3 path = found.gap ? Vec3(change.gap[a] * motion_to_contact(g, found)) : Vec3::Zero();
                   return counted(g, g.mm_per_N * change.force.col(a) - path);
                 }},
      goal.what);
}

/// each(i) of every goal.
template <class Each>
Eigen::VectorXd joined(const std::vector<Goal>& goals, const Each& each) {
  std::vector<double> all;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const Eigen::VectorXd terms = std::sqrt(goals[i].weight) * each(i);
    all.insert(all.end(), terms.data(), terms.data() + terms.size());
  }
  return Eigen::Map<Eigen::VectorXd>(all.data(), all.size());
}

class Check {
 public:
  Check(const Model& model, std::size_t number) : model_(model), name_("goal " + std::to_string(number + 1)) {}

  void operator()(const PositionGoal& goal) const {
    marker(goal.marker);
    finite(goal.target, "target");
    if (goal.axes == std::array<bool, 3>{}) refuse("no coordinate of its target counts");
  }
  void operator()(const PlaneGoal& goal) const {
    marker(goal.marker);
    finite(goal.point, "plane's point");
    directed(goal.normal, "plane's normal");
  }
  void operator()(const DirectionGoal& goal) const {
    marker(goal.from);
    marker(goal.to);
    if (goal.from == goal.to) refuse("the direction from a marker to itself is none");
    directed(goal.direction, "direction");
    positive(goal.lever_mm, "lever");
  }
  void operator()(const ForceGoal& goal) const {
    if (model_.formulation != Formulation::physical)
      refuse("a force is found in the physical formulation alone: target shapes have no forces");
    const std::vector<ContactPart>& parts = model_.contact.parts;
    const std::size_t count = goal.on == ForceGoal::On::support ? model_.held.supports.size() : parts.size();
    const std::size_t place = goal.index;
    const bool there = goal.index >= 0 && place < count;
    if (!there || (goal.on == ForceGoal::On::part && parts[place].rank == ContactRank::robot))
      refuse("the robot has no support, obstacle or body number " + std::to_string(goal.index) + " to press on");
    finite(goal.force, "force");
    if (goal.axes == std::array<bool, 3>{}) refuse("no component of its force counts");
    positive(goal.mm_per_N, "length per force");
  }
  void positive(double value, const std::string& what) const {
    if (!(value > 0 && std::isfinite(value))) refuse("its " + what + " must be finite and > 0");
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const { throw InvalidInput(name_ + ": " + why); }
  void marker(Index index) const {
    if (index < 0 || index >= std::ssize(model_.markers))
      refuse("the robot has no marker number " + std::to_string(index));
  }
  void finite(const Vec3& vector, const std::string& what) const {
    if (!vector.allFinite()) refuse("its " + what + " holds a coordinate that is not finite");
  }
  void directed(const Vec3& vector, const std::string& what) const {
    finite(vector, what);
    if (!(vector.stableNorm() > 0)) refuse("its " + what + " is zero");
  }

  const Model& model_;
  std::string name_;
};

/// Returns the distance of a marker at rest from its target, along the coordinates that count, as if the target were
/// given in units of unit_mm [mm].
double distance_from_rest(const Model& model, const PositionGoal& goal, double unit_mm) {
  const Vec3 rest = marker_at(model, goal.marker, model.rest);
  Vec3 away = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (goal.axes[axis]) away[axis] = unit_mm * goal.target[axis] - rest[axis];
  return away.stableNorm();
}

}  // namespace

void check_goals(const Model& model, const std::vector<Goal>& goals) {
  if (goals.empty()) throw InvalidInput("inverse kinematics needs a goal");
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const Check check(model, i);
    std::visit(check, goals[i].what);
    check.positive(goals[i].weight, "weight");
  }
}

Eigen::VectorXd goal_errors(const Model& model, const std::vector<Goal>& goals, const Points& positions) {
  if (any_force(goals)) throw InvalidInput("positions alone do not determine what a robot exerts");
  return inverse::errors_of(model, goals, positions, {});
}

std::vector<std::string> doubts_about(const Model& model, const std::vector<Goal>& goals) {
  constexpr double large = 100, metre = 1000;
  std::vector<std::string> doubts;
  for (const Goal& requested : goals) {
    const auto* goal = std::get_if<PositionGoal>(&requested.what);
    if (goal == nullptr) continue;
    const double given = distance_from_rest(model, *goal, 1), metres = distance_from_rest(model, *goal, metre);
    const bool far = given > large * model.diagonal_mm;
    const bool small = metres < 0.5 * given && goal->target.cwiseAbs().maxCoeff() * large < model.diagonal_mm;
    if (!far && !small) continue;
    const std::string away = "target of '" + model.markers[goal->marker].name + "': " + number(given) +
                             " mm away from the marker at rest, but the robot is " + number(model.diagonal_mm) +
                             " mm across";
    doubts.push_back(away + (far ? ": are the coordinates in another unit than mm?"
                                 : "; it would be " + number(metres, 3) +
                                       " mm away if the coordinates were in metres: are they? They are taken as mm"));
  }
  if (any_force(goals) && has_friction(model))
    doubts.emplace_back(
        "with friction a shape depends on its path: the force is that on the path of the search, and forward "
        "kinematics along the "
        "same commands may come to another one");
  return doubts;
}

Eigen::VectorXd inverse::errors_of(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                   const std::vector<Exertion>& exertions) {
  Eigen::VectorXd errors(goals.size());
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const Exertion found{exertions.empty() ? Vec3(Vec3::Zero()) : exertions[i].force, std::nullopt};
    errors[i] = terms_of(model, goals[i], positions, found).stableNorm();
  }
  return errors;
}

Eigen::VectorXd inverse::goal_terms(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                    const std::vector<Exertion>& exertions) {
  return joined(goals, [&](std::size_t i) {
    return terms_of(model, goals[i], positions, exertions.empty() ? Exertion{} : exertions[i]);
  });
}

Eigen::MatrixXd inverse::goal_slopes(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                     const Sensitivity& sensitivity, const std::vector<Exertion>& exertions,
                                     const std::vector<ExertionSlopes>& changes) {
  Eigen::MatrixXd slopes(inverse::goal_terms(model, goals, positions, exertions).size(), sensitivity.positions.size());
  const Exertion nothing;
  const ExertionSlopes no_change;
  for (std::size_t a = 0; a < sensitivity.positions.size(); ++a)
    slopes.col(a) = joined(goals, [&](std::size_t i) {
      return change_of(model, goals[i], positions, sensitivity.positions[a], exertions.empty() ? nothing : exertions[i],
                       changes.empty() ? no_change : changes[i], a);
    });
  return slopes;
}

}  // namespace softkin
