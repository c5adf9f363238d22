#pragma once

#include <softkin/energy/kernels/loop_field.hpp>

namespace softkin::energy {

/// Adds the flux density of a loop of current in every lane, and its derivatives by place.
///
/// place    [mm]
/// second   are second derivatives requested, too? They are left unchanged otherwise
/// returns  where the field is defined: not on the wire, where the added values are arbitrary
/// source   complete elliptic integrals, as in Simpson et al. 2001, "Simple analytic expressions for the magnetic field
///          of a circular current loop", of 4 a^2 rho^2 / (a^2 + r^2)^2, which is smooth on the axis
inline PackMask add_loop(const LoopOfCurrent& loop, const Pack3& place, bool second, FluxPoint& out) {
  PackMask known;
  const auto run = [&] { SOFTKIN_RUN_KERNEL(add_loop(loop, place, second, out, known)); };
  run();
  return known;
}

}  // namespace softkin::energy
