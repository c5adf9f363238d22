#pragma once

#include <softkin/model/mesh/curved_edges.hpp>
#include <softkin/model/robot_spec.hpp>

namespace softkin {

/// Are the nodes of a mesh of order 2 in the middle of its edges, to a thousandth of their length?
[[nodiscard]] bool has_straight_edges(const Mesh& mesh);

/// The description's `curve` on a mesh of order 2 made of its own, with a note of what it did.
///
/// throws  InvalidInput where the mesh's edges are curved already, or none lies on a given surface
CurvedEdges curve_mesh(const RobotSpec& spec, Mesh& mesh, std::vector<std::string>& notes);

}  // namespace softkin
