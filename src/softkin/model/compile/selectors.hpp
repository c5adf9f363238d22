#pragma once

#include <softkin/model/robot_spec.hpp>

namespace softkin {

/// "box", "sphere", ...
[[nodiscard]] std::string kind_of(const Selector& selector);

/// throws  InvalidInput at origin on a shape without extent or with numbers that are not finite
void check_shape(const Selector& selector, const Origin& origin);

/// Whether a shape holds the point, or its boundary is within tolerance of it [mm]. Lists hold no point.
[[nodiscard]] bool holds(const Selector& selector, const Vec3& point, double tolerance);

}  // namespace softkin
