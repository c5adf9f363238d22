#pragma once

#include <softkin/core/target.hpp>
#include <softkin/energy/magnet_blocks.hpp>

namespace softkin::energy {

/// A circle of wire, turned around its unit axis.
struct LoopOfCurrent {
  double center[3], axis[3];  // [mm], [-]
  double radius_mm;
  double scale;  // mu_0 / (4 pi) times the current in all its turns [mT mm]
};

// energy/loop_field.hpp documents it.
SOFTKIN_KERNELS(void add_loop(const LoopOfCurrent& loop, const energy::Pack3& place, bool second,
                              energy::FluxPoint& out, energy::PackMask& known);)

}  // namespace softkin::energy
