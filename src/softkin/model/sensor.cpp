#include <cmath>
#include <numbers>
#include <softkin/model/sensor.hpp>

namespace softkin {

namespace {

constexpr double degrees = 180 / std::numbers::pi;

Vec3 axial(const Mat3& m) {
  return {m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)};
}

Vec3 tangent_at(const FibrePlace& place, const Points& positions) {
  Vec3 along = Vec3::Zero();
  for (std::size_t i = 0; i < place.vertices.size(); ++i)
    along += place.slopes[i] * vertex_at(positions, place.vertices[i]);
  return along;
}

}  // namespace

Mat3 TurningSection::rotation(const Points& positions) const {
  Mat3 rotation;
  for (int i = 0; i < 3; ++i) rotation.col(i) = along[i].at(positions) - along[0].point.at(positions);
  return rotation;
}

Mat3 TurningSection::velocity(const Points& positions, const Points& moves) const {
  Mat3 velocity;
  for (int i = 0; i < 3; ++i) velocity.col(i) = along[i].velocity(positions, moves) - along[0].point.at(moves);
  return velocity;
}

double Sensor::at(const Points& positions, int component) const {
  if (kind == SensorKind::direction) return sections[0].rotation(positions).row(component).dot(axis);
  if (kind == SensorKind::angle) {
    const Mat3 turn = sections[0].rotation(positions).transpose() * sections[1].rotation(positions);
    return 2 * degrees * std::atan2(axis.dot(axial(turn)), 1 + turn.trace());
  }
  double length = 0;
  for (const FibrePlace& place : places) length += place.length_mm * tangent_at(place, positions).norm();
  return length;
}

double Sensor::velocity(const Points& positions, const Points& moves, int component) const {
  if (kind == SensorKind::direction) return sections[0].velocity(positions, moves).row(component).dot(axis);
  if (kind == SensorKind::angle) {
    const Mat3 first = sections[0].rotation(positions), second = sections[1].rotation(positions);
    const Mat3 turn = first.transpose() * second;
    const Mat3 change = sections[0].velocity(positions, moves).transpose() * second +
                        first.transpose() * sections[1].velocity(positions, moves);
    const double y = axis.dot(axial(turn)), x = 1 + turn.trace();
    return 2 * degrees * (x * axis.dot(axial(change)) - y * change.trace()) / (x * x + y * y);
  }
  double change = 0;
  for (const FibrePlace& place : places)
    change += place.length_mm * tangent_at(place, positions).normalized().dot(tangent_at(place, moves));
  return change;
}

}  // namespace softkin
