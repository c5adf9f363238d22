#pragma once

#include <vector>

namespace softkin {

/// Slopes at the points of a curve whose cubics do not overshoot: where the values rise or fall they do so between the
/// points, too.
///
/// x, y    of the points, x ascending; at least two
/// source  Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5(2), 1984, at the ends three-point differences limited to
///         stay monotone (PCHIP)
[[nodiscard]] std::vector<double> pchip_slopes(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace softkin
