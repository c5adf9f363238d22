#pragma once

#include <array>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin {

/// A line in space.
struct AxisLine {
  Vec3 point{0, 0, 0}, direction{1, 0, 0};  // the direction has length 1
};

/// Returns the axes about which at least five pairs of consecutive edges lie on circles, the axis with most pairs
/// first.
///
/// edges        ends of edges that may form circles: creases of a surface
/// widest_step  largest angle between the ends of an edge, as seen from the axis [rad]
[[nodiscard]] std::vector<AxisLine> circle_axes(const Points& vertices, const std::vector<std::array<Index, 2>>& edges,
                                                double widest_step);

}  // namespace softkin
