#pragma once

#include <optional>
#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

/// How a way begins that leads away from flat sheets.
struct Swelling {
  double barrier = 0;  // how smoothly wrinkles are, see energy::smooth_sheet_response(): that the tension of smoothing
                       // stays near the one that the loads call up
  double boost = 1;    // of pressures, that the film is stretched by so much that it finds its shape
};

/// Where to begin with sheets that no element stiffens and that are as they were cut, flat and slack, so that nothing
/// leads away from there: they are taken to be stretched evenly, whatever they are made of, and loaded as the demand
/// says, which has one answer; scaled so that it stretches them by some percent.
///
/// active   as in System::evaluate()
/// at       of limp sheets that are flat; becomes that shape, its multipliers those that are given
/// returns  none, and leaves the shape, where nothing loads it
[[nodiscard]] std::optional<Swelling> swell(const System& system, const Demand& there, const std::vector<bool>& active,
                                            Iterate& at, Workspace& work, Team& team);

}  // namespace softkin::physical
