#pragma once

#include <softkin/model/model.hpp>

namespace softkin {

/// What an actuator controls, as it is in a shape, over its value at rest [-], whatever its control: polyline length,
/// sum of the prisms' mean areas, or volume of the chamber, Eq. (17): of its elements (target-shape), enclosed by its
/// boundary (physical) or by its surface.
[[nodiscard]] double achieved_ratio(const Model& model, const Actuator& actuator, const Points& positions);

/// Deformation of every element, tetrahedra first, then prisms (their strain at the centre). Of order 2: the least
/// volume ratio, det F, at the corners and at the four points with which the energy is integrated, and the strain at
/// that of the four where its magnitude is largest.
struct ElementDeformation {
  std::vector<double> volume_ratio;           // [-]; <= 0: inverted, of order 2 somewhere
  std::vector<std::array<double, 3>> strain;  // principal stretches minus 1, descending [-]; the least is negated
                                              // with the sign of det F in an inverted element
};
[[nodiscard]] ElementDeformation deformation_of(const Model& model, const Points& positions);

/// The paper's Fig. 6: how much of the body's volume is strained how far. Of each body element counts the principal
/// strain of largest magnitude; shares are of the body's rest volume. The prisms of a dea are not body.
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
