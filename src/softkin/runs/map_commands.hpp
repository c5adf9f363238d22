#pragma once

#include <softkin/kinematics/map.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/paths.hpp>
#include <string>

namespace softkin::runs {

/// The pressures of the chambers that are commanded by volume, by a map of the robot (check_robot).
///
/// map_file  for messages
/// throws    InvalidInput naming file and line of a row that is outside the map; as chambers_without_pressures; where
///           the map has no pressures
void take_pressures(const Model& model, const KinematicMap& map, const std::string& map_file, Commands& commands);

}  // namespace softkin::runs
