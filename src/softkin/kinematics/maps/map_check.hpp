#pragma once

#include <softkin/kinematics/maps/crew.hpp>

namespace softkin::maps {

/// Where the solver begins, of a place in the map and the commands there.
using CheckStart = std::function<State(const KinematicMap::Place& place, const Eigen::VectorXd& commands)>;

/// Compares a map with the robot itself at random actuations, and writes how far off it was into data.check.
///
/// round    each has random actuations of its own
/// returns  why it is not as accurate as was asked for, empty: it is; nothing where it was stopped
[[nodiscard]] std::optional<std::string> check_map(const Statics& statics, const MapOptions& options, int round,
                                                   const CheckStart& start, Crew& crew, MapData& data);

}  // namespace softkin::maps
