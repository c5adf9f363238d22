#pragma once

#include <softkin/model/model.hpp>

namespace softkin {

/// Volume enclosed by a cavity's boundary whose normals point out of it, exact for curved faces too.
///
/// positions  #V by 3 [mm]
/// returns    sum over the faces of 1/3 of the integral of x . (dx/du x dx/dv) over the reference triangle [mm^3];
///            0 without faces; linear or quadratic faces by whether their edges are given
/// source     divergence theorem; the integrand is of degree 4 on a quadratic face, the rule is exact for degree 4
[[nodiscard]] double enclosed_volume(const Points& positions, const std::vector<CavityFace>& faces);

}  // namespace softkin
