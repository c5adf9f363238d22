#include <algorithm>
#include <cmath>
#include <softkin/model/compile/parts.hpp>

namespace softkin {

namespace {

/// Largest angle of a support's turn, in either sense [degrees]: ten revolutions, more than a soft robot is twisted.
constexpr double max_degrees = 3600;
/// Vertices nearer to the axis than this fraction of the robot's diagonal do not turn.
constexpr double on_axis = 1e-9;

Vec3 mean_of_vertices(const Points& points, const std::vector<Index>& vertices) {
  Vec3 sum = Vec3::Zero();
  for (const Index v : vertices) sum += points.row(v).transpose();
  return sum / static_cast<double>(vertices.size());
}

bool lies_off_axis(const Model& model, const SupportTurn& turn) {
  return std::any_of(turn.vertices.begin(), turn.vertices.end(), [&](Index v) {
    return turn.axis.cross(model.rest.row(v).transpose() - turn.about).norm() > on_axis * model.diagonal_mm;
  });
}

}  // namespace

void add_turn(Compilation& c, const FixedSpec& spec, const Support& support) {
  const RotationSpec& rotation = *spec.rotation;
  const auto fail = [&](const std::string& what) {
    throw InvalidInput(spec.where.origin, label(spec.where) + " " + what);
  };
  if (!std::all_of(spec.axes.begin(), spec.axes.end(), [](bool axis) { return axis; }))
    fail("is turned, but not held along all of x, y and z: a support that slides along an axis cannot be turned");
  const double length = rotation.axis.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) fail("is turned about an axis that has no direction");
  if (!(std::abs(rotation.degrees) <= max_degrees))
    fail("is turned by " + number(rotation.degrees) + " degrees: at most " + number(max_degrees) + " either way");
  if (rotation.about && !rotation.about->allFinite()) fail("is turned about a point that is not finite");
  SupportTurn turn{.support = support.name,
                   .axis = rotation.axis.stableNormalized(),
                   .about = rotation.about.value_or(mean_of_vertices(c.model.rest, support.vertices)),
                   .displacement = spec.displacement,
                   .vertices = support.vertices,
                   .degrees = rotation.degrees,
                   .origin = spec.where.origin};
  std::sort(turn.vertices.begin(), turn.vertices.end());
  if (!lies_off_axis(c.model, turn)) fail("is turned about an axis on which all of its vertices lie");
  c.model.held.turns.push_back(std::move(turn));
}

const SupportTurn* turn_of(const Model& model, Index vertex) {
  for (const SupportTurn& turn : model.held.turns)
    if (std::binary_search(turn.vertices.begin(), turn.vertices.end(), vertex)) return &turn;
  return nullptr;
}

void turn_rigid(Model& model, const RigidRegion& rigid, const std::string& label, const Origin& origin) {
  const SupportTurn* turn = nullptr;
  bool otherwise = false;
  for (const Index v : rigid.vertices) {
    const SupportTurn* holder = turn_of(model, v);
    otherwise =
        otherwise || (holder == nullptr ? model.held.fixed[v] != std::array<bool, 3>{} : turn && turn != holder);
    if (holder != nullptr) turn = holder;
  }
  if (turn == nullptr) return;
  if (otherwise)
    throw InvalidInput(origin, label + " is held by '" + turn->support + "', which turns it, and by another support");
  SupportTurn& turned = model.held.turns[turn - model.held.turns.data()];
  std::vector<Index> all;
  std::vector<Index> region = rigid.vertices;
  std::sort(region.begin(), region.end());
  std::set_union(turned.vertices.begin(), turned.vertices.end(), region.begin(), region.end(), std::back_inserter(all));
  turned.vertices = std::move(all);
  for (const Index v : rigid.vertices) {
    model.held.fixed[v] = {true, true, true};
    model.held.at.row(v) = model.rest.row(v) + turned.displacement.transpose();
  }
}

void add_turn_commands(Compilation& c) {
  Model& model = c.model;
  for (std::size_t t = 0; t < model.held.turns.size(); ++t) {
    const SupportTurn& turn = model.held.turns[t];
    Actuator command;
    command.name = turn.support + "_turn";
    if (command.name.find_first_of(",=\"#") != std::string::npos || command.name.front() == ' ')
      throw InvalidInput(
          turn.origin,
          "the command that turns it would be named '" + command.name +
              "': names of commands are without , = \" and # and begin with no blank, so rename the region");
    for (const Actuator& actuator : model.actuators)
      if (actuator.name == command.name)
        throw InvalidInput(turn.origin, "the command '" + command.name +
                                            "' has the name of an actuator: give one of them another name");
    command.drive = TurnCommand{static_cast<Index>(t)};
    command.control = Control::load;
    command.low = -max_degrees;
    command.high = max_degrees;
    command.rest = turn.degrees;
    model.actuators.push_back(std::move(command));
  }
}

}  // namespace softkin
