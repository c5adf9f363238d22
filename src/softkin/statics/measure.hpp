#pragma once

#include <softkin/model/model.hpp>

namespace softkin {

/// What an actuator controls, as it is in a shape, over its value at rest [-]: polyline length, sum of the prisms' mean
/// areas, sum of the chamber elements' volumes (or the volume enclosed by its surface).
[[nodiscard]] double achieved_ratio(const Model& model, const Actuator& actuator, const Points& positions);

/// Deformation of every element, tetrahedra first, then prisms (there at the centre).
struct ElementDeformation {
  std::vector<double> volume_ratio;           // [-]; <= 0: inverted
  std::vector<std::array<double, 3>> strain;  // principal stretches minus 1, descending [-]; the least is negated
                                              // with the sign of det F in an inverted element
};
[[nodiscard]] ElementDeformation deformation_of(const Model& model, const Points& positions);

/// The paper's Fig. 6: how much of the body's volume is strained how far. Of each body element counts the principal
/// strain of largest magnitude; shares are of the body's rest volume.
struct StrainHistogram {
  std::vector<double> edges;   // of the bins, one more than shares [-]
  std::vector<double> shares;  // sum to 1
  double least = 0, greatest = 0;
  double percentile_95 = 0;  // of the magnitude
  struct Beyond {
    std::string region;
    double linear_range = 0;
    double share = 0;  // of the material's volume whose magnitude is beyond
  };
  std::vector<Beyond> beyond;  // materials that state a linear range
};
[[nodiscard]] StrainHistogram strain_histogram(const Model& model, const ElementDeformation& deformation);

}  // namespace softkin
