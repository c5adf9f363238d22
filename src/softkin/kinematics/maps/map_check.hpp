#pragma once

#include <softkin/kinematics/maps/crew.hpp>

namespace softkin::maps {

/// Returns the initial guess of the solver at a place in the map and the commands there.
using CheckStart = std::function<State(const KinematicMap::Place& place, const Eigen::VectorXd& commands)>;

/// Compares a map with the robot itself at random actuations, and writes its errors into data.check.
///
/// round    each has random actuations of its own
/// returns  why it is less accurate than requested, empty: it is not; nothing where it was stopped
[[nodiscard]] std::optional<std::string> check_map(const Statics& statics, const MapOptions& options, int round,
                                                   const CheckStart& start, Crew& crew, MapData& data);

}  // namespace softkin::maps
