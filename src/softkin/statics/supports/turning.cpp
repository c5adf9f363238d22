#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/statics/supports/rigid_body.hpp>
#include <softkin/statics/supports/turning.hpp>

namespace softkin::supports {

namespace {

constexpr double radians = std::numbers::pi / 180;

/// Omits whole turns, so that 360 degrees are exactly the same as 0.
Mat3 rotation_by(const SupportTurn& turn, double degrees) {
  return rotation_about(std::remainder(degrees, 360.0) * radians * turn.axis);
}

}  // namespace

const SupportTurn* Turning::turn_of(Index actuator) const {
  const auto* command = model_.actuators[actuator].as<TurnCommand>();
  return command ? &model_.held.turns[command->turn] : nullptr;
}

void Turning::place(const Eigen::VectorXd& actuation, double load_factor, Points& positions) const {
  for (Index a = 0; any() && a < actuation.size(); ++a) {
    const SupportTurn* turn = turn_of(a);
    if (turn == nullptr) continue;
    const Mat3 rotation = rotation_by(*turn, load_factor * actuation[a]);
    for (const Index v : turn->vertices) {
      const Vec3 arm = model_.rest.row(v).transpose() - turn->about;
      positions.row(v) = (turn->about + rotation * arm + load_factor * turn->displacement).transpose();
    }
  }
}

void Turning::add_velocity(Index actuator, const Eigen::VectorXd& actuation, double load_factor, Points& moves) const {
  const SupportTurn* turn = turn_of(actuator);
  if (turn == nullptr) return;
  const Mat3 rotation = rotation_by(*turn, load_factor * actuation[actuator]);
  for (const Index v : turn->vertices) {
    const Vec3 arm = model_.rest.row(v).transpose() - turn->about;
    moves.row(v) += load_factor * radians * turn->axis.cross(rotation * arm).transpose();
  }
}

double Turning::angle(Index actuator, const Points& positions) const {
  const SupportTurn* turn = turn_of(actuator);
  double sine = 0, cosine = 0;
  for (const Index v : turn->vertices) {
    const Vec3 from = model_.rest.row(v).transpose() - turn->about;
    const Vec3 to = positions.row(v).transpose() - turn->about - turn->displacement;
    const Vec3 across = from - turn->axis.dot(from) * turn->axis;
    cosine += across.dot(to);
    sine += turn->axis.dot(across.cross(to));
  }
  return std::atan2(sine, cosine) / radians;
}

double Turning::largest_turn(const Eigen::VectorXd& from, double from_fraction, const Eigen::VectorXd& to,
                             double to_fraction) const {
  double largest = 0;
  for (Index a = 0; any() && a < to.size(); ++a)
    if (turn_of(a) != nullptr)
      largest =
          std::max(largest, std::abs(to[a] - from[a]) * std::max(std::abs(from_fraction), std::abs(to_fraction)) +
                                std::abs(to_fraction - from_fraction) * std::max(std::abs(from[a]), std::abs(to[a])));
  return largest;
}

}  // namespace softkin::supports
