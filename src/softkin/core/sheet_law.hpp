#pragma once

#include <array>
#include <optional>
#include <softkin/core/types.hpp>

namespace softkin {

/// Of rubber that keeps its volume: W = c10 (I1 - 3) + c01 (I2 - 3) + c20 (I1 - 3)^2 + c30 (I1 - 3)^3 per volume, with
/// the stretch across the sheet that its area leaves. c10 + c01 > 0, c01 >= 0.
struct SheetRubber {
  double c10 = 0, c01 = 0, c20 = 0, c30 = 0;  // [MPa]

  [[nodiscard]] double youngs_modulus() const { return 6 * (c10 + c01); }  // at rest [MPa]
};

/// Of a sheet in plane stress: S = stiffness E, E = (C - I) / 2 as (E11, E22, 2 E12); W = E . S / 2 per volume. One
/// that takes tension only wrinkles instead of being pressed: its W is the least of all E + P, P positive semidefinite.
///
/// source  Pipkin 1994, "Relaxed energy densities for large deformations of membranes"
struct SheetLaw {
  Mat3 stiffness = Mat3::Zero();   // [MPa]
  Mat3 compliance = Mat3::Zero();  // its inverse [1/MPa]
  bool tension_only = false;
  std::optional<SheetRubber> rubber{};  // in place of the stiffness, which is that at rest
};

/// What bending at a place stores: (k - k0) . stiffness (k - k0) / 2, k = (n . x_11, n . x_22, 2 n . x_12), n the unit
/// normal.
struct BendingPlace {
  Mat3 stiffness = Mat3::Zero();  // area times that per width [N mm mm^2]
  Vec3 rest = Vec3::Zero();       // k0 [1/mm]
};

/// What a place of an edge between two faces stores, at which the slope jumps by an angle J: length (mean moment (J -
/// J0) + penalty (J - J0)^2 / 2), moments less those at rest.
///
/// source  the C0 interior penalty method: Engel, Garikipati, Hughes, Larson, Mazzei, Taylor 2002; Brenner, Sung 2005;
///         here with the angle between present normals in place of the jump of slopes
struct BendingJoint {
  double length = 0;                                // that it stands for [mm]
  double penalty = 0;                               // [N]
  Eigen::Vector2d along = Eigen::Vector2d::Zero();  // the edge, in x_1 and x_2 of the first side
  std::array<double, 2> upwards{1, 1};              // -1: a side's normal x_1 x x_2 points down
  std::array<double, 2> fraction{0.5, 0.5};         // of either side in the mean moment
  std::array<double, 2> moment{0, 0};               // at rest [N]
  double angle = 0;                                 // J0 [rad]
};

}  // namespace softkin
