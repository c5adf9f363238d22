#pragma once

#include <softkin/io/json_text.hpp>
#include <softkin/kinematics/map.hpp>

/// A map as what runs in a browser reads it: apps/view/web/src/map.ts evaluates these.

namespace softkin::runs {

[[nodiscard]] Json inputs_table(const MapData& data);
/// With the errors that were found where the map was checked.
[[nodiscard]] Json outputs_table(const MapData& data);
[[nodiscard]] Json checked_table(const MapData& data);
/// Its pieces, cells and sums.
[[nodiscard]] Json map_tables(const MapData& data);
/// Mean and modes, one mode after the other.
[[nodiscard]] Json shape_table(const MapShape& shape);

/// The shape of some vertices alone, in that order.
[[nodiscard]] MapShape shape_at(const MapShape& shape, const std::vector<Index>& vertices);

}  // namespace softkin::runs
