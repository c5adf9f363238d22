#pragma once

#include <softkin/model/robot_spec.hpp>
#include <string>

namespace softkin::bench {

/// The robot of examples/three_tendon_finger with a mesh of about so many tetrahedra in place of its own: the same
/// shape, in hexahedra of six tetrahedra each; the tendons leave and enter the body in points.
///
/// scene   of that example
/// order   of the tetrahedra in the physical formulation, 1 or 2
/// throws  InvalidInput as read_scene does
[[nodiscard]] RobotSpec knuckle_finger(const std::string& scene, double tetrahedra, int order);

}  // namespace softkin::bench
