#pragma once

#include <optional>
#include <softkin/statics/deformation.hpp>
#include <string>

namespace softkin {

/// The element of the body that is deformed most, and the part of the robot next to it.
struct WorstPlace {
  bool prism = false;       // else a tetrahedron
  Index element = 0;        // among the tetrahedra or the prisms of the model
  std::string region;       // of the element; may be empty
  Vec3 at;                  // its centroid in the shape [mm]
  double strain = 0;        // principal strain of largest magnitude [-]
  double volume_ratio = 1;  // [-]
  std::string beside;       // "the end of cable 'tendon'", "the wall of chamber 'air'", "what is held", "rigid region
                            // 'tip'"; empty: nothing is as near as two edges of the element
};

/// Finds the most deformed element and the part nearest to it: at least one of its vertices, or a point less than two
/// of its edges away; points of cables before rigid regions, these before walls of chambers, these before supported
/// vertices.
///
/// positions  #V by 3 [mm]; deformation: of them
/// returns    none where the model has no body
[[nodiscard]] std::optional<WorstPlace> worst_place(const Model& model, const Points& positions,
                                                    const ElementDeformation& deformation);

}  // namespace softkin
