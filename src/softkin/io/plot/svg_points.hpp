#pragma once

#include <softkin/io/plot/svg_canvas.hpp>
#include <vector>

namespace softkin {

/// The points of a line but those that are within a quarter of a pixel of the last one kept; first and last stay.
[[nodiscard]] std::vector<SvgPoint> thinned_line(const std::vector<SvgPoint>& points);

/// Points that are at least a distance [pixel] from the one kept before, the first among them.
[[nodiscard]] std::vector<SvgPoint> apart_along(const std::vector<SvgPoint>& points, double distance);

/// The first of the points in each square of half a pixel.
[[nodiscard]] std::vector<SvgPoint> apart_on_grid(const std::vector<SvgPoint>& points);

}  // namespace softkin
