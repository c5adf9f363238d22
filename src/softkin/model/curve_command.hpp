#pragma once

#include <softkin/model/model.hpp>

namespace softkin {

/// The ratio that an actuator's curve gives for an input: pressure [kPa gauge] or voltage [kV]. Without input it is the
/// actuator's ratio at rest: a dea's prestretch, else 1.
///
/// throws  InvalidInput where the actuator has no curve, or outside the branch
[[nodiscard]] double ratio_by_curve(const Actuator& actuator, double input, Branch branch);

/// The input that a ratio asks for, the other way round; none outside the branch or without a curve.
[[nodiscard]] std::optional<double> input_by_curve(const Actuator& actuator, double ratio, Branch branch);

/// Standard deviation of the ratio between repeated runs near an input [-]; none where it is not known.
[[nodiscard]] std::optional<double> spread_by_curve(const Actuator& actuator, double input, Branch branch);

}  // namespace softkin
