#include <Eigen/Geometry>
#include <Eigen/LU>
#include <softkin/core/dense.hpp>
#include <softkin/model/marker.hpp>

namespace softkin {

Vec3 EmbeddedPoint::at(const Points& positions) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < vertices.size(); ++i) sum += weights[i] * positions.row(vertices[i]).transpose();
  return sum;
}

namespace {

/// What turns the arms at rest into those of a shape: sum of weight arm arm_at_rest^T.
Mat3 correlation_of(const Marker& marker, const Points& positions, const Vec3& center) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < marker.arms.size(); ++i)
    sum += marker.point.weights[i] * (positions.row(marker.point.vertices[i]).transpose() - center) *
           marker.arms[i].transpose();
  return sum;
}

}  // namespace

Vec3 Marker::at(const Points& positions) const {
  const Vec3 center = point.at(positions);
  if (arms.empty()) return center;
  return center + nearest_rotation(correlation_of(*this, positions, center)).rotation * stem;
}

Vec3 Marker::velocity(const Points& positions, const Points& moves) const {
  const Vec3 slide = point.at(moves);
  if (arms.empty()) return slide;
  const Mat3 correlation = correlation_of(*this, positions, point.at(positions));
  const Mat3 rotation = nearest_rotation(correlation).rotation, stretch = rotation.transpose() * correlation;
  // R^T dH = W S + dS with W skew and dS symmetric: its skew part is that of W S + S W, (tr S - S) of the axial vector
  const Mat3 change = rotation.transpose() * correlation_of(*this, moves, slide);
  const Vec3 twice(change(2, 1) - change(1, 2), change(0, 2) - change(2, 0), change(1, 0) - change(0, 1));
  const Mat3 inertia = stretch.trace() * Mat3::Identity() - 0.5 * (stretch + stretch.transpose());
  const Vec3 turn = inertia.inverse() * twice;
  return slide + rotation * turn.cross(stem);
}

}  // namespace softkin
