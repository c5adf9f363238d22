#pragma once

#include <softkin/kinematics/map.hpp>
#include <softkin/runs/map_file.hpp>

#include "fk_samples.hpp"

namespace softkin::testing {

/// The block with a chamber and a cable, in ranges where both have equilibria.
inline std::string scene_to_map() {
  return replaced(replaced(physical_scene(), "range: [0.5, 3]", "range: [1, 1.6]"), "range: [0.5, 1.2]",
                  "range: [0.85, 1.1]");
}

/// Leaves of a map what is below a command of its first input, or what is above.
inline void cut_map(const std::string& file, double at, bool keep_below) {
  MapData data = runs::read_map(file);
  for (MapPiece& piece : data.pieces) {
    const Index next = piece.tree.size();
    const MapNode whole = piece.tree.front(), none;
    piece.tree.front() = {0, at, next, next + 1, -1};
    piece.tree.push_back(keep_below ? whole : none);
    piece.tree.push_back(keep_below ? none : whole);
  }
  runs::write_map(file, data);
}

}  // namespace softkin::testing
