#pragma once

#include <optional>
#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

/// Parameters at the start of a path from flat sheets.
struct Swelling {
  double barrier = 0;  // of smoothed wrinkling, see energy::smooth_sheet_response(): it keeps the tension of the
                       // smoothing near that which the loads cause
  double boost = 1;    // factor of pressures that stretches the film enough to find its shape
};

/// Finds a start for sheets that no element stiffens and that are flat and slack, as they were cut: they have no
/// stiffness there, so that no step leads away. The sheets are taken to be stretched evenly, whatever their material,
/// and loaded by the load state, which has one solution; it is scaled so that it stretches them by some percent.
///
/// active   as in System::evaluate()
/// at       a shape with flat sheets without stiffness; becomes the start, its multipliers the given ones
/// returns  none where nothing loads the sheets; the shape is unchanged then
[[nodiscard]] std::optional<Swelling> swell(const System& system, const LoadState& there,
                                            const std::vector<bool>& active, Iterate& at, Workspace& work, Team& team);

}  // namespace softkin::physical
