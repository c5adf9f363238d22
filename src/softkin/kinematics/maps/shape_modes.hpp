#pragma once

#include <softkin/kinematics/maps/piece_solver.hpp>

namespace softkin::maps {

/// Returns the fewest modes of which all sampled shapes are sums, with at most this error at any vertex, by proper
/// orthogonal decomposition.
///
/// source  Sirovich 1987, the method of snapshots
[[nodiscard]] MapShape shape_modes(const std::vector<const Sample*>& samples, double accuracy_mm);

/// Commands inside the ranges, independent and uniform: a row each, the same on every machine.
[[nodiscard]] RowMatrix random_commands(const MapData& data, Index count, std::uint64_t seed);

}  // namespace softkin::maps
