#pragma once

#include <optional>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin {

/// Forces of a part of a ContactModel on another, or on itself, in a shape.
struct PairForces {
  Index a = 0, b = 0;          // parts; a is the softer one, the first one of two that are alike, or b
  Vec3 force = Vec3::Zero();   // that b exerts on a [N]; 0 where they are one
  Vec3 moment = Vec3::Zero();  // the same, about the centre [N mm]
  Vec3 center = Vec3::Zero();  // mean of the places on a under pressure, by their normal force [mm]
  double normal_N = 0;         // sum of the magnitudes of all normal forces
  double area_mm2 = 0;         // of the surface of a around vertices that carry more than a hundredth of the largest
                               // pressure, as seen along the force; of one part the mean of both sides
  double gap_mm = 0;           // the least
  double pressure_kPa = 0;     // the largest on a vertex of a
  std::optional<double> slipping{};  // fraction of normal_N whose contacts slip [-]; none: no friction
};

/// Contact forces in a shape.
struct ContactForces {
  std::vector<PairForces> pairs;     // those between which contact acts, by a, then b
  std::vector<double> pressure_kPa;  // per vertex of the model: normal force over deformed area; 0 on obstacles
  std::vector<double> slip_mm{};     // the same: slip since contact began; empty: no friction
};

}  // namespace softkin
