#include <Eigen/Geometry>
#include <cmath>
#include <softkin/energy/rotation.hpp>
#include <softkin/statics/supports/rigid_body.hpp>

namespace softkin::supports {

using namespace energy;

Mat3 rotation_about(const Vec3& turn) {
  const double angle = turn.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Mat3(Mat3::Identity());
}

/// A region held along an axis (compile() allows that at three non-collinear vertices or none) neither slides along it
/// nor turns out of the plane; one that is held along all axes is as good as fixed.
std::vector<RigidBody> movable_bodies(const Model& model, std::vector<std::array<bool, 3>>& fixed, Points& held) {
  std::vector<RigidBody> bodies;
  for (const RigidRegion& rigid : model.rigid) {
    RigidBody body;
    body.vertices = rigid.vertices;
    for (const Index v : rigid.vertices)
      for (int axis = 0; axis < 3; ++axis)
        if (model.held.fixed[v][axis]) {
          body.slides[axis] = false;
          body.displacement[axis] = model.held.at(v, axis) - model.rest(v, axis);
          for (int other = 0; other < 3; ++other) body.turns[other] = body.turns[other] && other == axis;
        }
    if (!body.slides[0] && !body.slides[1] && !body.slides[2]) {
      for (const Index v : rigid.vertices) {
        fixed[v] = {true, true, true};
        held.row(v) = model.rest.row(v) + body.displacement.transpose();
      }
      continue;
    }
    const Index count = rigid.vertices.size();
    body.offsets.resize(count, 3);
    for (Index i = 0; i < count; ++i) body.offsets.row(i) = model.rest.row(rigid.vertices[i]);
    body.rest_center = body.offsets.colwise().mean().transpose();
    body.offsets.rowwise() -= body.rest_center.transpose().eval();
    bodies.push_back(std::move(body));
  }
  return bodies;
}

Vec3 center_of(const RigidBody& body, const Points& positions) {
  Vec3 sum = Vec3::Zero();
  for (const Index v : body.vertices) sum += positions.row(v).transpose();
  return sum / static_cast<double>(body.vertices.size());
}

Mat3 rotation_of(const RigidBody& body, const Points& positions, const Vec3& center) {
  Mat3 correlation = Mat3::Zero();
  for (Index i = 0; i < body.offsets.rows(); ++i)
    correlation += (positions.row(body.vertices[i]).transpose() - center) * body.offsets.row(i);
  if (body.turns[0] && body.turns[1] && body.turns[2]) return best_rotation(correlation);
  Mat3 rotation = Mat3::Identity();
  for (int about = 0; about < 3; ++about)
    if (body.turns[about]) {
      const int i = (about + 1) % 3, j = (about + 2) % 3;
      const double angle = std::atan2(correlation(j, i) - correlation(i, j), correlation(i, i) + correlation(j, j));
      rotation = rotation_about(angle * Vec3::Unit(about));
    }
  return rotation;
}

}  // namespace softkin::supports
