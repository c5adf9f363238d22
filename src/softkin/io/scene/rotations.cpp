#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <softkin/core/text.hpp>
#include <softkin/io/scene/parts.hpp>

namespace softkin::scene {

namespace {

/// A rotation that takes axes to axes is so exactly.
Mat3 without_rounding(const Mat3& matrix) {
  const Mat3 whole = matrix.array().round();
  return (matrix - whole).cwiseAbs().maxCoeff() < 1e-12 ? whole : matrix;
}

RigidMotion read_one(const Context& context, const Node& node) {
  const Map map(node, {"axis", "degrees", "quaternion", "about"});
  const Node* quaternion = map.find("quaternion");
  if (quaternion != nullptr)
    for (const char* key : {"axis", "degrees"})
      if (const Node* other = map.find(key))
        fail(*other, other->name + " and 'quaternion' exclude each other: give one of the two");
  const Mat3 rotation = quaternion != nullptr ? read_quaternion(*quaternion) : read_turn(map);
  const Node* about = map.find("about");
  const Vec3 center = about != nullptr ? read_position(context, *about) : Vec3::Zero();
  return {rotation, center - rotation * center};
}

}  // namespace

Mat3 read_quaternion(const Node& node) {
  constexpr double tolerance = 0.01;  // quaternions are often written with two or three digits
  Eigen::Vector4d q;
  const auto& items = list_of(4, node);
  for (Index i = 0; i < 4; ++i) q[i] = number(*items[i]);
  const double norm = q.stableNorm();
  if (!(std::abs(norm - 1) <= tolerance))
    fail(node, node.name + " must be a unit quaternion [w, x, y, z], but its norm is " + softkin::number(norm, 4) +
                   ": divide its numbers by that, or give 'axis' and 'degrees'");
  q /= norm;
  return without_rounding(Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix());
}

Mat3 read_turn(const Map& map) {
  const Vec3 axis = read_vector(map.at("axis"));
  if (!(axis.stableNorm() > 0)) fail(map.at("axis"), "'axis' has no direction");
  const Eigen::AngleAxisd turn(number(map.at("degrees")) * std::numbers::pi / 180, axis.stableNormalized());
  return without_rounding(turn.toRotationMatrix());
}

RigidMotion read_rotations(const Context& context, const Node& node) {
  if (node.kind != Node::Kind::list) return read_one(context, node);
  if (node.items.empty()) fail(node, node.name + " is an empty list: give at least one rotation, or leave it out");
  RigidMotion all;
  for (const auto& item : node.items) {
    const RigidMotion next = read_one(context, *item);
    all.translation = next.rotation * all.translation + next.translation;
    all.rotation = next.rotation * all.rotation;
  }
  all.rotation = without_rounding(all.rotation);
  return all;
}

}  // namespace softkin::scene
