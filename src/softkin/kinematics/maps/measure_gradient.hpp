#pragma once

#include <softkin/model/model.hpp>

namespace softkin::maps {

/// Derivative of what achieved_ratio measures of an actuator, a length [mm], area [mm^2] or volume [mm^3], by the
/// vertices: #V by 3; zero of one that has none.
[[nodiscard]] Points measure_gradient(const Model& model, const Actuator& actuator, const Points& positions);

}  // namespace softkin::maps
