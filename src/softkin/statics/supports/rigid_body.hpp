#pragma once

#include <softkin/model/model.hpp>

namespace softkin::supports {

/// A rigid region that can move.
struct RigidBody {
  std::vector<Index> vertices;
  Points offsets;  // rest minus rest center
  Vec3 rest_center, displacement{0, 0, 0};
  std::array<bool, 3> slides{true, true, true};  // may its center move along the axis
  std::array<bool, 3> turns{true, true, true};   // may it turn about the axis
};

/// The rigid regions of a model that can move. Vertices of those that are held whole become fixed, and held where their
/// region is.
[[nodiscard]] std::vector<RigidBody> movable_bodies(const Model& model, std::vector<std::array<bool, 3>>& fixed,
                                                    Points& held);

/// Mean of its vertices.
[[nodiscard]] Vec3 center_of(const RigidBody& body, const Points& positions);
/// Rotation from rest, among those that it may make, that fits its vertices best.
[[nodiscard]] Mat3 rotation_of(const RigidBody& body, const Points& positions, const Vec3& center);

/// Rotation about an axis by an angle, both in one vector [rad].
[[nodiscard]] Mat3 rotation_about(const Vec3& turn);

}  // namespace softkin::supports
