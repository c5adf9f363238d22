#pragma once

#include <softkin/model/model.hpp>
#include <string>

namespace softkin::bench {

/// The finger that every benchmark bends: a bellows of 120 x 25 x 25 mm along x, held at x = 0, with seven folds of
/// plane walls in its sides and top, a chamber inside, solid ends and a flat floor of 2 mm towards which it bends.
///
/// cell_mm  about the edge of a cell in the wall [mm], 0.3 <= cell_mm <= 10; every cell is five tetrahedra
/// returns  lengths in mm, elements positive and conforming, mirror image of itself in y = 0. Regions: volumes "body"
///          and "chamber", surfaces "fixed" (x = 0), "tip" (x = 120) and "cavity_wall", vertex "tip_marker" in the
///          middle of the tip's lower edge
/// throws   InvalidInput on a size outside its range
[[nodiscard]] Mesh bellows_finger(double cell_mm);

/// The cell size whose finger has the number of body tetrahedra nearest to the one asked for.
///
/// throws  InvalidInput where no size in its range gives half to twice as many
[[nodiscard]] double cell_for(double body_tetrahedra);

/// Body tetrahedra of bellows_finger(cell_mm).
[[nodiscard]] std::int64_t body_tetrahedra(double cell_mm);

enum class FingerKind { target_shape, physical, physical_quadratic };

/// The finger of a mesh with the regions named above (cavity_wall is not needed; tip_marker may be missing: then the
/// middle of the tip's lower edge) as a robot. Actuator 0 is its chamber's volume ratio; marker 0 is the tip.
///
/// kind     target_shape: R_omega = 1, chamber elements of weight 5, the paper's; physical: St. Venant-Kirchhoff,
///          E = 12 MPa, nu = 0.4, the volume as a constraint, tetrahedra of order 1 or 2
/// origin   of the mesh, for messages
/// throws   InvalidInput where a region is missing
[[nodiscard]] RobotSpec finger_robot(Mesh mesh, FingerKind kind, const std::string& origin);

/// Vertices of the region "tip", ascending. throws InvalidInput where it is missing
[[nodiscard]] std::vector<Index> tip_face(const Mesh& mesh, const std::string& origin);

}  // namespace softkin::bench
