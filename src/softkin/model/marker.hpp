#pragma once

#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A point that moves with the mesh: the weighted sum of some vertices; the weights sum to 1.
struct EmbeddedPoint {
  std::vector<Index> vertices;  // of the model
  std::vector<double> weights;  // as many [-]
  double distance_mm = 0;       // from the nearest element; 0: inside

  /// Where it is in a shape, #V by 3 [mm].
  [[nodiscard]] Vec3 at(const Points& positions) const;
};

/// A point that is watched: of the mesh, or at the end of a stem that stands on a region and turns with it.
struct Marker {
  std::string name;          // for messages and columns of tables
  EmbeddedPoint point;       // of the mesh; or where the stem stands, the region's mean
  Vec3 stem{0, 0, 0};        // from there to the marker at rest [mm]
  std::vector<Vec3> arms{};  // from there to the point's vertices at rest [mm]; none: there is no stem

  /// positions  #V by 3 [mm]
  /// returns    x = mean + R stem, R the rotation that fits the arms best, each by its weight [mm]
  [[nodiscard]] Vec3 at(const Points& positions) const;

  /// How it moves where the vertices do: its derivative along moves, #V by 3.
  [[nodiscard]] Vec3 velocity(const Points& positions, const Points& moves) const;
};

}  // namespace softkin
