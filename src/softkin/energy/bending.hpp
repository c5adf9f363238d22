#pragma once

#include <softkin/core/sheet_law.hpp>
#include <softkin/energy/jet.hpp>

namespace softkin::energy {

/// A place of a thin sheet whose surface is known there to second order: tangents x_1, x_2 [-] and x_11, x_22, x_12
/// [1/mm] by its own coordinates at rest.
using SheetShape = Eigen::Matrix<double, 3, 5>;

/// One side of an edge: tangents x_1, x_2 there, and a vector c of second derivatives with n . c the moment across the
/// edge [N].
using SideShape = Mat3;

template <int N>
struct BendingResponse {
  double energy = 0;  // [mJ]; NaN where a tangent plane has no area
  Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();  // by the columns
  Eigen::Matrix<double, N, N> hessian = Eigen::Matrix<double, N, N>::Zero();   // where requested
};

[[nodiscard]] Vec3 curvature_of(const SheetShape& shape);
[[nodiscard]] BendingResponse<15> bend(const BendingPlace& place, const SheetShape& shape, bool second);

/// The angle by which the slope jumps from the first to the second side: above 0 where it is hollow, seen from above.
[[nodiscard]] double joint_angle(const BendingJoint& joint, const SideShape& first, const SideShape& second);
/// By the columns of the first, then of the second side.
[[nodiscard]] BendingResponse<18> bend(const BendingJoint& joint, const SideShape& first, const SideShape& second,
                                       bool second_order);

}  // namespace softkin::energy
